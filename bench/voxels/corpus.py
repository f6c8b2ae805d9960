# SPDX-License-Identifier: GPL-3.0-or-later

"""Contours and booleans of many meshes: every result has to be closed, two-manifold and without
self-intersections, and every boolean has to have its volume.

Usage: scripts/run python3 bench/voxels/corpus.py [--depth N] [--interpolants NAME[+clean][@CELLS]
    ...] [--meshes N] [--booleans N] [--only TEXT]

Meshes are those gathered beside the checkout and made ones. Volumes are compared with manifold3d's
(PyPI) where that takes both operands and neither passes through itself, and may differ by 0.1 of a
cell times the area. Faults are printed at once, with the triangles of an intersecting pair.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.voxels import booleans, edges, measures, meshes, sharp_shapes
from bench.voxels.sharp_shapes import Shape

TEXTURED = meshes.DATA.parent / "textured"
OPERATIONS = ("union", "intersection", "difference")
VOLUME_BAR = 0.1  # Cells times the area.


def fitted(name: str, positions: np.ndarray, triangles: np.ndarray) -> Shape:
    """Scaled and moved into a cube of side 2 around the origin; turned outward."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    placed = (positions - (low + high) / 2) * (2 / (high - low).max())
    return Shape(name, placed, triangles)


def gathered() -> list[Shape]:
    """The meshes beside the checkout; those with textures have a shape for each material."""
    found = []
    for path in sorted(meshes.DATA.glob("*")):
        if path.suffix in (".obj", ".ply", ".off"):
            read = meshes.read(path)
            found.append(fitted(path.stem, read.positions, read.triangles))
    for path in sorted(TEXTURED.glob("*/*.gltf")):
        for k, read in enumerate(meshes.read_gltf(path)):
            found.append(fitted(f"{path.stem} {k}", read.positions, read.triangles))
    for path in sorted(TEXTURED.glob("spot/spot_*.obj")):
        read = meshes.read(path)
        found.append(fitted(path.stem, read.positions, read.triangles))
    return found


