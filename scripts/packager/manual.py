# SPDX-License-Identifier: GPL-3.0-or-later

"""The manual that goes along with the add-on: pages of docs/ as HTML, which any browser opens.

Of Markdown it knows what these pages use: headings, paragraphs, lists in lists, tables, code,
links, pictures, emphasis.
"""

import html
import re
from collections.abc import Iterator
from pathlib import Path

from packager.project import SOURCE, PackagingError

DOCS = SOURCE / "docs"
INDEX = "README"
PAGES = (
    INDEX,
    *("install", "bake", "data", "view", "texture_cache", "engines", "resize", "resample"),
    *("sampling", "shaders", "voxels", "scans", "shapes", "svg", "preferences", "command_line"),
    "conventions",
)
"""What users of the add-on need. Links to other pages become plain text."""
LARGEST_PICTURE = 128 * 1024
"""In bytes. Of larger pictures there is the description alone, to keep the zips small."""

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{title} - Prefilter</title>
<style>
:root {{ color-scheme: light dark; }}
body {{ font: 16px/1.5 sans-serif; max-width: 56em; margin: 2em auto; padding: 0 1em; }}
img {{ max-width: 100%; }}
pre, code {{ background: rgba(128, 128, 128, 0.15); }}
pre {{ padding: 0.7em; overflow-x: auto; }}
table {{ border-collapse: collapse; }}
th, td {{ border: 1px solid rgba(128, 128, 128, 0.5); padding: 0.3em 0.6em; }}
th, td {{ text-align: left; vertical-align: top; }}
</style>
</head>
<body>
{home}{body}
</body>
</html>
"""
_HOME = f'<p><a href="{INDEX}.html">Prefilter</a></p>\n'
_ITEM = re.compile(r"( *)(-|\d+\.) +(.*)")
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
_HELD = re.compile("\0(\\d+)\0")


def pictures(docs: Path = DOCS) -> list[Path]:
    """Returns the pictures that go along."""
    found = set()
    for page in PAGES:
        for mark, _, target in _LINK.findall((docs / f"{page}.md").read_text(encoding="utf-8")):
            if mark and (docs / target).stat().st_size <= LARGEST_PICTURE:
                found.add(docs / target)
    return sorted(found)


def sources(docs: Path = DOCS) -> list[Path]:
    """Returns the files that the manual is made from."""
    return [*(docs / f"{page}.md" for page in PAGES), *pictures(docs)]


def write(folder: Path, docs: Path = DOCS) -> None:
    """Writes the manual into a folder; README.html is where it begins.

    Raises:
        PackagingError: A page links to a place that another does not have.
    """
    kept = pictures(docs)
    bodies = {
        page: body((docs / f"{page}.md").read_text(encoding="utf-8"), docs, kept) for page in PAGES
    }
    for page, text in bodies.items():
        check_links(page, bodies)
        title = re.search(r"<h1[^>]*>(.*?)</h1>", text)
        path = folder / f"{page}.html"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(
            _PAGE.format(
                title=re.sub(r"<[^>]*>", "", title[1]) if title else page,
                home="" if page == INDEX else _HOME,
                body=text,
            ),
            encoding="utf-8",
        )
    for picture in kept:
        target = folder / picture.relative_to(docs)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(picture.read_bytes())


def check_links(page: str, bodies: dict[str, str]) -> None:
    """Refuses a page with a link to what another page, or itself, does not have."""
    for target in re.findall(r'href="([^"]*)"', bodies[page]):
        if "://" in target:
            continue
        name, _, place = target.partition("#")
        other = name.removesuffix(".html") or page
        if other not in bodies or (place and f'id="{place}"' not in bodies[other]):
            raise PackagingError(f"docs/{page}.md: found a link to '{target}', which is not there")


def body(text: str, docs: Path, kept: list[Path]) -> str:
    """Returns a page of Markdown as HTML."""
    text = re.sub(r"<!--.*?-->\n?", "", text, flags=re.S)
    return "\n".join(_Blocks(docs, kept).of(text.split("\n")))


class _Blocks:
    """Makes HTML of blocks of lines."""

    def __init__(self, docs: Path, kept: list[Path]) -> None:
        self._docs = docs
        self._kept = set(kept)
        self._places: dict[str, int] = {}

    def of(self, lines: list[str]) -> Iterator[str]:
        """Yields the HTML of lines."""
        i = 0
        while i < len(lines):
            line = lines[i]
            end = i + 1
            if not line.strip():
                pass
            elif line.startswith("```"):
                while end < len(lines) and not lines[end].startswith("```"):
                    end += 1
                yield _code(lines[i + 1 : end])
                end += 1
            elif line.startswith("    "):
                while end < len(lines) and (
                    lines[end].startswith("    ") or not lines[end].strip()
                ):
                    end += 1
                yield _code([one[4:] for one in lines[i:end]])
            elif heading := re.match(r"(#+) +(.*)", line):
                yield self._heading(len(heading[1]), heading[2])
            elif line.startswith("|"):
                while end < len(lines) and lines[end].startswith("|"):
                    end += 1
                yield self._table(lines[i:end])
            elif _ITEM.match(line):
                end = _end_of_list(lines, i)
                yield self._list(lines[i:end])
            else:
                while end < len(lines) and _goes_on(lines[end]):
                    end += 1
                yield f"<p>{self._inline(' '.join(one.strip() for one in lines[i:end]))}</p>"
            i = end

    def _heading(self, level: int, text: str) -> str:
        inline = self._inline(text)
        plain = html.unescape(re.sub(r"<[^>]*>", "", inline))
        place = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        count = self._places.get(place, 0)
        self._places[place] = count + 1
        place += f"-{count}" if count else ""
        return f'<h{level} id="{place}">{inline}</h{level}>'

    def _table(self, lines: list[str]) -> str:
        rows = [[cell.strip() for cell in _cells(line)] for line in lines]
        parts = ["<table>"]
        for i, row in enumerate(rows):
            if i != 1:
                kind = "td" if i else "th"
                cells = "".join(f"<{kind}>{self._inline(cell)}</{kind}>" for cell in row)
                parts.append(f"<tr>{cells}</tr>")
        return "\n".join([*parts, "</table>"])

    def _list(self, lines: list[str]) -> str:
        first = _ITEM.match(lines[0])
        assert first is not None
        kind = "ul" if first[2] == "-" else "ol"
        items: list[list[str]] = []
        width = 0
        for line in lines:
            found = _ITEM.match(line)
            if found and len(found[1]) == len(first[1]):
                width = found.start(3)
                items.append([found[3]])
            else:
                items[-1].append(line[width:] if not line[:width].strip() else line.lstrip())
        parts = []
        for item in items:
            made = list(self.of(item))
            # A single paragraph stands in its item by itself.
            made[0] = re.sub(r"^<p>(.*)</p>$", r"\1", made[0], flags=re.S)
            parts.append(f"<li>{chr(10).join(made)}</li>")
        return "\n".join([f"<{kind}>", *parts, f"</{kind}>"])

    def _inline(self, text: str) -> str:
        held: list[str] = []

        def hold(made: str) -> str:
            held.append(made)
            return f"\0{len(held) - 1}\0"

        def link(found: re.Match[str]) -> str:
            mark, shown, target = found.groups()
            if mark:
                return hold(self._picture(shown, target))
            opening = self._opening(target)
            return f"{hold(opening)}{shown}{hold('</a>')}" if opening else shown

        text = re.sub(r"(`+)(.+?)\1", lambda one: hold(f"<code>{_escaped(one[2])}</code>"), text)
        text = text.replace("<br>", hold("<br>"))
        text = re.sub(r"\\([\\|*_`<>\[\]])", lambda one: hold(_escaped(one[1])), text)
        text = _escaped(_LINK.sub(link, text))
        text = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", text)
        text = re.sub(r"\*(.+?)\*", r"<em>\1</em>", text)
        while _HELD.search(text):
            text = _HELD.sub(lambda one: held[int(one[1])], text)
        return text

    def _picture(self, shown: str, target: str) -> str:
        if self._docs / target in self._kept:
            return f'<img src="{target}" alt="{html.escape(shown)}">'
        return f"<em>({_escaped(shown)})</em>"

    def _opening(self, target: str) -> str:
        """Returns the tag of a link; nothing where it leads to a page that does not go along."""
        if "://" in target:
            return f'<a href="{html.escape(target)}">'
        name, mark, place = target.partition("#")
        page = name.removesuffix(".md")
        if name and (page not in PAGES or not name.endswith(".md")):
            return ""
        return f'<a href="{page + ".html" if name else ""}{mark}{place}">'


def _escaped(text: str) -> str:
    return html.escape(text, quote=False)


def _code(lines: list[str]) -> str:
    return f"<pre><code>{_escaped(chr(10).join(lines).rstrip())}</code></pre>"


def _cells(line: str) -> list[str]:
    """Returns the cells of a row; bars in code, and those with a backslash, part none."""
    return re.findall(r"((?:`[^`]*`|\\.|[^|`\\])*)\|", line.strip().removeprefix("|"))


def _goes_on(line: str) -> bool:
    """Tells whether a line belongs to the paragraph of the line above."""
    return bool(line.strip()) and not (line.startswith(("#", "|", "```")) or _ITEM.match(line))


def _end_of_list(lines: list[str], start: int) -> int:
    """Returns where a list ends: before a line without indent that is no item, after a gap."""
    end = start + 1
    while end < len(lines):
        line = lines[end]
        is_after_gap = not lines[end - 1].strip()
        if line.strip() and is_after_gap and not line.startswith("  ") and not _ITEM.match(line):
            break
        if line.startswith(("#", "|", "```")):
            break
        end += 1
    return end
