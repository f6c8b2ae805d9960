# SPDX-License-Identifier: GPL-3.0-or-later

"""The manual that goes along with the add-on: the site made small, which any browser opens.

It has the pages that users of the add-on need, with all pictures, as WebP, and the navigation of
the site. Needs markdown-it-py, which reads Markdown, and Pillow; scripts/packager.txt has their
versions.
"""

import html
import io
import re
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token
from PIL import Image

from packager.navigation import sections
from packager.project import SOURCE, PackagingError

DOCS = SOURCE / "docs"
INDEX = "README"
PAGES = (
    INDEX,
    *("install", "tutorial", "limits", "bake", "data", "view", "texture_cache", "engines"),
    *("resize", "resample", "sampling", "shaders", "voxels", "scans", "shapes", "svg", "queue"),
    *("preferences", "command_line", "farm", "conventions"),
)
"""Pages for users of the add-on. Links to other pages become plain text."""
_QUALITY = 80  # Picture quality, at most 100: differences from the PNG files are invisible.

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{title} - Prefilter</title>
<style>
:root {{ color-scheme: light dark; }}
:root {{ --line: rgba(128, 128, 128, 0.4); --soft: rgba(128, 128, 128, 0.13); }}
body {{ font: 16px/1.55 sans-serif; max-width: 74em; margin: 0 auto; padding: 0 1em; }}
body {{ display: flex; gap: 2.5em; }}
nav {{ flex: 0 0 14em; font-size: 0.9em; padding: 1.5em 0; box-sizing: border-box; }}
nav strong, nav a {{ display: block; padding: 0.15em 0; }}
nav strong {{ margin-top: 1em; }}
nav a {{ text-decoration: none; }}
nav a[aria-current] {{ font-weight: bold; }}
main {{ flex: 1 1 auto; min-width: 0; padding-bottom: 3em; }}
img {{ max-width: 100%; height: auto; border-radius: 4px; }}
code {{ font: 0.9em/1.45 ui-monospace, "DejaVu Sans Mono", Consolas, Menlo, monospace; }}
code {{ background: var(--soft); padding: 0.1em 0.3em; border-radius: 3px; }}
pre {{ background: var(--soft); padding: 0.8em 1em; overflow-x: auto; border-radius: 4px; }}
pre code {{ background: none; padding: 0; }}
table {{ border-collapse: collapse; display: block; overflow-x: auto; }}
th, td {{ border: 1px solid var(--line); padding: 0.3em 0.6em; }}
th, td {{ text-align: left; vertical-align: top; }}
@media (max-width: 55em) {{
  body {{ display: block; }}
  nav {{ columns: 2; border-bottom: 1px solid var(--line); }}
}}
</style>
</head>
<body>
{navigation}<main>
{body}
</main>
</body>
</html>
"""
_MARKDOWN = MarkdownIt("commonmark", {"xhtmlOut": False}).enable("table")


def pictures(docs: Path = DOCS) -> list[Path]:
    """Returns the pictures of the pages."""
    found = set()
    for page in PAGES:
        for token in _MARKDOWN.parse((docs / f"{page}.md").read_text(encoding="utf-8")):
            for child in token.children or ():
                if child.type == "image":
                    found.add(docs / str(child.attrs["src"]))
    return sorted(found)


def sources(docs: Path = DOCS) -> list[Path]:
    """Returns the files that the manual is made from."""
    return [*(docs / f"{page}.md" for page in PAGES), *pictures(docs)]


def write(folder: Path, docs: Path = DOCS) -> None:
    """Writes the manual into a folder; README.html is where it begins.

    Raises:
        PackagingError: A page links to a place that another does not have.
    """
    bodies = {page: body((docs / f"{page}.md").read_text(encoding="utf-8")) for page in PAGES}
    index = (docs / f"{INDEX}.md").read_text(encoding="utf-8")
    for page, text in bodies.items():
        check_links(page, bodies)
        title = re.search(r"<h1[^>]*>(.*?)</h1>", text)
        path = folder / f"{page}.html"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(
            _PAGE.format(
                title=re.sub(r"<[^>]*>", "", title[1]) if title else page,
                navigation=navigation(index, page),
                body=text,
            ),
            encoding="utf-8",
        )
    for picture in pictures(docs):
        target = folder / picture.relative_to(docs).with_suffix(".webp")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(_webp(picture))


@cache
def _webp(picture: Path) -> bytes:
    """Returns a picture as a WebP file; a zip for each platform asks for it."""
    made = io.BytesIO()
    with Image.open(picture) as opened:
        opened.save(made, "WEBP", quality=_QUALITY, method=4)
    return made.getvalue()


def navigation(index: str, here: str) -> str:
    """Returns the pages that the text of the index lists, by its sections."""
    lines = ["<nav>", _entry(INDEX, "Prefilter", here)]
    for section in sections(index):
        entries = [entry for entries in section.groups.values() for entry in entries]
        kept = [entry for entry in entries if entry.page in PAGES]
        if kept:
            lines.append(f"<strong>{html.escape(section.title)}</strong>")
            lines += [_entry(entry.page, entry.title, here) for entry in kept]
    return "\n".join([*lines, "</nav>\n"])


def _entry(page: str, title: str, here: str) -> str:
    current = ' aria-current="page"' if page == here else ""
    return f'<a href="{page}.html"{current}>{html.escape(title)}</a>'


def check_links(page: str, bodies: dict[str, str]) -> None:
    """Refuses a page with a link to what another page, or itself, does not have."""
    for target in re.findall(r'href="([^"]*)"', bodies[page]):
        if "://" in target:
            continue
        name, _, place = target.partition("#")
        other = name.removesuffix(".html") or page
        if other not in bodies or (place and f'id="{place}"' not in bodies[other]):
            raise PackagingError(f"docs/{page}.md: found a link to '{target}', which is not there")


def body(text: str) -> str:
    """Returns a page of Markdown as HTML."""
    places: dict[str, int] = {}
    tokens: list[Token] = []
    for token in _MARKDOWN.parse(text):
        if token.type == "html_block" and token.content.startswith("<!--"):
            continue
        if token.type == "inline":
            if tokens[-1].type == "heading_open":
                tokens[-1].attrSet("id", _place(token.children or (), places))
            token.children = list(_links_that_lead_somewhere(token.children or ()))
        tokens.append(token)
    return str(_MARKDOWN.renderer.render(tokens, _MARKDOWN.options, {})).rstrip()


def _place(heading: Sequence[Token], places: dict[str, int]) -> str:
    """Returns the name of a heading's place, as GitHub gives them; `places` counts equal ones."""
    plain = "".join(token.content for token in heading)
    place = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
    count = places.get(place, 0)
    places[place] = count + 1
    return f"{place}-{count}" if count else place


def _links_that_lead_somewhere(tokens: Sequence[Token]) -> Iterator[Token]:
    """Yields a text's tokens; links to pages that do not go along become text."""
    are_kept = []
    for token in tokens:
        if token.type == "link_open":
            target = _target(str(token.attrs["href"]))
            are_kept.append(bool(target))
            token.attrs["href"] = target
        if token.type.startswith("link_") and not are_kept[-1]:
            is_shown = False
        else:
            is_shown = not (token.type == "html_inline" and token.content.startswith("<!--"))
        if token.type == "link_close":
            are_kept.pop()
        if token.type == "image":
            token.attrs["src"] = re.sub(r"\.png$", ".webp", str(token.attrs["src"]))
        if is_shown:
            yield token


def _target(link: str) -> str:
    """Returns where a link leads in the manual; nowhere where to a page that does not go along."""
    if "://" in link:
        return link
    name, mark, place = link.partition("#")
    page = name.removesuffix(".md")
    if name and (page not in PAGES or not name.endswith(".md")):
        return ""
    return f"{page + '.html' if name else ''}{mark}{place}"
