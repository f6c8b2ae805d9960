# SPDX-License-Identifier: GPL-3.0-or-later

"""The C++ library stands on floors, and what is public is apart from what is internal.

A folder includes only itself and what stands below it. Public headers, in native/include, include
no internal ones, and the bindings, like every other program that uses the library, include public
ones alone.
"""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

NATIVE = Path(__file__).resolve().parents[2] / "native"
INTERNAL = NATIVE / "prefilter"
PUBLIC = NATIVE / "include/prefilter"
FLOORS = (
    {"base"},
    {
        "blocks",
        "color",
        "exr",
        "filters",
        "io",
        "moments",
        "outline",
        "solve",
        "spatial",
        "surface",
    },
    {"mesh", "remesh", "scan", "tables", "texels", "wavelet"},
    {"cloud", "contour", "mipmap", "normals", "raster", "resize", "sampling", "voxel"},
    {"reconstruct", "solid", "views"},
)
FLOOR_OF = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
SOURCES = sorted([*INTERNAL.glob("*/*.*"), *PUBLIC.glob("*/*.*")])
_INCLUDE = re.compile(r'^\s*#\s*include\s+["<]prefilter/((\w+)/[\w/]+\.h)[">]', re.MULTILINE)


def _includes(source: str) -> list[str]:
    return [path for path, _ in _INCLUDE.findall(source)]


def _trespasses(room: str, source: str) -> Iterator[str]:
    """Yields the rooms that a file of a room includes and must not."""
    for _, included in _INCLUDE.findall(source):
        if included != room and FLOOR_OF[included] >= FLOOR_OF[room]:
            yield included


def _internal(paths: Iterable[Path]) -> list[str]:
    """Returns what some files include that is not public."""
    return [
        f"{path.relative_to(NATIVE)} includes {included}"
        for path in paths
        for included in _includes(path.read_text())
        if not (PUBLIC / included).is_file()
    ]


def test_every_room_has_a_floor() -> None:
    assert {path.parent.name for path in SOURCES} == set(FLOOR_OF)


def test_rooms_include_only_what_stands_below() -> None:
    found = [
        f"{path.relative_to(NATIVE)} includes {included}/"
        for path in SOURCES
        for included in _trespasses(path.parent.name, path.read_text())
    ]
    assert not found


def test_public_headers_include_public_headers() -> None:
    headers = sorted(PUBLIC.rglob("*.*"))
    assert headers
    assert {path.suffix for path in headers} == {".h"}
    assert not _internal(headers)


def test_bindings_include_public_headers() -> None:
    assert not _internal(sorted(NATIVE.glob("python/*.*")))


def test_a_header_is_public_or_internal() -> None:
    public = {path.relative_to(PUBLIC) for path in PUBLIC.rglob("*.h")}
    assert not public & {path.relative_to(INTERNAL) for path in INTERNAL.rglob("*.h")}


@pytest.mark.parametrize(
    ("room", "included", "expected"),
    [
        ("voxel", "wavelet", []),
        ("voxel", "voxel", []),
        ("wavelet", "voxel", ["voxel"]),
        ("voxel", "contour", ["contour"]),
    ],
)
def test_trespasses_are_found(room: str, included: str, expected: list[str]) -> None:
    source = f'#include <vector>\n#include "prefilter/{included}/octree.h"\n'
    assert list(_trespasses(room, source)) == expected


@pytest.mark.parametrize(
    ("header", "expected"), [("voxel/octree.h", []), ("voxel/regrid.h", ["voxel/regrid.h"])]
)
def test_internal_headers_are_found(header: str, expected: list[str]) -> None:
    source = f'#include <vector>\n#include "prefilter/{header}"\n'
    assert [path for path in _includes(source) if not (PUBLIC / path).is_file()] == expected


def test_no_two_headers_define_the_same_name() -> None:
    # Two structures of a name are one to the linker: functions of the first serve both.
    homes: dict[str, list[str]] = {}
    for path in SOURCES:
        if path.suffix != ".h":
            continue
        text = path.read_text(encoding="utf-8")
        for name in re.findall(r"^(?:struct|class|enum class) (\w+)[^;]*?\{", text, re.MULTILINE):
            homes.setdefault(name, []).append(path.name)
    assert len(homes) > 200
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}
