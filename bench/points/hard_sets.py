# SPDX-License-Identifier: GPL-3.0-or-later

"""Clouds as scanners write them, and shapes that are hard at their depth; truth where known.

Each set is a cloud of oriented points and, except for scans, the surface that they were taken from.
Cells are of depth 9, whatever depth a set is reconstructed at. Every run makes the same sets.
"""

import argparse
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import prefilter

from bench.points import fetched, ply, sets
from bench.points.scans import grid_normals
from bench.points.sets import Cloud, Floats, Model
from bench.voxels.meshes import Triangles

CYCLOIDAL = "PREFILTER_CYCLOIDAL"  # The path of trimesh's cycloidal.ply.
NOISE = 0.25  # Cells, along the view.
VIEWS = 14
VIEW_SIZE = 256  # Pixels.
STEEPEST = 78.0  # Largest angle in degrees between the view and a visible normal.
THINNEST = (0.75, 1.0, 1.5, 2.0, 3.0)  # Cells.
DENSITIES = 1000.0


@dataclass(frozen=True)
class HardSet:
    """Points, and the surface that they were taken from."""

    cloud: Cloud
    truth: Triangles | None


def joined(meshes: Sequence[Triangles]) -> Triangles:
    """Returns several meshes as one."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return Triangles(
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate([m.triangles + start for m, start in zip(meshes, starts, strict=False)]),
    )


def box(low: Sequence[float], high: Sequence[float]) -> Triangles:
    """Returns a box."""
    corners = np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)])
    positions = np.array(low) + corners * (np.array(high) - low)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return Triangles(
        positions, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    )


def ball(segments: int, radius: float = 1.0) -> Triangles:
    """Returns a ball of so many segments from pole to pole."""
    rows, columns = np.mgrid[0 : segments + 1, 0 : 2 * segments]
    polar, around = np.pi * rows / segments, np.pi * columns / segments
    grid = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)])
    number = rows * 2 * segments + columns
    a, b = number[:-1], number[1:]
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    faces = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    positions = radius * np.moveaxis(grid, 0, -1).reshape(-1, 3)
    points = positions[faces]
    areas = np.linalg.norm(
        np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]), axis=1
    )
    return Triangles(positions, faces[areas > 1e-12])


def turned(mesh: Triangles) -> Triangles:
    """Returns a mesh rotated away from the axes of the cells."""
    x, y = np.radians((23.0, 31.0))
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    return Triangles(mesh.positions @ (about_x @ about_y).T, mesh.triangles)


def cell_of(mesh: Triangles) -> float:
    """The side of a finest cell around a mesh."""
    return sets.cell_of(mesh.positions, sets.DEPTH)


def drawn(mesh: Triangles, count: int | float, seed: int = 1) -> HardSet:
    """Draws points: so many, or so many a finest face where `count` is a float."""
    model = Model.of(mesh)
    if isinstance(count, float):
        count = round(count * model.sums[-1] / cell_of(mesh) ** 2)
    return HardSet(model.draw(count, np.random.default_rng(seed)), mesh)


def slab(_: Path) -> HardSet:
    """Exact points of a slab, half as many as cells."""
    return drawn(turned(box((0, 0, 0), (1, 1, 0.1))), 0.5)


def ball_of_500(_: Path) -> HardSet:
    """A few exact points, for a depth that they do not carry."""
    return drawn(ball(200), 500)


def plates(_: Path) -> HardSet:
    """Plates and rods of 0.75 to 3 cells, a ball and a slab."""
    frame = turned(box((0, 0, 0), (1, 1, 0.7)))
    cell = cell_of(frame)
    parts = [box((0, 0, 0), (1, 1, 0.06))]
    moved = ball(200, 0.2)
    parts.append(Triangles(moved.positions + np.array((0.5, 0.25, 0.32)), moved.triangles))
    for k, cells in enumerate(THINNEST):
        x, thick = 0.05 + 0.2 * k, cells * cell
        parts.append(box((x, 0.8, 0.1), (x + 0.1, 0.8 + thick, 0.7)))
        parts.append(box((x, 0.65, 0.1), (x + thick, 0.65 + thick, 0.7)))
    return drawn(turned(joined(parts)), 2.0)


def connector(_: Path) -> HardSet:
    """A plug of 25 pins, 2 to 3 cells wide; none of its points is inside another part."""
    body = box((0, 0, 0), (1, 0.5, 0.3))
    cell = cell_of(turned(box((0, 0, 0), (1, 0.5, 0.6))))
    pins = []
    for k in range(25):
        x, y = 0.1 + 0.2 * (k % 5), 0.05 + 0.1 * (k // 5)
        half = (2 + k / 24) * cell / 2
        pins.append(box((x - half, y - half, 0.3), (x + half, y + half, 0.6)))
    mesh = joined([body, *pins])
    found = drawn(mesh, 2.0)
    points, normals = found.cloud
    level = np.abs(points[:, 2] - 0.3) < 1e-9
    under = np.zeros(len(points), bool)
    for pin in pins:
        low, high = pin.positions[:, :2].min(axis=0), pin.positions[:, :2].max(axis=0)
        under |= level & ((points[:, :2] >= low) & (points[:, :2] <= high)).all(axis=1)
    turn = turned(Triangles(np.eye(3), mesh.triangles)).positions
    cloud = points[~under] @ turn, (normals[~under] @ turn).astype(np.float32)
    return HardSet(cloud, turned(mesh))


def bust(shared: Path) -> HardSet:
    """A head without its base: the opening is not seen by the scanner."""
    mesh = ply.read_mesh(shared / "meshes/igea_tri.ply")
    heights = mesh.positions[:, 1]
    level = heights.min() + 0.25 * np.ptp(heights)
    kept = (heights[mesh.triangles] > level).all(axis=1)
    used, corners = np.unique(mesh.triangles[kept], return_inverse=True)
    return drawn(Triangles(mesh.positions[used], corners.reshape(-1, 3)), 300_000)


def density(shared: Path) -> HardSet:
    """A head whose crown has a thousandth of the points of its neck, by area."""
    mesh = ply.read_mesh(shared / "meshes/igea_tri.ply")
    model, random = Model.of(mesh), np.random.default_rng(1)
    points, normals = model.draw(2_000_000, random)
    height = (points[:, 1] - points[:, 1].min()) / np.ptp(points[:, 1])
    kept = random.random(len(points)) < DENSITIES**-height
    return HardSet((points[kept], normals[kept]), mesh)


def overlapping(shared: Path) -> HardSet:
    """Two solids that are stuck into each other, sampled all over: inside, too."""
    first = ply.read_mesh(shared / "meshes/igea_tri.ply")
    second = ply.read_mesh(shared / "meshes/rocker-arm.obj")
    size = np.ptp(first.positions, axis=0).max() / np.ptp(second.positions, axis=0).max()
    moved = (second.positions - second.positions.mean(axis=0)) * size
    moved = moved + first.positions.mean(axis=0) + 0.2 * np.ptp(first.positions, axis=0)
    return drawn(joined([first, Triangles(moved, second.triangles)]), 400_000)


def cycloidal(_: Path) -> HardSet:
    """A gear of a hundred parts that overlap."""
    return drawn(ply.read_mesh(Path(os.environ[CYCLOIDAL])), 400_000)


def simulated(shared: Path, *, noise: float, apart: float) -> HardSet:
    """Range scans of a statue: noise along the view, and scans moved off their places [cells]."""
    mesh = ply.read_mesh(shared / "meshes/armadillo.obj")
    cell, random = cell_of(mesh), np.random.default_rng(5)
    samples, _ = Model.of(mesh).draw(sets.MILLION, random)
    parts = []
    for k in range(VIEWS):
        # Directions along a spiral from pole to pole.
        height, around = 1 - (2 * k + 1) / VIEWS, k * np.pi * (3 - 5**0.5)
        side = (1 - height**2) ** 0.5
        view = np.array([side * np.cos(around), side * np.sin(around), height])
        points, normals = range_scan(samples, view, noise * cell, random)
        shift = random.normal(size=3)
        parts.append((points + apart * cell * shift / np.linalg.norm(shift), normals))
    points, normals = (np.concatenate(part) for part in zip(*parts, strict=True))
    return HardSet((points, normals.astype(np.float32)), mesh)


def range_scan(
    samples: Floats, view: Floats, noise: float, random: np.random.Generator
) -> tuple[Floats, Floats]:
    """Returns samples seen by a far scanner in direction `view`, with normals of its grid."""
    across = np.cross(view, (0, 1, 0) if abs(view[1]) < 0.9 else (1, 0, 0))
    across /= np.linalg.norm(across)
    frame = np.stack([across, np.cross(view, across), view])
    placed = samples @ frame.T
    low, high = placed[:, :2].min(axis=0), placed[:, :2].max(axis=0)
    pixel = ((placed[:, :2] - low) / (high - low).max() * (VIEW_SIZE - 1)).astype(int)
    number = pixel[:, 1] * VIEW_SIZE + pixel[:, 0]
    order = np.lexsort((-placed[:, 2], number))
    first = np.flatnonzero(np.diff(number[order], prepend=-1))
    seen = placed[order[first]]
    seen[:, 2] += noise * random.normal(size=len(seen))
    grid = np.full(VIEW_SIZE**2, -1)
    grid[number[order[first]]] = np.arange(len(seen))
    normals = grid_normals(seen, grid.reshape(VIEW_SIZE, VIEW_SIZE))
    kept = normals[:, 2] > np.cos(np.radians(STEEPEST))
    return seen[kept] @ frame, normals[kept] @ frame


def noisy_ranges(shared: Path) -> HardSet:
    """Range scans with a quarter cell of noise."""
    return simulated(shared, noise=NOISE, apart=0)


def misregistered(shared: Path) -> HardSet:
    """Range scans, each moved by a cell."""
    return simulated(shared, noise=NOISE, apart=1)


def clean(model: str) -> Callable[[Path], HardSet]:
    """A million points of a closed surface."""
    return lambda shared: drawn(ply.read_mesh(shared / "meshes" / sets.MODELS[model]), sets.MILLION)


CLEAN = {f"{model}_1m": clean(model) for model in ("igea", "armadillo", "rocker-arm")}
MADE: dict[str, Callable[[Path], HardSet]] = {
    "slab": slab,
    "plates": plates,
    "ball500": ball_of_500,
    "bust": bust,
    "density": density,
    "overlapping": overlapping,
    "cycloidal": cycloidal,
    "connector": connector,
    "ranges": noisy_ranges,
    "misregistered": misregistered,
    **CLEAN,
}
DEPTHS = {"ball500": 12}  # Sets with a depth of their own.
OPEN = tuple(name for name, found in fetched.FETCHED.items() if found.is_open)


def names() -> list[str]:
    """Returns the names of the sets."""
    return [*MADE, *sets.SCANS, *fetched.FETCHED]


def prepare(folder: Path, name: str, depth: int, shared: Path) -> dict[str, Any]:
    """Makes a set unless it exists; returns its files and the settings of the comparison.

    Raises:
        ValueError: There is no set of that name.
    """
    if name not in names():
        raise ValueError(f"no set is called '{name}'; there are {', '.join(names())}")
    points, truth = folder / f"{name}.ply", folder / f"{name}.truth.ply"
    if not points.exists():
        if name in sets.SCANS:
            found = HardSet(sets.SCANS[name](shared, folder), None)
        elif name in fetched.FETCHED:
            found = HardSet(fetched.cloud(name), None)
        else:
            found = MADE[name](shared)
        if found.truth:
            ply.write_mesh(truth, found.truth.positions, found.truth.triangles)
        ply.write_points(points, len(found.cloud[0]), [found.cloud])
    depth = DEPTHS.get(name, depth) if depth else carried_depth(points)
    return {
        "points": str(points),
        "truth": str(truth) if truth.exists() else None,
        "depth": depth,
        "cell": sets.cell_of(ply.read_points(points)[0], depth),
        "is_open": name in OPEN,
        "is_clean": name in CLEAN,
    }


def carried_depth(points: Path) -> int:
    """Returns prefilter's default depth for the points."""
    report = prefilter.ReconstructionReport()
    cloud = (np.ascontiguousarray(part) for part in ply.read_points(points))
    prefilter.reconstruct(*cloud, report=report)
    return report.depth


def main() -> None:
    """Makes a set, or names all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("name", nargs="?")
    parser.add_argument("--depth", type=int, default=sets.DEPTH, help="0: automatic")
    parser.add_argument("--shared", type=Path, default=sets.SHARED, help="default: %(default)s")
    options = parser.parse_args()
    if options.name is None:
        print(json.dumps(names()))
        return
    options.folder.mkdir(parents=True, exist_ok=True)
    print(json.dumps(prepare(options.folder, options.name, options.depth, options.shared)))


if __name__ == "__main__":
    main()
