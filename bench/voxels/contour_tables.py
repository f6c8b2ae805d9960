# SPDX-License-Identifier: GPL-3.0-or-later

"""The tables of section 5.4: contours of planes and spheres whose occupancies are exact.

scripts/run python3 bench/voxels/contour_tables.py [--planes N] [--spheres N] [--json FILE]

Occupancies come from closed forms and quadrature, not from the library. Voxelizing a contour gives
the volume that it encloses in a cell; the exactness of voxelize has its own tests.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import prefilter

from bench.report import Report, add_json_option

INTERPOLANTS = ("linear", "occupancy", "plane")
ON_SPHERE = "on the sphere"


def plane_occupancies(n: int, normal: np.ndarray, offset: float) -> np.ndarray:
    """Shares of n^3 unit cells with normal . p <= offset, by inclusion-exclusion."""
    cells = np.indices((n, n, n)).reshape(3, -1).T.astype(float)
    size = np.abs(normal)
    rest = offset - (cells + np.where(normal > 0, 0, 1)) @ normal
    shares = np.zeros(len(cells))
    for corner in range(8):
        bits = np.array([(corner >> k) & 1 for k in range(3)])
        shares += (-1) ** bits.sum() * np.maximum(rest - size @ bits, 0) ** 3
    shares /= 6 * size.prod()
    shares[rest <= 0] = 0
    shares[rest >= size.sum()] = 1
    return np.clip(shares, 0, 1).reshape(n, n, n)


def sphere_occupancies(n: int, center: np.ndarray, radius: float, columns: int = 32) -> np.ndarray:
    """Shares of n^3 unit cells in the sphere, by columns along the axis it faces most."""
    middles = np.indices((n, n, n)).reshape(3, -1).T + 0.5 - center
    distance = np.linalg.norm(middles, axis=1)
    shares = (distance < radius).astype(float)
    near = np.abs(distance - radius) < 0.87
    cells = middles[near]
    axis = np.argmax(np.abs(cells), axis=1)
    rows = np.arange(len(cells))
    height = np.abs(cells[rows, axis]) - 0.5  # of a cell's near side over the plane of the center
    u = cells[rows, (axis + 1) % 3]
    v = cells[rows, (axis + 2) % 3]
    steps = (np.arange(columns) + 0.5) / columns - 0.5
    total = np.zeros(len(cells))
    for du in steps:
        for dv in steps:
            squared = radius**2 - (u + du) ** 2 - (v + dv) ** 2
            top = np.sqrt(np.maximum(squared, 0))
            total += np.clip(top - height, 0, 1) - np.clip(-top - height, 0, 1)
    shares[near] = np.clip(total / columns**2, 0, 1)
    return shares.reshape(n, n, n)


@dataclass
class PlaneErrors:
    """In cells that a plane cuts: the volume in the contour minus the volume under the plane."""

    mean: float
    deviation: float
    largest: float


def plane_errors(count: int, seed: int = 0, n: int = 16) -> dict[str, PlaneErrors]:
    """Over random planes through the middle of a grid, away from its border."""
    random = np.random.default_rng(seed)
    differences: dict[str, list[np.ndarray]] = {name: [] for name in INTERPOLANTS}
    core = np.zeros((n, n, n), bool)
    core[5:-5, 5:-5, 5:-5] = True
    for _ in range(count):
        normal = random.normal(size=3)
        normal /= np.linalg.norm(normal)
        offset = normal @ (n / 2 + random.random(3) - 0.5)
        exact = plane_occupancies(n, normal, offset)
        cut = core & (exact > 0) & (exact < 1)
        for name, found in differences.items():
            positions, triangles = prefilter.contour(
                exact.astype(np.float32), interpolant=name, cleanup=False
            )
            octree = prefilter.voxelize(
                positions.astype(float), triangles, depth=4, bounds=([0, 0, 0], [n, n, n])
            )
            found.append((octree.dense() - exact)[cut])
    errors = {}
    for name, found in differences.items():
        every = np.concatenate(found)
        errors[name] = PlaneErrors(
            float(np.abs(every).mean()), float(every.std()), float(np.abs(every).max())
        )
    return errors


@dataclass
class SphereErrors:
    """Distances in cells, angles in degrees; normals weigh by the area of their triangles."""

    radius: float  # root mean square of the vertices' distance from the sphere
    mean_normal: float
    largest_normal: float  # of triangles of at least a millionth of the sphere


def on_the_sphere(positions: np.ndarray, center: np.ndarray, radius: float) -> np.ndarray:
    """Vertices moved along the lines between samples that they are on: the best there can be."""
    offsets = np.abs(positions - 0.5 - np.round(positions - 0.5))
    axis = offsets.argmax(axis=1)
    rows = np.arange(len(positions))
    points = positions.astype(float) - center
    along = points[rows, axis]
    squared = radius**2 - (points**2).sum(axis=1) + along**2
    points[rows, axis] = np.copysign(np.sqrt(np.maximum(squared, 0)), along)
    return points


def sphere_errors(grid: np.ndarray, center: np.ndarray, radius: float) -> dict[str, SphereErrors]:
    errors = {}
    for name in (*INTERPOLANTS, ON_SPHERE):
        interpolant = "plane" if name == ON_SPHERE else name
        positions, triangles = prefilter.contour(
            grid.astype(np.float32), interpolant=interpolant, cleanup=False
        )
        points = positions.astype(float) - center
        if name == ON_SPHERE:
            points = on_the_sphere(positions, center, radius)
        corners = points[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = np.linalg.norm(normals, axis=1) / 2
        directions = corners.mean(axis=1)
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        cosines = (normals * directions).sum(axis=1) / np.maximum(2 * areas, 1e-300)
        angles = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
        seen = areas > 1e-6 * areas.sum()
        distances = np.linalg.norm(points, axis=1) - radius
        errors[name] = SphereErrors(
            float(np.sqrt((distances**2).mean())),
            float((angles * areas).sum() / areas.sum()),
            float(angles[seen].max()),
        )
    return errors


def random_spheres(radius: float, count: int, seed: int = 0) -> dict[str, SphereErrors]:
    """The means over spheres at random places in the grid."""
    random = np.random.default_rng(seed)
    n = int(2 * radius + 6)
    every: dict[str, list[SphereErrors]] = {name: [] for name in (*INTERPOLANTS, ON_SPHERE)}
    for _ in range(count):
        center = n / 2 + random.random(3) - 0.5
        grid = sphere_occupancies(n, center, radius)
        for name, errors in sphere_errors(grid, center, radius).items():
            every[name].append(errors)
    return {
        name: SphereErrors(
            float(np.mean([e.radius for e in errors])),
            float(np.mean([e.mean_normal for e in errors])),
            float(np.mean([e.largest_normal for e in errors])),
        )
        for name, errors in every.items()
    }


def large_sphere(n: int = 256) -> dict[str, SphereErrors]:
    center = n / 2 + np.array([0.13, 0.37, -0.21])
    radius = 0.45 * n
    return sphere_errors(sphere_occupancies(n, center, radius), center, radius)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--planes", type=int, default=5000)
    parser.add_argument("--spheres", type=int, default=20, help="places of each radius")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    rows = [
        [name, f"{plane.mean:.4%}", f"{plane.deviation:.4%}", f"{plane.largest:.4%}"]
        for name, plane in plane_errors(options.planes).items()
    ]
    head = ("planes", "mean absolute", "standard deviation", "largest")
    report.table(f"{options.planes} random planes", head, rows, "planes")
    rows = []
    for radius in (1, 2, 3, 5, 7, 10, 15, 20, 30):
        spheres = random_spheres(radius, options.spheres)
        cells = [
            f"{s.mean_normal:.3f}, {s.largest_normal:.2f}"
            if name != ON_SPHERE
            else f"{s.mean_normal:.3f}"
            for name, s in spheres.items()
        ]
        rows.append([str(radius), *cells])
    title = "Angles on spheres, in degrees: mean, largest"
    report.table(title, ("radius", *INTERPOLANTS, ON_SPHERE), rows, "spheres")
    rows = [
        [name, f"{sphere.radius:.5f}", f"{sphere.mean_normal:.3f}"]
        for name, sphere in large_sphere().items()
    ]
    head = ("256^3", "radius, rms", "normal, mean")
    report.table("A sphere of 115 cells", head, rows, "sphere")
    report.write(options.json)


if __name__ == "__main__":
    main()
