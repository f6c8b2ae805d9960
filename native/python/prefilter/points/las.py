# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of LAS files, and of LAZ files, which the package lazrs decompresses.

See the LAS specification 1.4, R15, by the American Society for Photogrammetry and Remote Sensing.
"""

import functools
import os
import re
from collections.abc import Iterator
from types import ModuleType
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from .._border.input import open_file
from .las_header import read_header
from .laz_chunks import check_chunks
from .reader import POINTS_AT_ONCE, PointChunk, damage_of, find_module

_MAX_COLORS_SAMPLED = 1_000_000
_COLORS = ("red", "green", "blue")
_BYTES = ("classification", "return_number", "number_of_returns")
_FIRST_LONG_FORMAT = 6
"""Point format from which on returns have four bits, and classes eight."""

_Records = npt.NDArray[np.void]
_Floats = npt.NDArray[np.float32]


class LasReader:
    """Reads a LAS file, or with lazrs a LAZ file, in chunks.

    Attributes are intensity, classification, numbers of returns, colors (as bytes) and extra
    dimensions. Three extra dimensions named nx, NormalX, normal_x or similarly are the normals.
    """

    viewpoint = None
    can_seek = True

    def __init__(self, path: str) -> None:
        self._path = path
        self._header = header = read_header(path)
        self._lazrs: ModuleType | None = None
        if header.is_compressed:
            self._lazrs = find_module("lazrs", path, "LAZ files", "lazrs", "LAS")
            with damage_of(path, "a LAZ file"):
                check_chunks(path, header, self._lazrs)
        self.count: int | None = header.count
        room = max(os.path.getsize(path) - header.begin, 0)
        if self.count * (0 if header.is_compressed else header.layout.itemsize) > room:
            raise ValueError(
                f"'{path}': too short for the {self.count} points in its header: {room} bytes "
                "follow it"
            )
        scalars = [each.name for each in header.extra]
        self._normals = _normals_among(scalars)
        self._has_colors = set(_COLORS) <= set(header.layout.names or ())
        plain = [name for name in scalars if name not in self._normals]
        self._names = ["intensity", *plain]
        self.has_normals = bool(self._normals)
        self.attributes = [(name, False) for name in self._names]
        self.attributes += [(name, True) for name in _BYTES]
        if self._has_colors:
            self.attributes += [(name, True) for name in _COLORS]

    def chunks(self, begin: int = 0, end: int | None = None) -> Iterator[PointChunk]:
        for points in self._pieces(begin, self._header.count if end is None else end):
            normals = self._columns(points, self._normals) if self._normals else None
            columns = [self._columns(points, [*self._names, *_BYTES])]
            if self._has_colors:
                columns.append(np.round(self._columns(points, _COLORS) * self._color_scale))
            yield self._positions(points), normals, None, None, np.concatenate(columns, axis=1)

    @functools.cached_property
    def _color_scale(self) -> np.float32:
        # Colors have 16 bits, but some programs fill only the lower 8. Reading many colors that are
        # not black shows which. Cached and lazy: a render farm task may open thousands of files,
        # and read only one of them.
        colored = 0
        for points in self._pieces(0, self._header.count):
            colors = self._columns(points, _COLORS)
            if colors.max(initial=0) > 255:
                return np.float32(255 / 65535)
            colored += int(np.count_nonzero(colors.any(axis=1)))
            if colored > _MAX_COLORS_SAMPLED:
                break
        return np.float32(1)

    def _pieces(self, begin: int, end: int) -> Iterator[_Records]:
        """Yields the records of points [begin, end), in chunks."""
        layout = self._header.layout
        with open_file(self._path) as file:
            decompressor = None
            if self._lazrs is not None:
                decompressor = self._decompressor(self._lazrs, file, begin)
            else:
                file.seek(self._header.begin + begin * layout.itemsize)
            for first in range(begin, end, POINTS_AT_ONCE):
                data = bytearray(min(POINTS_AT_ONCE, end - first) * layout.itemsize)
                if decompressor is None:
                    read = file.readinto(data)  # type: ignore[attr-defined]
                    if read != len(data):
                        raise ValueError(
                            f"'{self._path}': ends after {first + read // layout.itemsize} of the "
                            f"{self._header.count} points in its header"
                        )
                else:
                    with damage_of(self._path, "a LAZ file"):
                        decompressor.decompress_many(data)
                yield np.frombuffer(data, layout)

    def _decompressor(self, lazrs: ModuleType, file: BinaryIO, begin: int) -> Any:
        """Decompressor of the points from `begin` on."""
        with damage_of(self._path, "a LAZ file"):
            file.seek(self._header.begin)
            decompressor = lazrs.LasZipDecompressor(file, self._header.packing)
            if begin > 0:
                decompressor.seek(begin)
            return decompressor

    def _positions(self, points: _Records) -> npt.NDArray[np.float64]:
        # Scales of a damaged header give positions that are not finite; callers count these.
        with np.errstate(all="ignore"):
            steps = np.stack([points[axis] for axis in "xyz"], axis=1)
            return steps * self._header.scales + self._header.offsets

    def _columns(self, points: _Records, names: tuple[str, ...] | list[str]) -> _Floats:
        with np.errstate(all="ignore"):
            return np.stack([self._column(points, name) for name in names], axis=1)

    def _column(self, points: _Records, name: str) -> _Floats:
        bits = 4 if self._header.point_format >= _FIRST_LONG_FORMAT else 3
        if name == "return_number":
            return (points["returns"] & ((1 << bits) - 1)).astype(np.float32)
        if name == "number_of_returns":
            return (points["returns"] >> bits & ((1 << bits) - 1)).astype(np.float32)
        if name == "classification" and self._header.point_format < _FIRST_LONG_FORMAT:
            # The other bits are flags.
            return (points["classification"] & 31).astype(np.float32)
        for each in self._header.extra:
            if each.name == name:
                values = points[each.field].astype(np.float64) * each.scale + each.offset
                return values.astype(np.float32)
        return points[name].astype(np.float32)


def _normals_among(names: list[str]) -> list[str]:
    """Names of the three dimensions of normals; empty where one is missing."""
    short = {re.sub("[^a-z]", "", name.lower()).replace("normal", "n"): name for name in names}
    axes = [short.get(axis) for axis in ("nx", "ny", "nz")]
    return [name for name in axes if name is not None] if all(axes) else []
