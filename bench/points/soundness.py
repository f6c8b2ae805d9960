# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures missing and invented parts of a scan's surface, and whether it is sound.

Usage: python3 -m bench.points.soundness MESH.ply TRUTH|- CELL POINTS.ply [--samples N]

TRUTH is the surface that the points were taken from; for real scans, -, the points themselves stand
for it. Prints one line of JSON. Distances are in cells. Self-intersections are counted by the
program of bench/voxels/self_intersections.cpp, which PREFILTER_SELF_INTERSECTIONS may name.
"""

import argparse
import dataclasses
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bench.points import ply
from bench.points.measure import HIGH, manifold_kind
from bench.points.sets import Model
from bench.voxels.measures import edges, folds, self_intersections, sharp_edges
from bench.voxels.meshes import Triangles

SAMPLES = 200_000
FAR = 3.0  # Cells: farther parts are lost, or invented.
SPARSE = 3.0  # Spacings: as far may a surface be from the points of a real scan.
NEIGHBOR = 4  # Whose distance is the spacing.
FOLD = 90.0  # Degrees.
CREASE = 70.0  # Degrees: edges of a box turn by a little over 90 here and there.
NEAR_CREASE = 2.0  # Cells.
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Soundness:
    """Properties and errors of a surface.

    Attributes:
        triangles: Their number.
        folded: The share of edges that turn by more than 90 degrees, except edges of the truth [%].
        cut: Triangles that cut others.
        parts: Connected parts.
        genus: Of all parts together; -1 where the surface is not closed.
        lost: The share of the truth or of the points farther than `FAR` from the surface [%].
        invented: The share of the surface that far from the truth or from the points [%].
        mean: Distance of surface and truth, or of the points from the surface [cells].
        high: Its 99.9th percentile.
        degrees: The mean angle of normals of the surface, where it is near, to the true ones.
    """

    triangles: int
    folded: float
    cut: int
    parts: int
    genus: int
    lost: float
    invented: float
    mean: float
    high: float
    degrees: float


def soundness(
    made: Path, truth: Path | None, cell: float, points: Path, samples: int = SAMPLES
) -> Soundness:
    """Measures a surface."""
    surface = ply.read_mesh(made)
    shape = None if truth is None else Model.read(truth)
    folded = folded_share(surface, None if shape is None else shape.mesh, cell)
    _, cut, _, _ = self_intersections(surface.positions, surface.triangles)
    parts, genus = topology(surface)
    if shape is None:
        there, back, angles = beside_points(surface, ply.read_points(points), samples)
        distances = back / cell
    else:
        there, back, angles = beside_truth(surface, shape, samples, FAR * cell)
        distances = np.concatenate([there, back]) / cell
    return Soundness(
        len(surface.triangles),
        100 * folded,
        cut,
        parts,
        genus,
        100 * float((back > FAR * cell).mean()),
        100 * float((there > FAR * cell).mean()),
        float(distances.mean()),
        float(np.percentile(distances, HIGH)),
        float(angles.mean()) if len(angles) else 90.0,
    )


def folded_share(surface: Triangles, truth: Triangles | None, cell: float) -> float:
    """Returns the share of edges that turn by more than `FOLD`, away from the truth's creases."""
    _, _, turns = edges(surface.positions, surface.triangles)
    creases = None if truth is None else sharp_edges(truth.positions, truth.triangles, CREASE)
    found = folds(surface.positions, surface.triangles, FOLD, creases, NEAR_CREASE * cell)
    return found / len(turns)


def topology(surface: Triangles) -> tuple[int, int]:
    """Returns the number of pieces, and their genus together; -1 where they are not closed."""
    used, corners = np.unique(surface.triangles, return_inverse=True)
    corners = corners.reshape(-1, 3)
    pairs = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    graph = coo_matrix((np.ones(len(pairs[0]), bool), pairs), shape=(len(used),) * 2)
    parts, _ = connected_components(graph, directed=False)
    if not manifold_kind(surface)[0]:
        return parts, -1
    euler = len(used) - len(corners) // 2
    return parts, (2 * parts - euler) // 2


def beside_truth(
    surface: Triangles, truth: Model, samples: int, near: float
) -> tuple[Floats, Floats, Floats]:
    """Returns distances from the surface to the truth and back, and angles where it is near."""
    drawn, normals = Model.of(surface).draw(samples, np.random.default_rng(3))
    found, _, there = prefilter.nearest_points(drawn, truth.mesh.positions, truth.mesh.triangles)
    aims, _ = truth.draw(samples, np.random.default_rng(4))
    _, _, back = prefilter.nearest_points(aims, surface.positions, surface.triangles)
    angles = between(normals, truth.normals[found])
    return there, back, angles[there <= near]


def beside_points(
    surface: Triangles, cloud: tuple[Floats, Floats], samples: int
) -> tuple[Floats, Floats, Floats]:
    """Returns the same for a cloud of points with normals as the truth.

    Surface samples nearer to the points than `SPARSE` of their local spacing count as on them.
    """
    points, normals = (np.asarray(part, np.float64) for part in cloud)
    model = Model.of(surface)
    drawn, _ = model.draw(samples, np.random.default_rng(3))
    tree = cKDTree(points)
    there, nearest = tree.query(drawn)
    spacing = tree.query(points[nearest], k=[NEIGHBOR + 1])[0][:, 0]
    there[there < SPARSE * spacing] = 0
    chosen = np.random.default_rng(4).permutation(len(points))[:samples]
    found, _, back = prefilter.nearest_points(points[chosen], surface.positions, surface.triangles)
    lengths = np.linalg.norm(normals[chosen], axis=1)
    angles = between(model.normals[found], normals[chosen] / np.maximum(lengths, 1e-30)[:, None])
    return there, back, angles


def between(first: Floats, second: Floats) -> Floats:
    """The angles between unit vectors [degrees]."""
    return np.degrees(np.arccos(np.clip((first * second).sum(axis=1), -1, 1)))


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", type=Path)
    parser.add_argument("truth", help="a mesh, or -")
    parser.add_argument("cell", type=float)
    parser.add_argument("points", type=Path)
    parser.add_argument("--samples", type=int, default=SAMPLES, help="each way")
    options = parser.parse_args()
    truth = None if options.truth == "-" else Path(options.truth)
    found = soundness(options.mesh, truth, options.cell, options.points, options.samples)
    print(json.dumps(dataclasses.asdict(found)))


if __name__ == "__main__":
    main()
