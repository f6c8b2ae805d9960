# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of LAS and LAZ files, read by laspy."""

import functools
import importlib
import os
import re
import struct
from collections.abc import Iterator
from typing import Any, BinaryIO

import numpy as np

from .._border.input import open_file
from .laz_chunks import check_chunks
from .reader import POINTS_AT_ONCE, PointChunk, damage_of, find_module

_COLORS_LOOKED_AT = 1_000_000
_COLORS = ("red", "green", "blue")
_BYTES = ("classification", "return_number", "number_of_returns")


class LasReader:
    """Reads a LAS file, or with one of laspy's backends a LAZ file, piece by piece.

    Attributes are intensity, classification, the numbers of returns, colors as bytes, and what
    extra dimensions there are; three of these named like normals (nx, NormalX, normal_x) are the
    normals.
    """

    viewpoint = None
    can_seek = True

    def __init__(self, path: str) -> None:
        self._path = path
        self._laspy = find_module("laspy", path, "LAS and LAZ files", "laspy[lazrs]")
        _check_header(path)
        with self._opened() as file:
            header = file.header
            self.count: int | None = int(header.point_count)
            names = set(header.point_format.dimension_names)
            extra = list(header.point_format.extra_dimension_names)
            room = max(os.path.getsize(path) - header.offset_to_point_data, 0)
            least = 0 if header.are_points_compressed else header.point_format.size
            if self.count * least > room:
                raise ValueError(
                    f"'{path}': too short for the {self.count} points in its header: {room} bytes "
                    "follow it"
                )
            if header.are_points_compressed:
                self._check_chunks(header)
            scalars = [name for name in extra if header.point_format[name].num_elements == 1]
        self._normals = _normals_among(scalars)
        self._has_colors = set(_COLORS) <= names
        plain = [name for name in scalars if name not in self._normals]
        self._names = ["intensity", *plain]
        self.has_normals = bool(self._normals)
        self.attributes = [(name, False) for name in self._names]
        self.attributes += [(name, True) for name in _BYTES]
        if self._has_colors:
            self.attributes += [(name, True) for name in _COLORS]

    def chunks(self, begin: int = 0, end: int | None = None) -> Iterator[PointChunk]:
        found = begin
        for points in self._pieces(begin, end):
            found += len(points)
            positions = _positions(points)
            normals = _columns(points, self._normals) if self._normals else None
            columns = [_columns(points, [*self._names, *_BYTES])]
            if self._has_colors:
                columns.append(np.round(_columns(points, _COLORS) * self._color_scale))
            yield positions, normals, None, None, np.concatenate(columns, axis=1)
        if found != (self.count if end is None else end):
            raise ValueError(
                f"'{self._path}': ends after {found} of the {self.count} points in its header"
            )

    def _check_chunks(self, header: Any) -> None:
        backends = self._laspy.LazBackend.detect_available()
        if any(backend.name.startswith("Lazrs") for backend in backends):
            with damage_of(self._path, "a LAZ file"):
                check_chunks(self._path, header, importlib.import_module("lazrs"))

    @functools.cached_property
    def _color_scale(self) -> np.float32:
        # Colors have 16 bits, of which some programs fill only the lower 8. Many that are not black
        # tell which. Of thousands of files, a task on a farm reads but one.
        colored = 0
        for points in self._pieces():
            colors = _columns(points, _COLORS)
            if colors.max(initial=0) > 255:
                return np.float32(255 / 65535)
            colored += int(np.count_nonzero(colors.any(axis=1)))
            if colored > _COLORS_LOOKED_AT:
                break
        return np.float32(1)

    def _opened(self) -> Any:
        with damage_of(self._path, "a LAS file"):
            return self._laspy.open(self._path)

    def _pieces(self, begin: int = 0, end: int | None = None) -> Iterator[Any]:
        with self._opened() as file:
            if begin > 0:
                with damage_of(self._path, "a LAS file"):
                    file.seek(begin)
            while True:
                some = POINTS_AT_ONCE if end is None else min(POINTS_AT_ONCE, end - begin)
                with damage_of(self._path, "a LAS file"):
                    points = file.read_points(some) if some > 0 else ()
                if len(points) == 0:
                    return
                begin += len(points)
                yield points


def _check_header(path: str) -> None:
    """Refuses sizes that the file has no room for: laspy would go on for hours, or need them all.

    See the public header block in the specification of LAS 1.4.
    """
    with open_file(path) as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        header = file.read(255)
        end = _end_of_records(file, header, size)
    if header[:4] != b"LASF" or len(header) < 227:
        raise ValueError(f"'{path}' is not a LAS file: it begins with {header[:4]!r}")
    begin, count = struct.unpack_from("<2I", header, 96)
    if max(begin, count * 54, end) > size:
        raise ValueError(f"'{path}': too short for the records that its header announces")


def _end_of_records(file: BinaryIO, header: bytes, size: int) -> int:
    """Where the extended records of LAS 1.4 end, or the first of them that the file cuts off."""
    if len(header) < 247 or header[25] < 4:
        return 0
    begin, count = struct.unpack_from("<QI", header, 235)
    end: int = begin if count else 0
    for _ in range(count):
        if end + 60 > size:
            return end + 60
        file.seek(end + 20)
        end += 60 + struct.unpack("<Q", file.read(8))[0]
    return end


def _positions(points: Any) -> np.ndarray:
    # Scales of a damaged header make what is not finite, which readers of positions find.
    with np.errstate(all="ignore"):
        return np.stack([points.x, points.y, points.z], axis=1).astype(np.float64)


def _columns(points: Any, names: tuple[str, ...] | list[str]) -> np.ndarray:
    # Extra dimensions may be scaled, and of double precision.
    with np.errstate(all="ignore"):
        return np.stack([np.asarray(points[name], np.float32) for name in names], axis=1)


def _normals_among(names: list[str]) -> list[str]:
    """The names of three dimensions that hold normals; none where one is missing."""
    short = {re.sub("[^a-z]", "", name.lower()).replace("normal", "n"): name for name in names}
    axes = [short.get(axis) for axis in ("nx", "ny", "nz")]
    return [name for name in axes if name is not None] if all(axes) else []