def bumpy(seed: int, around: int = 48) -> Shape:
    """A ring whose width varies; for some numbers it passes through itself."""
    random = np.random.default_rng(seed)
    u, v = np.meshgrid(*2 * (2 * np.pi * np.arange(around) / around,), indexing="ij")
    minor = 0.3 + 0.2 * random.random() * np.cos(random.integers(2, 6) * u + v)
    ring = 0.6 + minor * np.cos(v)
    positions = np.stack([ring * np.cos(u), ring * np.sin(u), minor * np.sin(v)], axis=-1)
    i, j = np.indices((around, around))
    a, b = i * around + j, (i + 1) % around * around + j
    c, d = (i + 1) % around * around + (j + 1) % around, i * around + (j + 1) % around
    quads = np.stack([a, b, c, d], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Shape(
        f"ring {seed}", positions.reshape(-1, 3) @ sharp_shapes.rotation(seed).T, triangles
    )


def clutter(seed: int, count: int = 5) -> Shape:
    """Shapes that pass through each other, in one mesh."""
    random = np.random.default_rng(seed)
    names = list(sharp_shapes.MAKERS)[:3]
    positions, triangles, first = [], [], 0
    for _ in range(count):
        name = names[random.integers(len(names))]
        made = sharp_shapes.MAKERS[name]() if name == "cube" else sharp_shapes.ROUND[name](64)
        turn = sharp_shapes.rotation(int(random.integers(1 << 30)))
        placed = made.moved(random.uniform(0.2, 0.6) * turn, random.uniform(-0.5, 0.5, 3))
        positions.append(placed.positions)
        triangles.append(placed.triangles + first)
        first += len(placed.positions)
    return Shape(f"clutter {seed}", np.concatenate(positions), np.concatenate(triangles))


def made() -> list[Shape]:
    """Shapes along the axes and turned, rings and clutters."""
    found = []
    for name in sharp_shapes.MAKERS:
        if name == "fandisk" and not (meshes.DATA / "fandisk.obj").exists():
            continue
        straight = sharp_shapes.shape(name, turned=False)
        found += [sharp_shapes.shape(name), Shape(f"{name} straight", *vars_of(straight))]
    found += [bumpy(seed) for seed in range(8)]
    found += [clutter(seed) for seed in range(10)]
    return found


def vars_of(shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """Positions and triangles."""
    return shape.positions, shape.triangles


@dataclass(frozen=True)
class Boolean:
    """Two shapes and how they are combined."""

    name: str
    sources: tuple[Shape, Shape]
    operation: str


def random_booleans(count: int, solids: list[Shape]) -> list[Boolean]:
    """Booleans of overlapping shapes at random positions and rotations."""
    random = np.random.default_rng(15)
    found = []
    for k in range(count):
        chosen = [solids[i] for i in random.integers(len(solids), size=2)]
        placed = []
        for size, shape in zip((1.0, random.uniform(0.4, 1.0)), chosen, strict=True):
            turn = sharp_shapes.rotation(int(random.integers(1 << 30)))
            placed.append(shape.moved(size * turn, random.uniform(-0.4, 0.4, 3)))
        operation = OPERATIONS[k % 3]
        name = f"{k}: {chosen[0].name} {operation} {chosen[1].name}"
        found.append(Boolean(name, (placed[0], placed[1]), operation))
    return found


def volume(positions: np.ndarray, triangles: np.ndarray) -> float:
    """The enclosed volume of a closed surface."""
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def is_closed(shape: Shape) -> bool:
    """Whether every edge has two triangles, one in each direction."""
    found = measures.manifoldness(shape.triangles, len(shape.positions))
    return found.open_edges == 0 and found.crowded_edges == 0


@dataclass
class Tally:
    """Counts of the results of many meshes."""

    done: int = 0
    unsound: int = 0
    cut: int = 0
    flat: int = 0
    seconds: float = 0.0

    def add(self, name: str, found: measures.Soundness, seconds: float) -> None:
        """Counts one result, and prints its faults."""
        self.done += 1
        self.seconds += seconds
        self.unsound += not found.is_manifold
        self.cut += found.intersections > 0
        self.flat += found.flat_triangles > 0
        if not found.is_sound:
            print(
                f"  {name}: {found.open_edges} open edges, {found.crowded_edges} crowded edges, "
                f"{found.crowded_vertices} crowded vertices, {found.intersections} cuts "
                f"{found.example}",
                flush=True,
            )


def run_meshes(shapes: list[Shape], size: int, how: edges.Contour) -> Tally:
    """Contours of each by itself."""
    tally = Tally()
    for shape in shapes:
        subject = edges.Subject(shape.name, (shape,), "", shape, edges.NO_EDGES)
        positions, triangles, seconds = edges.contour(subject, size, how)
        tally.add(f"{shape.name}, {how.name}", measures.soundness(positions, triangles), seconds)
    return tally


def run_booleans(chosen: list[Boolean], size: int, how: edges.Contour) -> tuple[Tally, int, int]:
    """Contours of each; returns how many volumes were compared, and are wrong."""
    tally, compared, wrong = Tally(), 0, 0
    simple: dict[str, bool] = {}
    for one in chosen:
        subject = edges.Subject(
            one.name, one.sources, one.operation, one.sources[0], edges.NO_EDGES
        )
        _, cell = edges.box_around(one.sources, size)
        positions, triangles, seconds = edges.contour(subject, size, how)
        tally.add(f"{one.name}, {how.name}", measures.soundness(positions, triangles), seconds)
        if booleans.missing():
            continue
        for shape in one.sources:
            if shape.name not in simple:
                simple[shape.name] = measures.self_intersections(*vars_of(shape))[0] <= 0
        if not all(simple[shape.name] for shape in one.sources):
            continue
        try:
            truth, _ = booleans.combined(one.sources, one.operation)
        except ValueError:
            continue
        compared += 1
        _, areas = measures.facet_normals(truth.positions, truth.triangles)
        off = volume(positions, triangles) - volume(truth.positions, truth.triangles)
        allowed = VOLUME_BAR * cell * float(areas.sum())
        if abs(off) > allowed:
            wrong += 1
            print(f"  {one.name}, {how.name}: volume off by {off / allowed:.2f} of what may be")
    return tally, compared, wrong


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--depth", type=int, default=7)
    parser.add_argument("--interpolants", nargs="+", default=["plane", "sharp", "sharp+clean"])
    parser.add_argument("--meshes", type=int, default=60)
    parser.add_argument("--booleans", type=int, default=60)
    parser.add_argument("--only", default="", help="part of the names")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    shapes = [*made(), *gathered()]
    solids = [shape for shape in shapes if is_closed(shape) and volume(*vars_of(shape)) > 0]
    chosen = [s for s in shapes if options.only in s.name][: options.meshes]
    pairs = [b for b in random_booleans(options.booleans, solids) if options.only in b.name]
    rows, size = [], 2**options.depth
    for text in options.interpolants:
        how = edges.Contour.named(text)
        tally = run_meshes(chosen, size, how)
        rows.append([how.name, "meshes", *map(str, row_of(tally)), ""])
        other, compared, wrong = run_booleans(pairs, size, how)
        rows.append([how.name, "booleans", *map(str, row_of(other)), f"{wrong} of {compared}"])
        for kind, one in (("meshes", tally), ("booleans", other)):
            report.verdict(
                not (one.unsound or one.cut),
                f"{how.name}, {kind}: of {one.done} results {one.unsound} are not closed and "
                f"2-manifold, {one.cut} intersect themselves",
            )
        report.verdict(
            wrong == 0, f"{how.name}: {wrong} of {compared} booleans have the wrong volume"
        )
    head = ("contour", "of", "results", "not manifold", "cut", "with flat", "s", "wrong volume")
    report.table(f"{size} cells along an axis", head, rows, "results")
    report.finish(options.json)


def row_of(tally: Tally) -> list[str]:
    """The columns of the table."""
    numbers = map(str, (tally.done, tally.unsound, tally.cut, tally.flat))
    return [*numbers, f"{tally.seconds:.1f}"]


if __name__ == "__main__":
    main()
