# SPDX-License-Identifier: GPL-3.0-or-later

"""The navigation of the site and of the manual: what docs/README.md lists, section by section."""

import re
from typing import NamedTuple

_LINE = re.compile(
    r"^## (?P<section>.+)|^(?P<group>\w.*):$|^- \[(?P<title>.+?)\]\((?P<page>\w+)\.md\)"
)


class Entry(NamedTuple):
    """A page.

    Attributes:
        title: As the list names it.
        page: The name of its file, without .md.
    """

    title: str
    page: str


class Section(NamedTuple):
    """A section of the list.

    Attributes:
        title: Its heading.
        groups: Its entries, by the line above them; "" where there is none.
    """

    title: str
    groups: dict[str, list[Entry]]


def sections(index: str) -> list[Section]:
    """Returns the sections of the text of docs/README.md, those without pages left out."""
    found: list[Section] = []
    group = ""
    for line in index.splitlines():
        match = _LINE.match(line)
        if match is None:
            continue
        if match["section"]:
            found.append(Section(match["section"], {}))
            group = ""
        elif match["group"]:
            group = match["group"]
        elif found:
            title = match["title"].replace("`", "")
            found[-1].groups.setdefault(group, []).append(Entry(title, match["page"]))
    return [section for section in found if section.groups]
