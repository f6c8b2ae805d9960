# SPDX-License-Identifier: GPL-3.0-or-later

"""The pages of docs/ as a site, which scripts/site built: whole, and at home in a browser.

PREFILTER_SITE is where it is. Pages are opened in Chromium where it is installed.
"""

import contextlib
import functools
import http.server
import json
import os
import re
import shutil
import subprocess
import sys
import threading
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urljoin

import pytest

SOURCE = Path(__file__).resolve().parents[2]
SITE = Path(os.environ["PREFILTER_SITE"])
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
sys.path.insert(0, str(SOURCE / "scripts"))
from packager.navigation import sections  # noqa: E402

PAGES = sorted(path.relative_to(SITE).as_posix() for path in SITE.rglob("*.html"))
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium")


class Reader(HTMLParser):
    """Anchors and links of a page."""

    def __init__(self, text):
        super().__init__()
        self.places, self.links, self.needed, self.words = set(), [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.places |= {found[name] for name in ("id", "name") if found.get(name)}
        if tag == "a" and found.get("href"):
            self.links.append(found["href"])
        if tag in {"img", "script", "iframe", "source"} and found.get("src"):
            self.needed.append(found["src"])
        if tag == "link" and found.get("rel") == "stylesheet":
            self.needed.append(found["href"])

    def handle_data(self, data):
        self.words += data


@functools.cache
def read(page):
    return Reader((SITE / page).read_text("utf-8"))


def dead(page, target):
    """Returns whether the target of a link, or a file that a page needs, is missing."""
    name, _, place = unquote(target).partition("#")
    other = urljoin(page, name) if name else page
    path = SITE / other.lstrip("/")
    if path.is_dir():
        path, other = path / "index.html", f"{other.rstrip('/')}/index.html".lstrip("./")
    if not path.is_file():
        return True
    return bool(place) and path.suffix == ".html" and place not in read(other).places


def is_elsewhere(target):
    return "://" in target or target.startswith("mailto:")


def test_every_page_of_the_docs_is_there():
    written = {
        path.relative_to(SOURCE / "docs").as_posix() for path in (SOURCE / "docs").rglob("*.md")
    }
    expected = {name.removesuffix(".md") + ".html" for name in written} - {"README.html"}
    assert set(PAGES) == expected | {"index.html", "404.html"}


def test_the_navigation_names_every_page():
    index = (SOURCE / "docs" / "README.md").read_text("utf-8")
    listed = {
        entry.page
        for section in sections(index)
        for entries in section.groups.values()
        for entry in entries
    }
    pages = {path.stem for path in (SOURCE / "docs").glob("*.md")} - {"README"}
    assert pages - listed == set(), "docs/README.md does not list them"
    assert len(sections(index)) > 5
    assert {link.partition("#")[0] for link in read("index.html").links} >= {
        f"{page}.html" for page in pages
    }


@pytest.mark.parametrize("page", [page for page in PAGES if page != "404.html"])
def test_no_link_is_dead(page):
    found = read(page)
    assert [each for each in found.links if not is_elsewhere(each) and dead(page, each)] == []
    assert [each for each in found.needed if is_elsewhere(each) or dead(page, each)] == []


def test_dead_links_are_found():
    assert dead("index.html", "none.html")
    assert dead("index.html", "bake.html#none")
    assert dead("benchmarks/formats.html", "formats.png")
    assert not dead("benchmarks/formats.html", "../bake.html#steps")


def test_search_knows_the_pages():
    index = json.loads((SITE / "search" / "search_index.json").read_text("utf-8"))
    found = {each["location"].partition("#")[0] for each in index["docs"]}
    assert found >= {"bake.html", "voxels.html", "limits.html", "tutorial.html"}


def compared():
    """The names of the pictures that get a slider."""
    return re.findall(
        r'(?m)^  "(\w+\.png)": \{', (SOURCE / "docs/site/compare.js").read_text("utf-8")
    )


@pytest.fixture(scope="module")
def address():
    handler = functools.partial(Quiet, directory=str(SITE))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def opened(url, folder, width=1280):
    """A page after a browser has loaded it, with the messages of its console."""
    words = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
    words += [
        f"--user-data-dir={folder}",
        f"--window-size={width},900",
        "--virtual-time-budget=3000",
    ]
    words += ["--enable-logging=stderr", "--v=0", "--dump-dom", url]
    done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=True)
    return done.stdout, [line for line in done.stderr.splitlines() if ":CONSOLE" in line]


@needs_chromium
@pytest.mark.parametrize("name", ["index", "resize", "texture_cache", "tutorial"])
def test_pages_open_in_a_browser(name, address, tmp_path):
    html, told = opened(f"{address}/{name}.html", tmp_path)
    assert told == []
    pictures = [picture for picture in compared() if f"/{picture}" in html]
    assert html.count('type="range"') == len(pictures)
    assert pictures or name == "index"


@needs_chromium
def test_search_works_on_pages_opened_from_a_folder(tmp_path):
    html, messages = opened(f"{(SITE / 'voxels.html').as_uri()}?q=genus", tmp_path)
    assert messages == []
    assert "md-search-result__item" in html


@needs_chromium
@pytest.mark.parametrize("width", [1280, 420])
def test_nothing_is_wider_than_the_window(width, address, tmp_path):
    script = "<script>document.title = document.documentElement.scrollWidth - innerWidth</script>"
    page = SITE / f"width{width}.html"
    page.write_text(
        (SITE / "resize.html").read_text("utf-8").replace("</body>", f"{script}</body>")
    )
    with contextlib.ExitStack() as after:
        after.callback(page.unlink)
        html, _ = opened(f"{address}/{page.name}", tmp_path, width)
    assert int(re.search(r"<title>(-?\d+)</title>", html)[1]) <= 0
