# SPDX-License-Identifier: GPL-3.0-or-later

"""The C++ library's wings are layered, and public headers are apart from internal ones.

A wing is a folder of native/prefilter, with the public headers in the folder of that name in
native/include; its rooms are the folders in it. A wing includes only itself and wings on lower
floors, and the rooms of a wing include each other without a cycle. Public headers include no
internal ones, and the bindings, like every other program that uses the library, include public
headers alone.
"""

import re
from collections.abc import Iterable, Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

NATIVE = Path(__file__).resolve().parents[2] / "native"
INTERNAL = NATIVE / "prefilter"
PUBLIC = NATIVE / "include/prefilter"
FLOORS = (
    {"base"},
    {"geometry", "images"},
    {"wavelet"},
    {"sampling", "shapes", "voxels"},
    {"textures", "points"},
)
FLOOR_OF = {wing: floor for floor, wings in enumerate(FLOORS) for wing in wings}
SOURCES = sorted(
    path
    for folder in (INTERNAL, PUBLIC)
    for path in folder.rglob("*.*")
    if path.suffix in {".h", ".cpp"}
)
_INCLUDE = re.compile(r'^\s*#\s*include\s+["<]prefilter/([\w/]+\.h)[">]', re.MULTILINE)


def _includes(source: str) -> list[str]:
    return _INCLUDE.findall(source)


def _wing(path: Path) -> str:
    """Returns the wing that a source file belongs to."""
    return path.relative_to(PUBLIC if path.is_relative_to(PUBLIC) else INTERNAL).parts[0]


def _trespasses(wing: str, source: str) -> Iterator[str]:
    """Yields the wings that a file of a wing includes although they are not on a lower floor."""
    for header in _includes(source):
        included = header.split("/")[0]
        if included != wing and FLOOR_OF[included] >= FLOOR_OF[wing]:
            yield included


def _internal(paths: Iterable[Path]) -> list[str]:
    """Returns the non-public files that some files include."""
    return [
        f"{path.relative_to(NATIVE)} includes {included}"
        for path in paths
        for included in _includes(path.read_text())
        if not (PUBLIC / included).is_file()
    ]


def test_every_wing_has_a_floor() -> None:
    assert {_wing(path) for path in SOURCES} == set(FLOOR_OF)


def test_wings_include_only_lower_floors() -> None:
    trespasses = [
        f"{path.relative_to(NATIVE)} includes {included}/"
        for path in SOURCES
        for included in _trespasses(_wing(path), path.read_text())
    ]
    assert not trespasses


def test_rooms_of_a_wing_have_no_cycle() -> None:
    # A wing's public headers belong to all of its rooms.
    rooms: dict[Path, set[Path]] = {}
    for path in INTERNAL.rglob("*.*"):
        headers = (INTERNAL / header for header in _includes(path.read_text()))
        included = {header.parent for header in headers if header.is_file()}
        rooms.setdefault(path.parent, set()).update(included - {path.parent})
    assert len(rooms) > len(FLOOR_OF)
    TopologicalSorter(rooms).prepare()


def test_public_headers_include_public_headers() -> None:
    headers = sorted(path for path in PUBLIC.rglob("*") if path.is_file())
    assert headers
    assert {path.suffix for path in headers} == {".h"}
    assert not _internal(headers)


def test_bindings_include_public_headers() -> None:
    assert not _internal(sorted(NATIVE.glob("python/*.*")))


def test_a_header_is_public_or_internal() -> None:
    public = {path.relative_to(PUBLIC) for path in PUBLIC.rglob("*.h")}
    assert not public & {path.relative_to(INTERNAL) for path in INTERNAL.rglob("*.h")}


@pytest.mark.parametrize(
    ("wing", "included", "expected"),
    [
        ("voxels", "wavelet", []),
        ("voxels", "voxels", []),
        ("wavelet", "voxels", ["voxels"]),
        ("voxels", "shapes", ["shapes"]),
    ],
)
def test_trespasses_are_found(wing: str, included: str, expected: list[str]) -> None:
    source = f'#include <vector>\n#include "prefilter/{included}/octree.h"\n'
    assert list(_trespasses(wing, source)) == expected


@pytest.mark.parametrize(
    ("header", "expected"), [("voxels/octree.h", []), ("voxels/regrid.h", ["voxels/regrid.h"])]
)
def test_internal_headers_are_found(header: str, expected: list[str]) -> None:
    source = f'#include <vector>\n#include "prefilter/{header}"\n'
    assert [path for path in _includes(source) if not (PUBLIC / path).is_file()] == expected


def test_no_two_headers_define_the_same_name() -> None:
    # The linker merges structures of the same name: the first one's functions would serve both.
    homes: dict[str, list[str]] = {}
    for path in SOURCES:
        if path.suffix != ".h":
            continue
        text = path.read_text(encoding="utf-8")
        for name in re.findall(r"^(?:struct|class|enum class) (\w+)[^;]*?\{", text, re.MULTILINE):
            homes.setdefault(name, []).append(path.name)
    assert len(homes) > 200
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}
