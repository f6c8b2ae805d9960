# SPDX-License-Identifier: GPL-3.0-or-later

"""The files that reviewers of extensions read: the manifest, and the files beside it."""

import re
import tomllib
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
MANIFEST = tomllib.loads((CHECKOUT / "blender_manifest.toml").read_text())
# Names of libraries that differ from the names of their tables.
NAMES = {"basisu": "Basis Universal", "cvtt": "Convection Texture Tools"}
COMPILERS = ("pybind11", "libc++", "libunwind", "Zig", "mingw-w64", "glibc", "GCC")


def holders_of(name: str, lines: list[str]) -> list[str]:
    """The lines that name something in brackets."""
    return [line for line in lines if name.casefold() in line.partition("(")[2].casefold()]


def missing_holders(lines: list[str]) -> list[str]:
    """Returns the linked or bundled libraries that have no line."""
    linked = tomllib.loads((CHECKOUT / "scripts/sources.toml").read_text())
    names = [name.rpartition("-")[0] for name in linked]
    lists = [CHECKOUT / "scripts" / name for name in ("bundled.txt", "bundled_modules.txt")]
    bundled = re.findall(r"^(\w+)==", "".join(path.read_text() for path in lists), re.M)
    return [
        name
        for name in (*(NAMES.get(name, name) for name in names), *bundled, *COMPILERS)
        if not holders_of(name, lines)
    ]


def test_whose_everything_is_that_goes_along_is_said() -> None:
    lines = MANIFEST["copyright"]
    assert lines[0] == f"2026 {MANIFEST['maintainer']}"
    assert missing_holders(lines) == []
    assert all(re.fullmatch(r"\d{4}(-\d{4})? \S.*", line) for line in lines)


@pytest.mark.parametrize("name", ["OpenSubdiv", "Basis Universal", "tinycss2", "pybind11"])
def test_what_is_left_out_is_found(name: str) -> None:
    lines = [line for line in MANIFEST["copyright"] if name not in line]
    assert name.casefold() in [each.casefold() for each in missing_holders(lines)]


def test_permissions_are_short_and_say_what_for() -> None:
    assert MANIFEST["permissions"].keys() == {"files"}
    text = MANIFEST["permissions"]["files"]
    assert len(text) <= 64
    assert all(word in text for word in ("images", "meshes", "scans"))


def test_the_changelog_begins_with_this_version() -> None:
    (first, *_) = re.findall(r"^## (\S+)", (CHECKOUT / "CHANGELOG.md").read_text(), re.M)
    assert first == MANIFEST["version"]


def test_the_citation_agrees_with_the_manifest() -> None:
    citation = (CHECKOUT / "CITATION.cff").read_text()
    assert f"  - name: {MANIFEST['maintainer']}\n" in citation
    assert f"license: {MANIFEST['license'][0].removeprefix('SPDX:')}\n" in citation
