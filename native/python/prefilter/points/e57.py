# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of E57 files."""

import os
from collections.abc import Iterator

import numpy as np

from .. import _native
from .._border.input import open_file
from .e57_file import Floats, PagedFile, Scan, read_scans
from .reader import POINTS_AT_ONCE, PointChunk, damage_of

_CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
_SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
_COLORS = ("colorRed", "colorGreen", "colorBlue")
_NORMALS = ("normalX", "normalY", "normalZ")
# Counted from 0, unlike in LAS files and others.
_RETURN, _RETURNS = "returnIndex", "returnCount"
_INVALID = ("cartesianInvalidState", "sphericalInvalidState")
_GRID = frozenset({"rowIndex", "columnIndex"})


class E57Reader:
    """Reads all scans of an E57 file, one after the other, in chunks.

    Points are transformed to the file's coordinates by the pose of their scan; points marked as
    invalid are left out. Intensity, colors (as bytes), numbers of returns and normals are read if
    all scans have them. The viewpoint of a scan is the translation of its pose, or the origin for a
    scanner's grid or spherical coordinates without a pose. A single scan at the origin that is
    neither has no viewpoint.
    """

    can_seek = False

    def __init__(self, path: str) -> None:
        self._path = path
        with open_file(path) as file, damage_of(path, "an E57 file"):
            self._scans = scans = read_scans(PagedFile(file))
        fields = [scan.names for scan in scans]
        if not all(set(_CARTESIAN) <= each or set(_SPHERICAL) <= each for each in fields):
            raise ValueError(f"'{path}': a scan has neither Cartesian nor spherical coordinates")
        common = set.intersection(*fields) if fields else set()
        _check_counts(path, [scan.count for scan in scans])
        has_gaps = any(name in each for each in fields for name in _INVALID)
        self.count = None if has_gaps else sum(scan.count for scan in scans)
        self.has_normals = set(_NORMALS) <= common
        self._has_colors = set(_COLORS) <= common
        self._has_intensity = "intensity" in common
        self.attributes = [("intensity", False)] if self._has_intensity else []
        if self._has_colors:
            self.attributes += [(name, True) for name in ("red", "green", "blue")]
        self._has_returns = {_RETURN, _RETURNS} <= common
        if self._has_returns:
            self.attributes += [("return_number", True), ("number_of_returns", True)]
        self._has_viewpoints = bool(scans) and all(map(_has_viewpoint, scans))
        # A cloud merged from several scans has the origin for a pose, too.
        if len(scans) == 1 and not scans[0].translation.any() and not _is_as_scanned(scans[0]):
            self._has_viewpoints = False
        self.viewpoint: tuple[float, float, float] | None = None
        positions = [scan.translation for scan in scans]
        if self._has_viewpoints and all(np.array_equal(each, positions[0]) for each in positions):
            x, y, z = positions[0]
            self.viewpoint = (float(x), float(y), float(z))
            self._has_viewpoints = False  # One for all points, instead of one for each.

    def chunks(self, begin: int = 0, end: int | None = None) -> Iterator[PointChunk]:
        assert begin == 0
        assert end is None
        with open_file(self._path) as file:
            with damage_of(self._path, "an E57 file"):
                pages = PagedFile(file)
            for scan in self._scans:
                yield from self._chunks_of(pages, scan)

    def _chunks_of(self, file: PagedFile, scan: Scan) -> Iterator[PointChunk]:
        is_cartesian = set(_CARTESIAN) <= scan.names
        coordinates = _CARTESIAN if is_cartesian else _SPHERICAL
        invalid = _INVALID[0 if is_cartesian else 1]
        names = [*coordinates, *([invalid] if invalid in scan.names else [])]
        names += [name for name in ("intensity",) if self._has_intensity]
        names += [name for name in _COLORS if self._has_colors]
        names += [name for name in _NORMALS if self.has_normals]
        names += [name for name in (_RETURN, _RETURNS) if self._has_returns]
        pieces = scan.values(file, names, POINTS_AT_ONCE)
        while True:
            with damage_of(self._path, "an E57 file"), np.errstate(all="ignore"):
                values = next(pieces, None)
            if values is None:
                return
            if invalid in values:
                # 1: only the direction of the point is known.
                valid = values.pop(invalid) == 0
                values = {name: each[valid] for name, each in values.items()}
            local = np.stack([values[name] for name in coordinates], axis=1)
            yield self._chunk(
                scan, values, local if is_cartesian else _native.from_spherical(local)
            )

    def _chunk(self, scan: Scan, values: dict[str, Floats], local: Floats) -> PointChunk:
        with np.errstate(all="ignore"):
            positions = _rotated(local, scan.rotation) + scan.translation
        normals = None
        if self.has_normals:
            along = np.stack([values[name] for name in _NORMALS], axis=1)
            normals = _rotated(along, scan.rotation).astype(np.float32)
        columns = [values["intensity"][:, None]] if self._has_intensity else []
        if self._has_colors:
            highest = scan.highest_colors
            scale = np.divide(255.0, highest, out=np.ones(3), where=highest > 0.0)
            colors = np.stack([values[name] for name in _COLORS], axis=1)
            columns.append(np.round(colors * scale))
        if self._has_returns:
            columns.append(np.stack([values[_RETURN] + 1, values[_RETURNS]], axis=1))
        columns.append(np.empty((len(positions), 0)))
        with np.errstate(all="ignore"):
            attributes = np.ascontiguousarray(np.concatenate(columns, axis=1), np.float32)
        viewpoints = None
        if self._has_viewpoints:
            viewpoints = np.tile(scan.translation, (len(positions), 1))
        return np.ascontiguousarray(positions), normals, None, viewpoints, attributes


def _is_as_scanned(scan: Scan) -> bool:
    """Whether the points are still in the grid or spherical coordinates of a scanner."""
    return scan.names >= _GRID or scan.names >= set(_SPHERICAL)


def _has_viewpoint(scan: Scan) -> bool:
    return scan.has_pose or _is_as_scanned(scan)


def _check_counts(path: str, counts: list[int]) -> None:
    """Refuses counts that exceed the size of the file, before memory is allocated for them."""
    # The coordinates of a point take at least one bit.
    bits = 8 * os.path.getsize(path)
    for count in counts:
        if not 0 <= count <= bits:
            raise ValueError(
                f"'{path}': too short for the {count} points of a scan in its header: it has "
                f"{bits // 8} bytes"
            )


def _rotated(vectors: Floats, rotation: Floats) -> Floats:
    # A matrix product would sum in an order that depends on the processor.
    x, y, z = vectors.T[:, :, None]
    return np.asarray(x * rotation[:, 0] + y * rotation[:, 1] + z * rotation[:, 2])
