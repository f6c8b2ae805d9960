# SPDX-License-Identifier: GPL-3.0-or-later

"""Range scans of the Stanford repository, put together as their .conf files say."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
LONGEST = 4.0  # Edges of the grid, in its median: longer ones span a step in depth.


def merged(conf: Path) -> tuple[Floats, NDArray[np.float32]]:
    """Returns points and normals of all scans that a .conf file places, in one frame.

    Points that no triangle of their grid has are left out: they have no normal.
    """
    found = [placed(*scan) for scan in placements(conf)]
    points, normals = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return points, normals.astype(np.float32)


def placements(conf: Path) -> list[tuple[Path, Floats, Floats]]:
    """Returns each scan's file, translation (3,) and quaternion (4,), the real part last."""
    lines = (line.split() for line in conf.read_text().splitlines())
    scans = [fields for fields in lines if fields and fields[0] == "bmesh"]
    return [(conf.parent / f[1], np.array(f[2:5], float), np.array(f[5:9], float)) for f in scans]


def placed(path: Path, translation: Floats, quaternion: Floats) -> tuple[Floats, Floats]:
    """Returns points and normals of a scan in the common frame."""
    points, grid = read(path)
    normals = grid_normals(points, grid)
    seen = (normals != 0).any(axis=1)
    matrix = rotation(quaternion)
    return points[seen] @ matrix.T + translation, normals[seen] @ matrix.T


def rotation(quaternion: Floats) -> Floats:
    """The matrix of a quaternion (x, y, z, w), with the rotation direction of these files."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
            [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
            [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def read(path: Path) -> tuple[Floats, NDArray[np.int64]]:
    """Returns a scan's points, and its grid of their indices, -1 where it saw none."""
    head, body = path.read_text().split("end_header\n", 1)
    size = {key: int(value) for key, value in re.findall(r"obj_info num_(\w+) (\d+)", head)}
    count = int(re.search(r"element vertex (\d+)", head)[1])
    lines = body.splitlines()
    points = np.array([line.split()[:3] for line in lines[:count]], float)
    cells = size["rows"] * size["cols"]
    grid = [int(line[2:]) if line[0] == "1" else -1 for line in lines[count : count + cells]]
    return points, np.array(grid).reshape(size["rows"], size["cols"])


def grid_normals(points: Floats, grid: NDArray[np.int64]) -> Floats:
    """Returns normals of length 1 toward the scanner, 0 where no triangle has the point."""
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    corners = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    corners = corners[(corners >= 0).all(axis=1)]
    p, q, r = np.moveaxis(points[corners], 1, 0)
    edges = np.stack([np.linalg.norm(v, axis=1) for v in (q - p, r - q, p - r)])
    kept = edges.max(axis=0) < LONGEST * np.median(edges.min(axis=0))
    areas = np.cross(q - p, r - p)[kept]
    normals = np.zeros_like(points)
    for corner in corners[kept].T:
        np.add.at(normals, corner, areas)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(lengths > 0, lengths, 1)
    return normals * np.sign(normals[:, 2].sum())  # The scanner looks along -z.
