# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures how flat the facets of low-poly shapes and of their booleans are.

Usage: scripts/run python3 bench/voxels/facets.py [--size N] [--interpolants NAME...]

The columns: the share of the area more than 2 and 10 degrees off the shape where it is nearest; the
edges that turn by more than 120 degrees where the shape's do not; pairs of triangles that cut each
other; triangles. The truth of booleans is manifold3d's (PyPI); without it they are left out. Cuts
are counted as by edges.py.
"""

import argparse
import itertools
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench import solids
from bench.report import Report, add_json_option
from bench.voxels import booleans, edges, measures
from bench.voxels.sharp_shapes import Shape, Solid, at_height, circle, cube, cylinder, rotation

HEAD = ("subject", "contour", "off 2&deg; %", "off 10&deg; %", "folds", "cuts", "triangles")
AREA = 0.001
Parts = tuple[Shape, ...]


def ball(rounds: int) -> Shape:
    """An octahedron whose triangles are split into four so often, on a sphere."""
    made = solids.sphere(1.0, rounds)
    return Shape("ball", made.positions, made.triangles.astype(np.int64))


def dome(around: int, rings: int) -> Shape:
    """Rings of quads on a sphere."""
    solid = Solid()
    heights = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)[1:-1]
    loops = [solid.loop(at_height(circle(np.cos(h), around), np.sin(h))) for h in heights]
    for low, high in itertools.pairwise(loops):
        solid.strip(low, high)
    solid.face(loops[0][::-1])
    solid.face(loops[-1])
    return solid.named("dome")


SHAPES: dict[str, Callable[[], Parts]] = {
    "cylinder of 48": lambda: (cylinder(48).moved(rotation(6)),),
    "ball of 512": lambda: (ball(3).moved(rotation(5)),),
    "dome of 32 by 16": lambda: (dome(32, 16).moved(rotation(5)),),
}
BOOLEANS: dict[str, Callable[[], Parts]] = {
    "ball of 128 difference cube": lambda: (
        ball(2).moved(rotation(2)),
        cube().moved(0.8 * rotation(4), [0.9, 0, 0]),
    ),
    "cylinder of 20 union of 16": lambda: (
        cylinder(20).moved(rotation(3)),
        cylinder(16).moved(0.7 * rotation(11), [0.1, 0.3, 0]),
    ),
    "cylinder of 24 difference of 12": lambda: (
        cylinder(24).moved(rotation(3)),
        cylinder(12).moved(0.4 * rotation(7), [0.1, 0.2, 0.1]),
    ),
    "dome of 24 by 12 intersection cube": lambda: (
        dome(24, 12).moved(rotation(9)),
        cube().moved(0.8 * rotation(1), [0, 0.5, 0]),
    ),
}


def subjects() -> list[edges.Subject]:
    """The shapes, and the booleans where manifold3d is."""
    found = []
    for name, make in SHAPES.items():
        (shape,) = make()
        found.append(edges.Subject(name, (shape,), "", shape, sharp(shape)))
    if booleans.missing():
        print(f"booleans are left out: {booleans.missing()} is missing")
        return found
    for name, make in BOOLEANS.items():
        parts = make()
        operation = next(word for word in booleans.OPERATORS if word in name)
        truth, _ = booleans.combined(parts, operation)
        found.append(edges.Subject(name, parts, operation, truth, sharp(truth)))
    return found


def sharp(shape: Shape) -> measures.Edges:
    """Its edges that may be folds."""
    return measures.sharp_edges(shape.positions, shape.triangles, 100)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--interpolants", nargs="+", default=["plane+clean", "sharp+clean"])
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    rows = []
    judged = []
    for subject in subjects():
        _, cell = edges.box_around(subject.sources, options.size)
        truth = subject.truth
        for text in options.interpolants:
            how = edges.Contour.named(text)
            positions, triangles, _ = edges.contour(subject, options.size, how)
            off = measures.degrees_off(positions, triangles, truth.positions, truth.triangles, cell)
            wrong = float((off > 10).mean())
            folds = measures.folds(positions, triangles, 120, subject.edges, cell)
            cuts = measures.self_intersections(positions, triangles)[0]
            rows.append(
                [
                    subject.name,
                    how.name,
                    f"{100 * (off > 2).mean():.3f}",
                    f"{100 * wrong:.3f}",
                    str(folds),
                    str(cuts),
                    str(len(triangles)),
                ]
            )
            if how.interpolant == "sharp":
                judged.append((f"{subject.name}, {how.name}", wrong, folds))
    report.table(f"{options.size} cells along an axis", HEAD, rows, "facets")
    for name, wrong, folds in judged:
        report.verdict(
            wrong <= AREA and folds == 0,
            f"{name}: {100 * wrong:.3f} % of the area off, {folds} folds; "
            f"{100 * AREA} % and none are allowed",
        )
    report.finish(options.json)


if __name__ == "__main__":
    main()
