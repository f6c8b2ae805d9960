# SPDX-License-Identifier: GPL-3.0-or-later

"""Where a system keeps its fonts."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

SUFFIXES = (".ttf", ".otf", ".ttc", ".otc", ".woff", ".woff2")
_MAX_FILES = 20_000
_FONTCONFIG = Path("/etc/fonts/fonts.conf")


def system_folders() -> list[Path]:
    """The folders of fonts of this system, those of the user first."""
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA", "")
        user = [Path(local, "Microsoft", "Windows", "Fonts")] if local else []
        return [*user, Path(os.environ.get("WINDIR", "C:/Windows"), "Fonts")]
    home = Path(os.path.expanduser("~"))
    if sys.platform == "darwin":
        return [home / "Library/Fonts", Path("/Library/Fonts"), Path("/System/Library/Fonts")]
    data = os.environ.get("XDG_DATA_HOME") or str(home / ".local/share")
    shared = (os.environ.get("XDG_DATA_DIRS") or "/usr/local/share:/usr/share").split(":")
    folders = [home / ".fonts", *(Path(each, "fonts") for each in (data, *shared) if each)]
    return list(dict.fromkeys((*folders, *_configured(home))))


def _configured(home: Path) -> Iterator[Path]:
    """Yields the folders that fontconfig's main file names."""
    try:
        file = os.environ.get("FONTCONFIG_FILE") or _FONTCONFIG
        root = ElementTree.parse(file).getroot()
    except (OSError, ElementTree.ParseError):
        return
    for element in root.iter("dir"):
        text = (element.text or "").strip()
        if element.get("prefix", "default") == "default" and text.startswith(("/", "~/")):
            yield home / text[2:] if text.startswith("~") else Path(text)


def files_in(folder: Path) -> list[Path]:
    """The files of fonts in a folder and those in it, by name; none where there is no folder."""
    found: list[Path] = []
    for place, folders, names in os.walk(folder):
        folders.sort()
        found.extend(Path(place, name) for name in sorted(names) if _is_font(name))
        if len(found) > _MAX_FILES:
            break
    return found[:_MAX_FILES]


def _is_font(name: str) -> bool:
    return name.lower().endswith(SUFFIXES)
