#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later

"""Print the section of CHANGELOG.md about a release.

usage: release_notes.py TAG

Refuses a tag that is not "v" and the version of blender_manifest.toml, and a version that the
changelog does not have, or has as not released yet.
"""

import re
import sys
import tomllib
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1]


def version(source: Path = SOURCE) -> str:
    """Returns the version: the manifest is where it is written."""
    text = (source / "blender_manifest.toml").read_text(encoding="utf-8")
    return str(tomllib.loads(text)["version"])


def notes(tag: str, source: Path = SOURCE) -> str:
    """Returns the notes of a release, as Markdown.

    Raises:
        ValueError: The tag, the version and the changelog do not agree.
    """
    if tag != f"v{version(source)}":
        raise ValueError(f"tag: '{tag}'; blender_manifest.toml has the version {version(source)}")
    text = (source / "CHANGELOG.md").read_text(encoding="utf-8")
    found = re.search(
        rf"(?ms)^## {re.escape(tag[1:])}(?P<rest>[^\n]*)\n(?P<notes>.*?)(?=^## |\Z)", text
    )
    if found is None:
        raise ValueError(f"CHANGELOG.md: has no section {tag[1:]}")
    if not re.fullmatch(r" \(\d{4}-\d{2}-\d{2}\)", found["rest"]):
        raise ValueError(
            f"CHANGELOG.md: the section {tag[1:]} says '{found['rest'].strip()}'; its day is "
            "needed, such as (2026-12-24)"
        )
    return found["notes"].strip() + "\n"


def main() -> int:
    """Runs the command line."""
    try:
        (tag,) = sys.argv[1:]
        sys.stdout.write(notes(tag))
    except ValueError as error:
        print(f"release_notes.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
