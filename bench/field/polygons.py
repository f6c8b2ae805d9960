# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of polygons, read and triangulated without the library that is judged."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Faces = list[tuple[int, ...]]


def read_obj(path: Path) -> tuple[Floats, Indices]:
    """Returns the positions and triangles of an OBJ file."""
    positions: list[list[float]] = []
    faces: Faces = []
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                positions.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                numbers = [int(word.partition("/")[0]) for word in words[1:]]
                faces.append(tuple(n - 1 if n > 0 else len(positions) + n for n in numbers))
    return triangulated(np.array(positions), faces)


def read_ascii_ply(path: Path) -> tuple[Floats, Indices] | None:
    """Returns the positions and triangles of a PLY file in ASCII of positions alone, or None."""
    lines = path.read_bytes().split(b"\n")
    head = lines[: lines.index(b"end_header") + 1] if b"end_header" in lines else []
    names = [line.split()[-1] for line in head if line.startswith(b"property")]
    if b"format ascii 1.0" not in head or names != [b"x", b"y", b"z", b"vertex_indices"]:
        return None
    vertices, faces = (int(line.split()[-1]) for line in head if line.startswith(b"element"))
    body = lines[len(head) :]
    positions = np.array([line.split() for line in body[:vertices]], float)
    rows = [tuple(map(int, line.split()[1:])) for line in body[vertices : vertices + faces]]
    return triangulated(positions, rows)


def triangulated(positions: Floats, faces: Faces) -> tuple[Floats, Indices]:
    """Returns the positions, and triangles of the faces."""
    triangles = [triangle for face in faces if len(face) > 2 for triangle in ears(positions, face)]
    return positions, np.array(triangles, np.int64).reshape(-1, 3)


def ears(positions: Floats, face: tuple[int, ...]) -> Faces:
    """Triangulates a flat polygon without holes by cutting off ears; a fan where there are none."""
    if len(face) == 3:
        return [face]
    corners = positions[list(face)]
    normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
    left, triangles = list(range(len(face))), []
    while len(left) > 3:
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            pa, pb, pc = corners[[a, b, c]]
            turn = np.cross(pb - pa, pc - pb) @ normal
            others = [p for p in left if p not in (a, b, c)]
            if turn > 0 and not _any_inside(corners[others], pa, pb, pc, normal):
                triangles.append((face[a], face[b], face[c]))
                del left[k]
                break
        else:
            return [(face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1)]
    return [*triangles, (face[left[0]], face[left[1]], face[left[2]])]


def _any_inside(points: Floats, a: Floats, b: Floats, c: Floats, normal: Floats) -> bool:
    signs = [np.cross(q - p, points - p) @ normal for p, q in ((a, b), (b, c), (c, a))]
    return bool(np.all([sign >= 0 for sign in signs], axis=0).any()) if len(points) else False
