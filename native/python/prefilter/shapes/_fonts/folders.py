# SPDX-License-Identifier: GPL-3.0-or-later

"""Font folders of the system."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

SUFFIXES = (".ttf", ".otf", ".ttc", ".otc", ".woff", ".woff2")
_MAX_FILES = 20_000
_FONTCONFIG = Path("/etc/fonts/fonts.conf")


def system_folders() -> list[Path]:
    """Returns the system's font folders, the user's first."""
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
    return list(dict.fromkeys((*folders, *_fontconfig_folders(home))))


def _fontconfig_folders(home: Path) -> Iterator[Path]:
    """Yields the folders in fontconfig's main file."""
    try:
        file = os.environ.get("FONTCONFIG_FILE") or _FONTCONFIG
        root = ElementTree.parse(file).getroot()
    except (OSError, ElementTree.ParseError):
        return
    for element in root.iter("dir"):
        text = (element.text or "").strip()
        if element.get("prefix", "default") == "default" and text.startswith(("/", "~/")):
            yield home / text[2:] if text.startswith("~") else Path(text)


def list_font_files(folder: Path) -> list[Path]:
    """Returns the font files in a folder tree, sorted by name; none if there is no folder."""
    files: list[Path] = []
    for parent, folders, names in os.walk(folder):
        folders.sort()
        files.extend(Path(parent, name) for name in sorted(names) if _is_font(name))
        if len(files) > _MAX_FILES:
            break
    return files[:_MAX_FILES]


def _is_font(name: str) -> bool:
    return name.lower().endswith(SUFFIXES)
