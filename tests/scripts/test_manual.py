# SPDX-License-Identifier: GPL-3.0-or-later

"""The manual in the zip: HTML of the pages of docs/, which is whole and leads nowhere else."""

import html
import re
from html.parser import HTMLParser

import pytest
from packager import manual
from packager.project import PackagingError


class Reader(HTMLParser):
    """Reads a page: its text, places, links, pictures; refuses tags that do not close."""

    ALONE = frozenset({"meta", "br", "img"})

    def __init__(self, page):
        super().__init__()
        self.text, self.places, self.links, self.pictures, self.tags = "", set(), [], [], []
        self._open = []
        self.feed(page)
        assert not self._open

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.tags.append(tag)
        self.text += " " if tag == "br" else ""
        self.places |= {found["id"]} if "id" in found else set()
        self.links += [found["href"]] if "href" in found else []
        self.pictures += [found["src"]] if "src" in found else []
        if tag not in self.ALONE:
            self._open.append(tag)

    def handle_endtag(self, tag):
        assert self._open.pop() == tag
        if tag in {"td", "th"}:
            self.text += " "

    def handle_data(self, data):
        self.text += data


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("manual")
    manual.write(folder)
    pages = {path.name: Reader(path.read_text("utf-8")) for path in folder.glob("*.html")}
    return folder, pages


def test_pages_lead_to_pages_that_are_there(written):
    folder, pages = written
    assert set(pages) == {f"{page}.html" for page in manual.PAGES}
    reached = set()
    for name, page in pages.items():
        for link in page.links:
            if "://" not in link:
                other, _, place = link.partition("#")
                reached.add(other)
                assert not place or place in pages[other or name].places, link
        assert all((folder / picture).is_file() for picture in page.pictures)
    assert reached >= set(pages)


def test_no_words_are_lost_and_no_marks_are_left(written):
    _, pages = written
    for page in manual.PAGES:
        source = (manual.DOCS / f"{page}.md").read_text("utf-8")
        source = re.sub(r"<!--.*?-->", "", source, flags=re.S)
        source = re.sub(r"!\[[^\]]*\]\([^)]*\)|\]\([^)]*\)|<br>", " ", source)
        source = re.sub(r"^ *```\w+$", "", source, flags=re.M)
        words = set(re.findall(r"\w{2,}", source))
        found = pages[f"{page}.html"]
        assert words <= set(re.findall(r"\w{2,}", found.text)), page
        plain = re.sub(r"\(.*\)", "", found.text)
        assert "](" not in plain
        assert "**" not in plain
        assert "\0" not in plain
        rows = len(re.findall(r"^ *\|(?!( ?:?-{3,}:? ?\|)+$)", source, re.M))
        assert found.tags.count("tr") == rows, page


def test_all_pictures_are_there(written):
    folder, pages = written
    shown = [folder / picture for page in pages.values() for picture in page.pictures]
    assert len(set(shown)) == len(manual.pictures())
    assert all(path.read_bytes()[8:12] == b"WEBP" for path in shown)


def test_each_page_has_the_navigation(written):
    _, pages = written
    for page in pages.values():
        assert {f"{each}.html" for each in manual.PAGES} <= set(page.links)
    assert 'href="bake.html" aria-current' in manual.navigation(
        (manual.DOCS / "README.md").read_text("utf-8"), "bake"
    )


def test_it_is_small(written):
    folder, _ = written
    assert sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) < 3 << 20


def made(text):
    return manual.body(text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a *b* **c** `d*e*`", "<p>a <em>b</em> <strong>c</strong> <code>d*e*</code></p>"),
        ("a < b & c\nd", "<p>a &lt; b &amp; c\nd</p>"),
        ("## A `b`, c", '<h2 id="a-b-c">A <code>b</code>, c</h2>'),
        ("[a](bake.md#b)", '<p><a href="bake.html#b">a</a></p>'),
        ("[a *b*](benchmarks.md)", "<p>a <em>b</em></p>"),
        ("[`a`](https://b.c/?d&e)", '<p><a href="https://b.c/?d&amp;e"><code>a</code></a></p>'),
        (
            "![a b](pictures/c.png)",
            '<p><img src="pictures/c.webp" alt="a b"></p>',
        ),
        ("    a\n\n    b <c>", "<pre><code>a\n\nb &lt;c&gt;\n</code></pre>"),
        (
            "```python\na\n\n# b\n```\nc",
            '<pre><code class="language-python">a\n\n# b\n</code></pre>\n<p>c</p>',
        ),
        ("- a\n  b\n- c", "<ul>\n<li>a\nb</li>\n<li>c</li>\n</ul>"),
        ("1. a\n   - b\n2. c", "<ol>\n<li>a\n<ul>\n<li>b</li>\n</ul>\n</li>\n<li>c</li>\n</ol>"),
        (
            "|a|b|\n|---|---|\n|`c\\|d`|e \\| f<br>g|",
            "<table>\n<thead>\n<tr>\n<th>a</th>\n<th>b</th>\n</tr>\n</thead>\n<tbody>\n"
            "<tr>\n<td><code>c|d</code></td>\n<td>e | f<br>g</td>\n</tr>\n</tbody>\n</table>",
        ),
    ],
)
def test_markdown(text, expected):
    assert made(text) == expected


def test_a_link_to_nothing_is_refused(tmp_path):
    for page in manual.PAGES:
        (tmp_path / f"{page}.md").write_text("# A\n")
    manual.write(tmp_path / "out", tmp_path)
    (tmp_path / "bake.md").write_text("[b](voxels.md#c)\n")
    with pytest.raises(
        PackagingError, match=html.escape("bake.md: found a link to 'voxels.html#c'", quote=False)
    ):
        manual.write(tmp_path / "out", tmp_path)
