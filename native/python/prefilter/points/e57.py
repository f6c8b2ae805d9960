# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of E57 files, read by pye57."""

import os
from collections.abc import Iterator
from typing import Any

import numpy as np

from .. import _native
from .reader import POINTS_AT_ONCE, PointChunk, damage_of, find_module

_CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
_SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
_COLORS = ("colorRed", "colorGreen", "colorBlue")
_NORMALS = ("nor:normalX", "nor:normalY", "nor:normalZ")
# From 0 on, which LAS files and others count from 1.
_RETURN, _RETURNS = "returnIndex", "returnCount"
_INVALID = ("cartesianInvalidState", "sphericalInvalidState")


class E57Reader:
    """Reads all scans of an E57 file, one after the other, piece by piece.

    Points are carried to the file's coordinates by the pose of their scan; those that a scan marks
    as invalid are left out. Intensity, colors, as bytes, and the numbers of returns are attributes
    where all scans have them, and normals likewise. Where scans have a pose, the scanner stood at
    its translation; the origin tells nothing where there is only one scan, and no grid.
    """

    can_seek = False

    def __init__(self, path: str) -> None:
        self._path = path
        self._pye57 = find_module("pye57", path, "E57 files", "pye57")
        with self._opened() as file:
            scans = [file.get_header(k) for k in range(file.scan_count)]
            fields = [set(scan.point_fields) for scan in scans]
            if not all(set(_CARTESIAN) <= each or set(_SPHERICAL) <= each for each in fields):
                raise ValueError(
                    f"'{path}': a scan has neither Cartesian nor spherical coordinates"
                )
            common = set.intersection(*fields) if fields else set()
            _check_counts(path, [int(scan.point_count) for scan in scans])
            has_gaps = any(name in each for each in fields for name in _INVALID)
            self.count = None if has_gaps else sum(int(scan.point_count) for scan in scans)
            places = [scan.translation for scan in scans if scan.has_pose()]
            # A cloud put together from several scans has the origin for a pose, too.
            if len(scans) == 1 and places and not places[0].any() and "rowIndex" not in common:
                places = []
        self.has_normals = set(_NORMALS) <= common
        self._has_colors = set(_COLORS) <= common
        self._has_intensity = "intensity" in common
        self.attributes = [("intensity", False)] if self._has_intensity else []
        if self._has_colors:
            self.attributes += [(name, True) for name in ("red", "green", "blue")]
        self._has_returns = {_RETURN, _RETURNS} <= common
        if self._has_returns:
            self.attributes += [("return_number", True), ("number_of_returns", True)]
        # One for all points, or one for each.
        self._has_viewpoints = bool(places) and len(places) == len(fields)
        self.viewpoint: tuple[float, float, float] | None = None
        if self._has_viewpoints and all(np.array_equal(place, places[0]) for place in places):
            x, y, z = places[0]
            self.viewpoint = (float(x), float(y), float(z))
            self._has_viewpoints = False

    def chunks(self, begin: int = 0, end: int | None = None) -> Iterator[PointChunk]:
        assert begin == 0
        assert end is None
        with self._opened() as file:
            for k in range(file.scan_count):
                yield from self._chunks_of(file, file.get_header(k))

    def _chunks_of(self, file: Any, scan: Any) -> Iterator[PointChunk]:
        fields = set(scan.point_fields)
        is_cartesian = set(_CARTESIAN) <= fields
        coordinates = _CARTESIAN if is_cartesian else _SPHERICAL
        invalid = _INVALID[0 if is_cartesian else 1]
        names = [*coordinates, *([invalid] if invalid in fields else [])]
        names += [name for name in ("intensity",) if self._has_intensity]
        names += [name for name in _COLORS if self._has_colors]
        names += [name for name in _NORMALS if self.has_normals]
        names += [name for name in (_RETURN, _RETURNS) if self._has_returns]
        scale = _color_scale(scan) if self._has_colors else np.ones(3)
        rotation, translation = scan.rotation_matrix, scan.translation
        data = {name: np.empty(POINTS_AT_ONCE) for name in names}
        with damage_of(self._path, "an E57 file"):
            reader = scan.points.reader(self._buffers(file, data))
        found = 0
        while True:
            with damage_of(self._path, "an E57 file"):
                count = reader.read()
            found += count
            if count == 0:
                if found != int(scan.point_count):
                    raise ValueError(
                        f"'{self._path}': a scan ends after {found} of the {scan.point_count} "
                        "points in its header"
                    )
                return
            values = {name: each[:count] for name, each in data.items()}
            if invalid in values:
                # 1 says that only the direction is known.
                valid = values.pop(invalid) == 0
                values = {name: each[valid] for name, each in values.items()}
            local = np.stack([values[name] for name in coordinates], axis=1)
            if not is_cartesian:
                local = _native.from_spherical(local)
            positions = _rotated(local, rotation) + translation
            normals = None
            if self.has_normals:
                along = np.stack([values[name] for name in _NORMALS], axis=1)
                normals = _rotated(along, rotation).astype(np.float32)
            columns = [values["intensity"][:, None]] if self._has_intensity else []
            if self._has_colors:
                colors = np.stack([values[name] for name in _COLORS], axis=1)
                columns.append(np.round(colors * scale))
            if self._has_returns:
                columns.append(np.stack([values[_RETURN] + 1, values[_RETURNS]], axis=1))
            columns.append(np.empty((len(positions), 0)))
            attributes = np.ascontiguousarray(np.concatenate(columns, axis=1), np.float32)
            places = None
            if self._has_viewpoints:
                places = np.tile(np.asarray(translation, np.float64), (len(positions), 1))
            yield np.ascontiguousarray(positions), normals, None, places, attributes

    def _buffers(self, file: Any, data: dict[str, np.ndarray]) -> Any:
        libe57 = self._pye57.libe57
        buffers = libe57.VectorSourceDestBuffer()
        for name, values in data.items():
            # Converted to doubles, and scaled integers to what they stand for.
            buffer = libe57.SourceDestBuffer(file.image_file, name, values, len(values), True, True)
            buffers.append(buffer)
        return buffers

    def _opened(self) -> Any:
        with damage_of(self._path, "an E57 file"):
            return self._pye57.E57(self._path)


def _check_counts(path: str, counts: list[int]) -> None:
    """Refuses counts that the file has no room for, before memory is taken for them."""
    # What says where a point is takes a bit at least.
    bits = 8 * os.path.getsize(path)
    for count in counts:
        if not 0 <= count <= bits:
            raise ValueError(
                f"'{path}': too short for the {count} points of a scan in its header: it has "
                f"{bits // 8} bytes"
            )


def _color_scale(scan: Any) -> np.ndarray:
    """What makes bytes of the colors of a scan, which says how large they can be."""
    scales = []
    for name in _COLORS:
        try:
            highest = float(scan["colorLimits"][name + "Maximum"].value())
        except Exception:  # pye57 raises its own where there is no such element.
            highest = 255.0
        scales.append(255.0 / highest if highest > 0.0 else 1.0)
    return np.array(scales)


def _rotated(vectors: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    # Products of matrices are added up in another order on another processor.
    x, y, z = vectors.T[:, :, None]
    return np.asarray(x * rotation[:, 0] + y * rotation[:, 1] + z * rotation[:, 2])
