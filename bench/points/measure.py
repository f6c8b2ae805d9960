# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures a reconstructed surface against the mesh that its points were drawn from.

Usage: python3 -m bench.points.measure MESH.ply SOURCE DEPTH POINTS.ply [--samples N] [--json]

SOURCE is a mesh, or - for scans, of which nobody knows the surface: then it is the distances of the
points that are measured. Distances are in finest cells of prefilter's octree around the points,
whatever program made the surface; both ways together, from samples that are spread evenly over the
area.
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

from bench.points import ply
from bench.points.sets import Model, cell_of
from bench.voxels.meshes import Triangles

SAMPLES = 500_000
HIGH = 99.9


@dataclass(frozen=True)
class Quality:
    """Properties and errors of a surface.

    Attributes:
        triangles: Their number.
        is_closed: Every edge is between two triangles that agree on the inside.
        is_manifold: It is closed, and the triangles around each vertex are one fan.
        mean: Distance of surface and source [cells]; of the points from the surface where there
            is no source.
        high: Its 99.9th percentile.
        largest: Its largest value.
        to_source: The mean from the surface to the source alone.
        from_source: The mean from the source to the surface alone.
        degrees: The mean angle between the normals of the surface and of the source.
    """

    triangles: int
    is_closed: bool
    is_manifold: bool
    mean: float
    high: float
    largest: float
    to_source: float = float("nan")
    from_source: float = float("nan")
    degrees: float = float("nan")


def quality(made: Path, source: Path | None, depth: int, points: Path, samples: int) -> Quality:
    """Measures a surface."""
    surface = ply.read_mesh(made)
    cloud, _ = ply.read_points(points)
    cell = cell_of(cloud, depth)
    count = len(surface.triangles)
    manifold = manifold_kind(surface)
    if source is None:
        chosen = np.random.default_rng(3).permutation(len(cloud))[:samples]
        _, _, distances = prefilter.nearest_points(
            cloud[chosen], surface.positions, surface.triangles
        )
        return Quality(count, *manifold, *summary(distances / cell))
    model = Model.read(source)
    drawn, normals = Model.read(made).draw(samples, np.random.default_rng(3))
    found, _, there = prefilter.nearest_points(drawn, model.mesh.positions, model.mesh.triangles)
    cosines = (normals * model.normals[found]).sum(axis=1)
    aims, _ = model.draw(samples, np.random.default_rng(4))
    _, _, back = prefilter.nearest_points(aims, surface.positions, surface.triangles)
    return Quality(
        count,
        *manifold,
        *summary(np.concatenate([there, back]) / cell),
        float(there.mean() / cell),
        float(back.mean() / cell),
        float(np.degrees(np.arccos(np.clip(cosines, -1, 1))).mean()),
    )


def summary(distances: NDArray[np.float64]) -> tuple[float, float, float]:
    """Returns mean, high percentile and maximum."""
    return float(distances.mean()), float(np.percentile(distances, HIGH)), float(distances.max())


def manifold_kind(mesh: Triangles) -> tuple[bool, bool]:
    """Returns whether the mesh is closed, and whether it is a closed 2-manifold."""
    size = len(mesh.positions)
    starts = mesh.triangles.ravel()
    ends = np.roll(mesh.triangles, -1, axis=1).ravel()
    edges, twins = starts * size + ends, ends * size + starts
    order, twin_order = np.argsort(edges), np.argsort(twins)
    ordered = edges[order]
    if not len(edges) or (ordered[1:] == ordered[:-1]).any():
        return False, False
    if (ordered != twins[twin_order]).any():
        return False, False
    # An edge shares its start with the edge after its twin; edges connected so form one fan.
    twin = np.empty_like(order)
    twin[order] = twin_order
    after = twin - twin % 3 + (twin + 1) % 3
    ones = np.ones(len(edges), bool)
    graph = coo_matrix((ones, (np.arange(len(edges)), after)), shape=(len(edges),) * 2)
    fans, _ = connected_components(graph, directed=False)
    return True, fans == len(np.unique(starts))


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", type=Path)
    parser.add_argument("source", help="a mesh, or -")
    parser.add_argument("depth", type=int)
    parser.add_argument("points", type=Path)
    parser.add_argument("--samples", type=int, default=SAMPLES, help="each way")
    parser.add_argument("--json", action="store_true", help="print a line for programs")
    options = parser.parse_args()
    source = None if options.source == "-" else Path(options.source)
    found = quality(options.mesh, source, options.depth, options.points, options.samples)
    if options.json:
        print(json.dumps(dataclasses.asdict(found)))
        return
    for name, value in dataclasses.asdict(found).items():
        print(f"{name:12} {value:.4f}" if isinstance(value, float) else f"{name:12} {value}")


if __name__ == "__main__":
    main()
