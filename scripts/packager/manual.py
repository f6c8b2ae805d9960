# SPDX-License-Identifier: GPL-3.0-or-later

"""The manual that goes along with the add-on: pages of docs/ as HTML, which any browser opens.

Needs markdown-it-py, which reads Markdown; scripts/packager.txt has its version.
"""

import re
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

from packager.project import SOURCE, PackagingError

DOCS = SOURCE / "docs"
INDEX = "README"
PAGES = (
    INDEX,
    *("install", "bake", "data", "view", "texture_cache", "engines", "resize", "resample"),
    *("sampling", "shaders", "voxels", "scans", "shapes", "svg", "queue", "preferences"),
    *("command_line", "farm", "conventions"),
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
_MARKDOWN = MarkdownIt("commonmark", {"xhtmlOut": False}).enable("table")


def pictures(docs: Path = DOCS) -> list[Path]:
    """Returns the pictures that go along."""
    found = set()
    for page in PAGES:
        for token in _MARKDOWN.parse((docs / f"{page}.md").read_text(encoding="utf-8")):
            for child in token.children or ():
                if child.type == "image":
                    picture = docs / str(child.attrs["src"])
                    if picture.stat().st_size <= LARGEST_PICTURE:
                        found.add(picture)
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


def body(text: str, docs: Path, kept: Collection[Path]) -> str:
    """Returns a page of Markdown as HTML, with the pictures in `kept`."""
    places: dict[str, int] = {}
    tokens: list[Token] = []
    for token in _MARKDOWN.parse(text):
        if token.type == "html_block" and token.content.startswith("<!--"):
            continue
        if token.type == "inline":
            if tokens[-1].type == "heading_open":
                tokens[-1].attrSet("id", _place(token.children or (), places))
            token.children = list(_links_that_lead_somewhere(token.children or (), docs, kept))
        tokens.append(token)
    return str(_MARKDOWN.renderer.render(tokens, _MARKDOWN.options, {})).rstrip()


def _place(heading: Sequence[Token], places: dict[str, int]) -> str:
    """Returns the name of a heading's place, as GitHub gives them; `places` counts equal ones."""
    plain = "".join(token.content for token in heading)
    place = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
    count = places.get(place, 0)
    places[place] = count + 1
    return f"{place}-{count}" if count else place


def _links_that_lead_somewhere(
    tokens: Sequence[Token], docs: Path, kept: Collection[Path]
) -> Iterator[Token]:
    """Yields a text's tokens; links to pages that do not go along, and pictures, become text."""
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
        if token.type == "image" and docs / str(token.attrs["src"]) not in kept:
            yield Token("em_open", "em", 1)
            yield Token("text", "", 0, content=f"({token.content})")
            yield Token("em_close", "em", -1)
        elif is_shown:
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
