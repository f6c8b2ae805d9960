# SPDX-License-Identifier: GPL-3.0-or-later

"""Reader of Wavefront OBJ files."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .polygons import PolygonMesh, rounded

_NONE = -1
"""The index of a corner without UVs."""


@dataclass
class _Object:
    """The polygons of one object: their sizes, and the words of all corners, such as 3/7/2."""

    name: str
    sizes: list[int] = field(default_factory=list)
    words: list[bytes] = field(default_factory=list)


def read_obj(data: bytes) -> list[PolygonMesh]:
    """Returns the objects of a file that have polygons, in the order of the file.

    Raises:
        ValueError: The file is damaged.
    """
    places: list[Sequence[bytes]] = []
    uvs: list[Sequence[bytes]] = []
    objects: dict[str, _Object] = {}
    current = objects.setdefault("", _Object(""))
    joined = data.removeprefix(b"\xef\xbb\xbf").replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
    for line in joined.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == b"v":
            places.append(words[1:4])
        elif words[0] == b"vt":
            uvs.append([*words[1:3], b"0"][:2])
        elif words[0] == b"f":
            corners = _without_comment(words[1:])
            if b"-" in line:
                corners = [_from_the_start(word, len(places), len(uvs)) for word in corners]
            current.sizes.append(len(corners))
            current.words += corners
        elif words[0] == b"o":
            name = line.split(None, 1)[1].decode("utf-8", "replace").strip() if words[1:] else ""
            current = objects.setdefault(name, _Object(name))
    points = rounded(_numbers(places, 3, "v"))
    coordinates = rounded(_numbers(uvs, 2, "vt"))
    return [_mesh(item, points, coordinates) for item in objects.values() if item.sizes]


def _without_comment(words: list[bytes]) -> list[bytes]:
    for number, word in enumerate(words):
        if word.startswith(b"#"):
            return words[:number]
    return words


def _from_the_start(word: bytes, places: int, uvs: int) -> bytes:
    """Replaces relative (negative) indices in a corner's word by absolute ones."""
    parts = word.split(b"/")
    for number, count in enumerate((places, uvs)[: len(parts)]):
        if parts[number].startswith(b"-"):
            parts[number] = b"%d" % (count + 1 + _integer(parts[number]))
    return b"/".join(parts[:2])


def _numbers(rows: list[Sequence[bytes]], width: int, kind: str) -> NDArray[np.float64]:
    if not rows:
        return np.empty((0, width))
    try:
        return np.array([[float(word) for word in row] for row in rows]).reshape(-1, width)
    except ValueError as error:
        raise ValueError(f"a line '{kind}' has other than {width} numbers") from error


def _integer(word: bytes) -> int:
    try:
        return int(word)
    except ValueError:
        shown = word.decode("utf-8", "replace")
        raise ValueError(f"found '{shown}' in a line 'f'; whole numbers are needed") from None


def _mesh(
    item: _Object, points: NDArray[np.float64], coordinates: NDArray[np.float64]
) -> PolygonMesh:
    indices = _indices(item.words)
    vertices, uvs = indices[:, 0], indices[:, 1]
    _check(vertices, len(points), "vertex")
    _check(uvs[uvs != _NONE], len(coordinates), "UV")
    own, corners = np.unique(vertices, return_inverse=True)
    corner_uvs = None
    if (uvs != _NONE).any():
        corner_uvs = np.full((len(uvs), 2), np.nan)
        corner_uvs[uvs != _NONE] = coordinates[uvs[uvs != _NONE]]
    sizes = np.array(item.sizes, np.int64)
    return PolygonMesh(item.name, points[own], corners.reshape(-1), sizes, corner_uvs)


def _indices(words: list[bytes]) -> NDArray[np.int64]:
    """Returns the vertex index and the UV index of each corner, from 0."""
    slashes = words[0].count(b"/") if words else 0
    text = b" ".join(words)
    is_even = slashes and b"//" not in text and all(word.count(b"/") == slashes for word in words)
    if is_even:
        numbers = [_integer(word) for word in text.replace(b"/", b" ").split()]
        if len(numbers) == len(words) * (slashes + 1):
            return np.array(numbers, np.int64).reshape(-1, slashes + 1)[:, :2] - 1
    pairs = []
    for word in words:
        vertex, uv, *_ = [*word.split(b"/"), b""]
        pairs.append((_integer(vertex) - 1, _integer(uv) - 1 if uv else _NONE))
    return np.array(pairs, np.int64).reshape(-1, 2)


def _check(indices: NDArray[np.int64], count: int, what: str) -> None:
    wrong = indices[(indices < 0) | (indices >= count)]
    if wrong.size:
        raise ValueError(f"a face names {what} {wrong[0] + 1}; there are {count}, from 1")
