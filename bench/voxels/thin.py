# SPDX-License-Identifier: GPL-3.0-or-later

"""Counts parts, holes and folds of contours of thin shapes at random poses.

Usage: scripts/run python3 bench/voxels/thin.py [--poses N] [--interpolant NAME] [--json FILE]
"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import prefilter

from bench.report import Report, add_json_option
from bench.voxels.measures import folds, topology
from bench.voxels.thin_shapes import SHAPES, posed

THICKNESSES = (0.02, 0.3, 0.8, 1.0, 1.2, 1.4, 1.6, 2.0)
LEAST = 1.5


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poses", type=int, default=20)
    parser.add_argument("--interpolant", default="sharp")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    rows = []
    wrong_before = wrong = folded = 0
    for name, make in SHAPES.items():
        for thickness in THICKNESSES:
            shape = make(thickness)
            found = [0, 0, 0]
            volume = 0.0
            for seed in range(options.poses):
                solid = posed(shape, seed, 2**shape.depth)
                for k, least in enumerate((0.0, LEAST)):
                    tree = prefilter.voxelize(
                        solid.positions,
                        solid.triangles,
                        depth=shape.depth,
                        bounds=((0, 0, 0), (2**shape.depth,) * 3),
                        thickness=least,
                    )
                    positions, triangles = tree.contour(
                        interpolant=options.interpolant,
                        sources=[(solid.positions, solid.triangles)],
                    )
                    found[k] += topology(triangles) != (shape.parts, shape.genus)
                found[2] += folds(positions, triangles)
                volume += tree.volume / options.poses
            wrong_before, wrong, folded = (
                wrong_before + found[0],
                wrong + found[1],
                folded + found[2],
            )
            own = shape.solid.volume
            rows.append([name, f"{thickness:g}", *map(str, found), f"{own:.1f}", f"{volume:.1f}"])
    report.table(
        f"Of {options.poses} poses, those with other parts or holes than the shape",
        ["shape", "cells", "as it is", "thickened", "folds", "volume", "volume, thickened"],
        rows,
        "poses",
    )
    report.verdict(wrong == 0, f"parts and holes are the shape's: {wrong} of all are not")
    report.verdict(folded == 0, f"no edge turns by more than 120 degrees: {folded} do")
    report.finish(options.json)


if __name__ == "__main__":
    main()
