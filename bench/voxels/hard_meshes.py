# SPDX-License-Identifier: GPL-3.0-or-later

"""Meshes that are no solids: open, unoriented, in pieces, without thickness.

Needs numpy alone. `hard_meshes()` has the generated ones; `read_meshes(folder)` those among the
models that are gathered beside the checkout.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench import solids
from bench.voxels import meshes

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class HardMesh:
    """A mesh, about 2 units large if generated, and the volume of the solid that it represents.

    Attributes:
        positions: (vertices, 3).
        triangles: (triangles, 3).
        volume: The volume of the evident solid; None for sheets and doubtful meshes.
    """

    positions: Array
    triangles: Indices
    volume: float | None = None


def closed(solid: solids.Solid) -> HardMesh:
    """A solid, whose volume is known."""
    return HardMesh(solid.positions, solid.triangles, solid.volume)


def sphere(rounds: int = 5, radius: float = 1.0, center: tuple[float, ...] = (0, 0, 0)) -> HardMesh:
    """A sphere, by splitting an octahedron."""
    return closed(solids.sphere(radius, rounds, center))


def box(low: tuple[float, ...] = (-1, -1, -1), high: tuple[float, ...] = (1, 1, 1)) -> HardMesh:
    """Two triangles a side: those at low x, high x, low y, ... in order."""
    return closed(solids.box(low, high))


def torus(major: float = 0.7, minor: float = 0.3, around: int = 96, across: int = 48) -> HardMesh:
    """Closed along both ways."""
    return closed(solids.torus(major, minor, around, across))


def grid(place: Callable[[Array, Array], Array], columns: int, rows: int) -> HardMesh:
    """The image of the unit square: `place(u, v)` gives points (..., 3)."""
    made = solids.grid(place, columns, rows)
    return HardMesh(made.positions, made.triangles)


def welded(mesh: HardMesh, digits: int = 9) -> HardMesh:
    """Merges vertices that are equal up to rounding."""
    _, first, names = np.unique(
        np.round(mesh.positions, digits) + 0.0, axis=0, return_index=True, return_inverse=True
    )
    triangles = names.reshape(-1)[mesh.triangles]
    a, b, c = triangles.T
    kept = (a != b) & (b != c) & (c != a)
    return HardMesh(mesh.positions[first], triangles[kept], mesh.volume)


def joined(*parts: HardMesh, volume: float | None = None) -> HardMesh:
    """Several meshes as one."""
    starts = np.cumsum([0] + [len(part.positions) for part in parts[:-1]])
    return HardMesh(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.triangles + k for part, k in zip(parts, starts, strict=True)]),
        volume,
    )


def flipped(mesh: HardMesh) -> HardMesh:
    """Inside out."""
    return HardMesh(mesh.positions, mesh.triangles[:, ::-1].copy(), mesh.volume)


def shuffled(mesh: HardMesh, seed: int = 0) -> HardMesh:
    """Half of the faces inside out, at random."""
    return HardMesh(mesh.positions, solids.shuffled(mesh.triangles, seed), mesh.volume)


def soup(mesh: HardMesh, jitter: float = 0.0, shrunk: float = 0.0) -> HardMesh:
    """Triangles that share no vertices: these are moved at random, and toward the middles."""
    made = solids.soup(solids.Solid(mesh.positions, mesh.triangles), jitter=jitter, shrunk=shrunk)
    return HardMesh(made.positions, made.triangles, mesh.volume)


def without(mesh: HardMesh, removed: Indices | NDArray[np.bool_]) -> HardMesh:
    """The mesh without some triangles."""
    triangles = np.delete(mesh.triangles, removed, axis=0)
    return HardMesh(mesh.positions, triangles, mesh.volume)


def turned(mesh: HardMesh, seed: int = 3) -> HardMesh:
    """Rotated at random, so that nothing lies along the cells."""
    return HardMesh(mesh.positions @ solids.random_rotation(seed).T, mesh.triangles, mesh.volume)


def six_patches(gap: float, rows: int = 24, uneven: bool = False) -> HardMesh:
    """A sphere of the six sides of a cube, blown up; each is moved outwards by the gap.

    Args:
        gap: By how much.
        rows: Quads along a side.
        uneven: Whether each patch has another number of them, so that borders have no vertices
            in common.
    """
    parts = []
    for side in range(6):
        axis, sign = side // 2, 1 - 2 * (side % 2)

        def place(u: Array, v: Array, axis: int = axis, sign: int = sign) -> Array:
            # Equal angles, so that patches meet in the same points.
            point = np.empty((*u.shape, 3))
            point[..., axis] = sign
            point[..., (axis + 1) % 3] = np.tan((u - 0.5) * np.pi / 2)
            point[..., (axis + 2) % 3] = sign * np.tan((v - 0.5) * np.pi / 2)
            point /= np.linalg.norm(point, axis=-1, keepdims=True)
            point[..., axis] += sign * gap
            return point

        count = rows + 3 * side if uneven else rows
        parts.append(grid(place, count, count))
    return joined(*parts, volume=4 / 3 * np.pi)


def terrain(rows: int = 128, seed: int = 5) -> HardMesh:
    """Hills and valleys."""
    random = np.random.default_rng(seed)
    waves = random.normal(size=(12, 2)) * 3
    phases = random.uniform(0, 2 * np.pi, 12)

    def place(u: Array, v: Array) -> Array:
        heights = sum(
            np.sin(a * u * 2 + b * v * 2 + p) / (2 + a * a + b * b)
            for (a, b), p in zip(waves, phases, strict=True)
        )
        return np.stack([2 * u - 1, 2 * v - 1, 0.4 * heights], axis=-1)

    return grid(place, rows, rows)


def cloth(rows: int = 96) -> HardMesh:
    """A square that hangs in folds, and overlaps itself."""

    def place(u: Array, v: Array) -> Array:
        sway = 0.25 * np.sin(7 * u + 2 * v) + 0.12 * np.sin(19 * u) * v
        return np.stack([1.6 * u - 0.8 + 0.3 * sway * v, sway, 1 - 2 * v], axis=-1)

    return grid(place, rows, rows)


def moebius(columns: int = 160, rows: int = 12) -> HardMesh:
    """A strip with a single side."""

    def place(u: Array, v: Array) -> Array:
        angle, across = 2 * np.pi * u, 0.6 * (v - 0.5)
        ring = 0.7 + across * np.cos(angle / 2)
        heights = across * np.sin(angle / 2)
        return np.stack([ring * np.cos(angle), ring * np.sin(angle), heights], axis=-1)

    return welded(grid(place, columns, rows))


def klein_bottle(columns: int = 160, rows: int = 64) -> HardMesh:
    """Closed, passes through itself, and has a single side: the figure 8 turned half around."""

    def place(u: Array, v: Array) -> Array:
        angle, across = 2 * np.pi * u, 2 * np.pi * v
        x = 0.4 * np.sin(across)
        y = 0.4 * np.sin(2 * across)
        ring = 0.6 + np.cos(angle / 2) * x - np.sin(angle / 2) * y
        heights = np.sin(angle / 2) * x + np.cos(angle / 2) * y
        return np.stack([ring * np.cos(angle), ring * np.sin(angle), heights], axis=-1)

    return welded(grid(place, columns, rows))


def pipe(radius: float, low: float, high: float, around: int = 64) -> HardMesh:
    """A cylinder along z, open at both ends."""

    def place(u: Array, v: Array) -> Array:
        angle = 2 * np.pi * u
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        return np.stack([x, y, low + (high - low) * v], axis=-1)

    return welded(grid(place, around, 24))


def finned_box() -> HardMesh:
    """A box, and fins along its edges, where three and four faces meet."""
    body = box((-0.6, -0.6, -0.6), (0.6, 0.6, 0.6))
    points = np.concatenate(
        [body.positions, [(0.6, 1.0, -0.6), (0.6, 1.0, 0.6), (1.0, 0.6, -0.6), (1.0, 0.6, 0.6)]]
    )
    # Vertices 3 and 7 are the ends of the edge at high x and y.
    fins = np.array([(3, 7, 9), (3, 9, 8), (3, 10, 11), (3, 11, 7)])
    return HardMesh(points, np.concatenate([body.triangles, fins]), body.volume)


def divided_box() -> HardMesh:
    """Two rooms with one wall between them, faces at random ways around."""
    left = box((-1, -0.5, -0.5), (0, 0.5, 0.5))
    right = box((0, -0.5, -0.5), (1, 0.5, 0.5))
    kept = np.setdiff1d(np.arange(12), [0, 1])  # Without its wall at low x.
    both = joined(left, HardMesh(right.positions, right.triangles[kept]), volume=2.0)
    return shuffled(welded(both))


def mirrored_halves() -> HardMesh:
    """Half a torus and its mirror image: mirrored faces are inside out."""
    whole = torus()
    middles = whole.positions[whole.triangles].mean(axis=1)
    half = HardMesh(whole.positions, whole.triangles[middles[:, 0] > 0])
    mirrored = HardMesh(half.positions * (-1, 1, 1), half.triangles)
    return joined(half, mirrored, volume=whole.volume)


def bumpy_sphere_turned_in_part() -> HardMesh:
    """A third of the faces, in one piece, is inside out."""
    made = sphere()
    triangles = made.triangles.copy()
    inside = made.positions[triangles].mean(axis=1)[:, 2] > 0.3
    triangles[inside] = triangles[inside][:, ::-1]
    return HardMesh(made.positions, triangles, made.volume)


def plates(thickness: float, count: int = 3) -> HardMesh:
    """Closed boxes far thinner than a cell, in all directions."""
    parts = []
    for i in range(count):
        plate = box((-0.8, -0.8, -thickness / 2), (0.8, 0.8, thickness / 2))
        parts.append(turned(plate, seed=10 + i))
    return joined(*parts)


def tiles(count: int = 400, gap: float = 0.12) -> HardMesh:
    """A sphere of pieces with gaps between them that are below two cells of 64 along an axis."""
    made = six_patches(0.0, 8)
    middles = made.positions[made.triangles].mean(axis=1, keepdims=True)
    corners = made.positions[made.triangles]
    shrunk = corners + gap * (middles - corners)
    names = np.arange(3 * len(corners)).reshape(-1, 3)
    return HardMesh(shrunk.reshape(-1, 3), names[: max(count, len(names))], 4 / 3 * np.pi)


def leaves(count: int = 300, seed: int = 4) -> HardMesh:
    """Small quads here and there, as leaves of trees and blades of grass are made."""
    random = np.random.default_rng(seed)
    parts = []
    for i in range(count):
        leaf = turned(grid(lambda u, v: np.stack([u, v, 0.1 * u * (1 - u)], axis=-1), 2, 2), i)
        scale = random.uniform(0.08, 0.2)
        parts.append(HardMesh(leaf.positions * scale + random.uniform(-1, 1, 3), leaf.triangles))
    return joined(*parts)


def hemisphere() -> HardMesh:
    """A bowl without thickness."""
    made = sphere()
    below = made.positions[made.triangles].mean(axis=1)[:, 2] < 0
    return HardMesh(made.positions, made.triangles[below])


def house() -> HardMesh:
    """Walls and a roof as single polygons that overlap, as architects' models come."""
    walls = without(box((-0.7, -0.5, -0.6), (0.7, 0.5, 0.2)), np.array([8, 9, 10, 11]))
    slope = np.array([(-0.9, -0.7, 0.1), (0.9, -0.7, 0.1), (0.9, 0, 0.7), (-0.9, 0, 0.7)])
    roof = HardMesh(slope, np.array([(0, 1, 2), (0, 2, 3)]))
    other = HardMesh(slope * (1, -1, 1), np.array([(0, 1, 2), (0, 2, 3)]))
    return joined(walls, roof, other)


