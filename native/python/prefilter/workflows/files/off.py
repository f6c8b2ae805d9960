# SPDX-License-Identifier: GPL-3.0-or-later

"""Reader of OFF files."""

import re

import numpy as np

from .polygons import PolygonMesh, rounded

_HEADER = re.compile(r"(ST)?(C)?(N)?OFF\b")


def read_off(data: bytes) -> list[PolygonMesh]:
    """Returns the mesh of a text file, as a list of one.

    Raises:
        ValueError: The file is damaged, or of another variant, such as binary.
    """
    text = data.decode("utf-8-sig", "replace")
    lines = [line.split() for line in re.sub(r"#[^\n]*", "", text).splitlines()]
    lines = [words for words in lines if words]
    header = _HEADER.fullmatch(lines[0][0]) if lines else None
    if header is None or "BINARY" in lines[0]:
        raise ValueError("its first line is not OFF, COFF, NOFF or STOFF, of text")
    lines[0] = lines[0][1:]
    rows = iter(lines if lines[0] else lines[1:])
    try:
        vertices, faces = (int(word) for word in next(rows)[:2])
        numbers = [[float(word) for word in next(rows)] for _ in range(vertices)]
        polygons = [[int(word) for word in _corners(next(rows))] for _ in range(faces)]
    except (StopIteration, ValueError) as error:
        raise ValueError("it ends too early, or has a word where a number is needed") from error
    if any(len(row) < 3 for row in numbers):
        raise ValueError("a vertex has fewer than 3 coordinates")
    corners = np.array([corner for polygon in polygons for corner in polygon], np.int64)
    wrong = corners[(corners < 0) | (corners >= vertices)]
    if wrong.size:
        raise ValueError(f"a face names vertex {wrong[0]}; there are {vertices}, from 0")
    uvs = None
    if header[1]:
        uvs = rounded([row[-2:] for row in numbers]).reshape(-1, 2)[corners]
    places = rounded([row[:3] for row in numbers]).reshape(-1, 3)
    sizes = np.array([len(polygon) for polygon in polygons], np.int64)
    return [PolygonMesh("", places, corners, sizes, uvs)]


def _corners(words: list[str]) -> list[str]:
    count = int(words[0])
    if count < 0 or len(words) <= count:
        raise ValueError(words)
    return words[1 : count + 1]
