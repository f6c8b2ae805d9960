# SPDX-License-Identifier: GPL-3.0-or-later

"""Closed solids as modelers make them, with exact volumes, at all alignments and scales."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.field.polygons import Faces, ears

Floats = NDArray[np.float64]
_LETTERS = {
    "L": ((0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)),
    "T": ((1, 0), (2, 0), (2, 2), (3, 2), (3, 3), (0, 3), (0, 2), (1, 2)),
    "U": ((0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)),
    "E": (
        *((0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (2, 2), (2, 3), (1, 3), (1, 4), (3, 4), (3, 5)),
        (0, 5),
    ),
    "H": (
        *((0, 0), (1, 0), (1, 2), (2, 2), (2, 0), (3, 0), (3, 5), (2, 5), (2, 3), (1, 3), (1, 5)),
        (0, 5),
    ),
}


@dataclass
class Solid:
    """A closed polygon mesh.

    Attributes:
        positions: (vertices, 3).
        faces: Corners of each polygon, counterclockwise from outside.
        genus: Of its one part.
    """

    positions: Floats
    faces: Faces
    genus: int = 0


def prism(outline: Sequence[tuple[float, float]], height: float) -> Solid:
    """Extrudes a polygon, convex or not, whose caps stay one face each."""
    n = len(outline)
    flat = np.asarray(outline, float)
    positions = np.concatenate([np.c_[flat, np.zeros(n)], np.c_[flat, np.full(n, height)]])
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return Solid(positions, [tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n)), *sides])


def grid_of_revolution(rings: Sequence[tuple[float, float]], segments: int) -> Solid:
    """Turns a profile of (radius, z) about z; both ends are closed by one face."""
    angles = 2 * np.pi * np.arange(segments) / segments
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    positions = np.concatenate([np.c_[r * circle, np.full(segments, z)] for r, z in rings])
    faces: Faces = [tuple(range(segments - 1, -1, -1))]
    for k in range(len(rings) - 1):
        for i in range(segments):
            j = (i + 1) % segments
            low, high = k * segments, (k + 1) * segments
            faces.append((low + i, low + j, high + j, high + i))
    faces.append(tuple((len(rings) - 1) * segments + i for i in range(segments)))
    return Solid(positions, faces)


def ring(profile: Sequence[tuple[float, float]], segments: int) -> Solid:
    """Turns a closed profile of (radius, z) about z: a tube, a torus, a washer."""
    angles = 2 * np.pi * np.arange(segments) / segments
    n = len(profile)
    positions = np.array(
        [(r * np.cos(a), r * np.sin(a), z) for a in angles for r, z in profile], float
    )
    faces: Faces = []
    for i in range(segments):
        a, b = i * n, ((i + 1) % segments) * n
        for k in range(n):
            m = (k + 1) % n
            faces.append((a + k, b + k, b + m, a + m))
    return Solid(positions, faces, 1)


def spring(random: np.random.Generator) -> Solid:
    """Sweeps a circle along a helix."""
    turns, around = random.uniform(1.5, 4), int(random.integers(8, 24))
    along = int(turns * 24)
    radius, wire = 1.0, random.uniform(0.1, 0.2)
    t = 2 * np.pi * turns * np.arange(along) / (along - 1)
    pitch = random.uniform(3.0, 5.0) * wire / (2 * np.pi)
    center = np.stack([radius * np.cos(t), radius * np.sin(t), pitch * t], axis=1)
    tangent = np.stack([-radius * np.sin(t), radius * np.cos(t), np.full(along, pitch)], axis=1)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    inward = np.stack([-np.cos(t), -np.sin(t), np.zeros(along)], axis=1)
    up = np.cross(tangent, inward)
    angle = 2 * np.pi * np.arange(around) / around
    offset = np.cos(angle)[:, None, None] * inward + np.sin(angle)[:, None, None] * up
    positions = (center + wire * offset).transpose(1, 0, 2).reshape(-1, 3)
    faces: Faces = [tuple(range(around - 1, -1, -1))]
    for k in range(along - 1):
        for i in range(around):
            j = (i + 1) % around
            low, high = k * around, (k + 1) * around
            faces.append((low + i, low + j, high + j, high + i))
    faces.append(tuple((along - 1) * around + i for i in range(around)))
    return Solid(positions, faces)


def _box(random: np.random.Generator) -> Solid:
    sides = random.choice([1, 2, 3, 4, 0.5, 0.25, random.uniform(0.2, 4)], 3)
    return prism([(0, 0), (sides[0], 0), (sides[0], sides[1]), (0, sides[1])], sides[2])


def _letter(random: np.random.Generator) -> Solid:
    return prism(_LETTERS[str(random.choice(sorted(_LETTERS)))], random.choice([0.5, 1, 2]))


def _bracket(random: np.random.Generator) -> Solid:
    wall = random.uniform(0.15, 0.4)
    fillet = [
        (wall + 0.3 - 0.3 * np.sin(a), wall + 0.3 - 0.3 * np.cos(a))
        for a in np.linspace(0, np.pi / 2, 7)
    ]
    return prism([(0, 0), (2, 0), (2, wall), *fillet, (wall, 2), (0, 2)], random.uniform(0.5, 2))


def _tube(random: np.random.Generator) -> Solid:
    inner, height = random.uniform(0.3, 0.8), random.uniform(0.3, 4)
    return ring([(inner, 0), (1, 0), (1, height), (inner, height)], int(random.integers(12, 64)))


def _torus(random: np.random.Generator) -> Solid:
    small, n = random.uniform(0.15, 0.5), int(random.integers(8, 32))
    angles = 2 * np.pi * np.arange(n) / n
    profile = [(1 + small * np.cos(a), small * np.sin(a)) for a in angles]
    return ring(profile, int(random.integers(16, 64)))


def _leg(random: np.random.Generator) -> Solid:
    height = random.uniform(3, 8)
    z = np.linspace(0, height, int(random.integers(2, 12)))
    radius = 0.2 + random.uniform(0.05, 0.25) * np.abs(np.sin(z * random.uniform(0.5, 2) + 1))
    return grid_of_revolution(list(zip(radius, z, strict=True)), int(random.integers(8, 48)))


def _fillet_box(random: np.random.Generator) -> Solid:
    radius, n = random.uniform(0.1, 0.4), int(random.integers(2, 8))
    outline = []
    for k, (x, y) in enumerate([(2, 1), (0, 1), (0, 0), (2, 0)]):
        x_mid, y_mid = x + (radius if x == 0 else -radius), y + (radius if y == 0 else -radius)
        for a in np.linspace(k * np.pi / 2, (k + 1) * np.pi / 2, n + 1):
            outline.append((x_mid + radius * np.cos(a), y_mid + radius * np.sin(a)))
    return prism(outline, random.uniform(0.3, 2))


_MAKERS: tuple[Callable[[np.random.Generator], Solid], ...] = (
    *(_box, _letter, _bracket, _tube, _torus, _leg, _fillet_box, spring),
)


def triangulated_volume(positions: Floats, faces: Faces) -> float:
    """Returns the volume of a closed mesh: cones from the middle over fans, whose signs add up."""
    local = positions - positions.mean(axis=0)
    fans = np.array([(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)])
    a, b, c = np.moveaxis(local[fans], 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def write(stem: Path, random: np.random.Generator) -> Mapping[str, Any]:
    """Writes a solid as OBJ, PLY or STL, placed and damaged as files of users are."""
    solid = _MAKERS[int(random.integers(len(_MAKERS)))](random)
    positions = _placed(solid.positions, random)
    volume = abs(triangulated_volume(positions, solid.faces))
    faces, damage = _damaged(solid.faces, random)
    if damage == "mirrored":
        positions = positions * (-1, 1, 1)
    extension = str(random.choice([".obj", ".obj", ".ply", ".stl"]))
    if extension == ".stl":
        _write_stl(stem.with_suffix(".stl"), positions, faces)
    elif extension == ".ply":
        _write_ply(stem.with_suffix(".ply"), positions, faces)
    else:
        _write_obj(stem.with_suffix(".obj"), positions, faces, is_doubled=damage == "doubled")
    is_far = np.abs(positions).max() > 1e4 * np.ptp(positions, axis=0).max()
    return {
        "must_work": True,
        "made": f"{len(solid.faces)} faces, {damage}",
        "closed": damage not in ("open",) and not (is_far and extension != ".obj"),
        **{"parts": 1, "genus": solid.genus, "volume": volume},
    }


def _placed(positions: Floats, random: np.random.Generator) -> Floats:
    """Rotates or aligns, scales unevenly or to mm, m or km, and moves, sometimes far."""
    if random.random() < 0.4:
        q, r = np.linalg.qr(random.normal(size=(3, 3)))
        q *= np.sign(np.diag(r))
        positions = positions @ (q * np.sign(np.linalg.det(q))).T
    if random.random() < 0.2:
        positions = positions * random.choice([1, 2, 0.5], 3)
    positions = positions * random.choice([1, 1, 0.001, 25.4, 1000])
    size = np.ptp(positions, axis=0).max()
    offset = random.choice([0, 0, 0.5, 1, 1000]) * size
    return positions + offset * random.choice([-1, 0, 1], 3)


def _damaged(faces: Faces, random: np.random.Generator) -> tuple[Faces, str]:
    """Returns faces as careless exports leave them, and the name of the damage."""
    damage = str(
        random.choice(["none", "none", "inverted", "mirrored", "mixed", "doubled", "twice"])
    )
    if damage == "inverted":
        faces = [face[::-1] for face in faces]
    elif damage == "mixed":
        faces = [face[::-1] if random.random() < 0.3 else face for face in faces]
    elif damage == "twice":
        faces = [*faces, *faces[: len(faces) // 3]]
    return faces, damage


def _write_obj(path: Path, positions: Floats, faces: Faces, *, is_doubled: bool) -> None:
    if is_doubled:
        corners = [corner for face in faces for corner in face]
        starts = np.cumsum([0, *(len(face) for face in faces)])
        positions = positions[corners]
        faces = [tuple(range(a, b)) for a, b in itertools.pairwise(starts)]
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in positions]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _write_ply(path: Path, positions: Floats, faces: Faces) -> None:
    head = (
        f"ply\nformat ascii 1.0\nelement vertex {len(positions)}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    lines = [f"{x:.17g} {y:.17g} {z:.17g}" for x, y, z in positions]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    path.write_text(head + "\n".join(lines) + "\n", encoding="utf-8")


def _write_stl(path: Path, positions: Floats, faces: Faces) -> None:
    """Writes triangles cut off as ears, since STL has no polygons."""
    triangles = np.array([t for face in faces for t in ears(positions, face)])
    corners = positions[triangles]
    records = np.zeros(
        len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    )
    records["corners"] = corners
    with path.open("wb") as file:
        file.write(b"made by bench.field".ljust(80))
        file.write(np.uint32(len(corners)).tobytes())
        file.write(records.tobytes())