def hard_meshes() -> dict[str, HardMesh]:
    """Returns the generated meshes, by name."""
    whole, inner, ring, cube = sphere(), sphere(4, 0.5), torus(), box()
    twice = np.concatenate([whole.triangles, whole.triangles])
    both_ways = np.concatenate([whole.triangles, whole.triangles[:, ::-1]])
    offset = HardMesh(whole.positions * 0.5 + (0.8, 0, 0), whole.triangles)
    plane = grid(lambda u, v: np.stack([2 * u - 1, 2 * v - 1, 0 * u], axis=-1), 8, 8)
    return {
        "soup": soup(whole),
        "soup, 1e-4": soup(whole, 1e-4),
        "soup, unoriented": shuffled(soup(ring, 1e-5)),
        "soup, shrunk by a tenth": shuffled(soup(sphere(4), 0.0, 0.1)),
        "six patches, 1e-9": six_patches(1e-9),
        "six patches, 1e-6": six_patches(1e-6),
        "six patches, uneven": six_patches(0.0, 24, True),
        "six patches, unoriented": joined(
            *(shuffled(part, i) for i, part in enumerate([six_patches(1e-3)])),
            volume=4 / 3 * np.pi,
        ),
        "tiles": tiles(),
        "doubled": HardMesh(whole.positions, twice, whole.volume),
        "doubled both ways": HardMesh(whole.positions, both_ways, whole.volume),
        "inside out": flipped(ring),
        "inside out in part": bumpy_sphere_turned_in_part(),
        "one of two inside out": joined(
            sphere(4, 0.5, (-0.6, 0, 0)),
            flipped(sphere(4, 0.5, (0.6, 0, 0))),
            volume=2 * sphere(4, 0.5).volume,
        ),
        "nested, unoriented": shuffled(
            joined(whole, inner, volume=(whole.volume or 0) - (inner.volume or 0))
        ),
        "crossing, unoriented": shuffled(joined(whole, offset)),
        "mirrored halves": mirrored_halves(),
        "divided box": turned(divided_box()),
        "finned box": turned(finned_box()),
        "box without bottom": turned(without(cube, np.array([8, 9]))),
        "pipe": turned(pipe(0.5, -1, 1)),
        "plane": turned(plane),
        "plane along cells": plane,
        "terrain": terrain(),
        "cloth": cloth(),
        "hemisphere": turned(hemisphere()),
        "moebius strip": turned(moebius()),
        "klein bottle": turned(klein_bottle()),
        "thin plates": plates(0.002),
        "leaves": leaves(),
        "house": turned(house()),
    }


def read_meshes(folder: Path = meshes.DATA) -> Iterator[tuple[str, HardMesh]]:
    """Yields the models in a folder that are open, broken, or pass through themselves."""
    for name in (
        "broken_many_small_holes.ply",
        "broken_non_manif_hole.ply",
        "csg_self_intersectA.obj",
        "csg_self_intersectB.obj",
        "suzanne.obj",
        "dragon_vrip_res3.ply",
        "stanford-bunny.obj",
    ):
        path = folder / name
        if path.exists():
            found = meshes.read(path)
            yield name, HardMesh(found.positions, found.triangles)
    suzanne = folder / "suzanne.obj"
    if suzanne.exists():
        found = meshes.read(suzanne)
        random = np.random.default_rng(1)
        kept = random.random(len(found.triangles)) > 0.1
        torn = HardMesh(found.positions, found.triangles[kept])
        yield "suzanne, torn and unoriented", shuffled(torn)
