# SPDX-License-Identifier: GPL-3.0-or-later

"""The C++ library stands on floors: a folder includes only itself and what stands below it."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

LIBRARY = Path(__file__).resolve().parents[2] / "native/prefilter"
FLOORS = (
    {"base"},
    {"blocks", "color", "exr", "filters", "io", "moments", "outline", "solve", "spatial", "surface"},
    {"mesh", "remesh", "scan", "tables", "texels", "wavelet"},
    {"contour", "mipmap", "normals", "raster", "resize", "sampling", "voxel"},
    {"reconstruct", "solid"},
)
FLOOR_OF = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
_INCLUDE = re.compile(r'^\s*#\s*include\s+"prefilter/(\w+)/', re.MULTILINE)


def _trespasses(room: str, source: str) -> Iterator[str]:
    """Yields the rooms that a file of a room includes and must not."""
    for included in _INCLUDE.findall(source):
        if included != room and FLOOR_OF[included] >= FLOOR_OF[room]:
            yield included


def test_every_room_has_a_floor() -> None:
    assert {path.parent.name for path in LIBRARY.glob("*/*.*")} == set(FLOOR_OF)


def test_rooms_include_only_what_stands_below() -> None:
    found = [
        f"{path.relative_to(LIBRARY)} includes {included}/"
        for path in sorted(LIBRARY.glob("*/*.*"))
        for included in _trespasses(path.parent.name, path.read_text())
    ]
    assert not found


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
