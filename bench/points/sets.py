# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the reconstructed points: samples of meshes with several kinds of degradation, and scans.

Usage: python3 -m bench.points.sets FOLDER [NAME...] [--shared FOLDER]

Without names all sets are made but igea_10m and igea_100m, the latter 2.4 GB; a set that is there
already stays as it is. Each is a binary PLY of floats with normals, the same on every run. Meshes
and scans are those gathered in ../shared beside the checkout.
"""

import argparse
import tarfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray

from bench.points import ply
from bench.points.scans import merged
from bench.voxels.meshes import DATA, Triangles

SHARED = DATA.parent
MILLION = 1_000_000
PIECE = MILLION
DEPTH = 9  # Depth of the cells that noise is measured in.
NOISE = 0.5  # Cells, of each coordinate: one standard deviation.
TILT = 60.0  # Degrees at the most.
DENSITIES = 30.0
OUTLIERS = 0.02
BOX = 1.1  # The box of outliers, against that of the points.
Floats = NDArray[np.float64]
Cloud = tuple[Floats, NDArray[np.float32]]


@dataclass(frozen=True)
class Model:
    """A mesh that points are drawn from."""

    mesh: Triangles
    normals: Floats  # (m, 3), of length 1, or 0 where a triangle has no area
    sums: Floats  # (m,) areas of the triangles up to and with each

    @staticmethod
    def read(path: Path) -> "Model":
        """Reads a mesh."""
        return Model.of(ply.read_mesh(path))

    @staticmethod
    def of(mesh: Triangles) -> "Model":
        """Makes a mesh ready."""
        areas = np.linalg.norm(mesh.area_vectors, axis=1)
        normals = mesh.area_vectors / np.where(areas > 0, areas, 1)[:, None]
        return Model(mesh, normals, np.cumsum(areas))

    def draw(self, count: int, random: np.random.Generator) -> Cloud:
        """Points spread evenly over the area, with the normals of their triangles."""
        found = np.searchsorted(self.sums, random.random(count) * self.sums[-1], side="right")
        a, b, c = np.moveaxis(self.mesh.corners[found], 1, 0)
        root, share = np.sqrt(random.random((count, 1))), random.random((count, 1))
        points = (1 - root) * a + root * ((1 - share) * b + share * c)
        return points, self.normals[found].astype(np.float32)


def cell_of(points: NDArray[np.floating], depth: int) -> float:
    """The side of a finest cell [units of the points], as prefilter's own octree has it."""
    bounds = points.min(axis=0).astype(float), points.max(axis=0).astype(float)
    low, high = prefilter.cube_around(bounds, depth=depth)
    return float((high - low)[0]) / 2**depth


def noisy(cloud: Cloud, random: np.random.Generator) -> Cloud:
    """Points moved by half a cell: normally distributed along each axis."""
    points, normals = cloud
    return points + random.normal(scale=NOISE * cell_of(points, DEPTH), size=points.shape), normals


def tilted(cloud: Cloud, random: np.random.Generator) -> Cloud:
    """Normals turned by angles that are spread evenly up to `TILT`, to any side."""
    points, normals = cloud
    aside = np.cross(normals, random.normal(size=normals.shape))
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    angles = np.radians(TILT) * random.random((len(points), 1))
    turned = np.cos(angles) * normals + np.sin(angles) * aside
    return points, turned.astype(np.float32)


def uneven(model: Model, random: np.random.Generator) -> Cloud:
    """Points `DENSITIES` times as dense here as there, with smooth changes between."""
    kept: list[Cloud] = []
    middle = model.mesh.positions.mean(axis=0)
    size = np.ptp(model.mesh.positions, axis=0).max()
    count = 0
    while count < MILLION:
        points, normals = model.draw(PIECE, random)
        waves = np.sin((points - middle) / size * 2 * np.pi + (0.3, 1.1, 2.0)).sum(axis=1)
        exponent = (np.sin(2 * waves) - 1) / 2
        taken = random.random(len(points)) < DENSITIES**exponent
        kept.append((points[taken], normals[taken]))
        count += int(taken.sum())
    points, normals = (np.concatenate(parts)[:MILLION] for parts in zip(*kept, strict=True))
    return points, normals


def outlying(cloud: Cloud, random: np.random.Generator) -> Cloud:
    """Every fiftieth point anywhere in the box, with any normal."""
    points, normals = (part.copy() for part in cloud)
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2 * BOX
    astray = random.permutation(len(points))[: round(OUTLIERS * len(points))]
    points[astray] = middle + half * random.uniform(-1, 1, (len(astray), 3))
    directions = random.normal(size=(len(astray), 3))
    normals[astray] = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    return points, normals


def pieces(model: Model, count: int, seed: int) -> Iterator[Cloud]:
    """Draws points without holding all of them."""
    random = np.random.default_rng(seed)
    for first in range(0, count, PIECE):
        yield model.draw(min(PIECE, count - first), random)


def bunny(shared: Path, folder: Path) -> Cloud:
    """The ten range scans of the Stanford bunny."""
    return merged(shared / "points/bunny/bun.conf")


def dragon(shared: Path, folder: Path) -> Cloud:
    """The fifteen range scans of the standing Stanford dragon."""
    with tarfile.open(shared / "points/dragon_stand.tar.gz") as archive:
        archive.extractall(folder, filter="data")
    return merged(folder / "dragon_stand/dragonStandRight.conf")


MODELS = {
    "igea": "igea_tri.ply",
    "armadillo": "armadillo.obj",
    "dragon_vrip": "dragon_vrip_res3.ply",
    "rocker-arm": "rocker-arm.obj",
    "bunny_mesh": "stanford-bunny.obj",
}
WORN: dict[str, Callable[[Cloud, np.random.Generator], Cloud]] = {
    "noisy": noisy,
    "tilted": tilted,
    "outliers": outlying,
}
SCANS = {"bunny_scans": bunny, "dragon_scans": dragon}
LARGE = {"igea_10m": 10 * MILLION, "igea_100m": 100 * MILLION}


def names() -> list[str]:
    """Returns the available sets, without the large ones."""
    found = [f"{model}_1m" for model in MODELS]
    for model in ("igea", "armadillo"):
        found.append(f"{model}_4500k")
        found += [f"{model}_{worn}" for worn in (*WORN, "uneven")]
    return [*found, *SCANS]


def source_of(name: str, shared: Path = SHARED) -> Path | None:
    """Returns the mesh that a set was drawn from; None for scans."""
    for model, file in MODELS.items():
        if name.startswith(f"{model}_"):
            return shared / "meshes" / file
    return None


def make(name: str, target: Path, shared: Path = SHARED) -> None:
    """Makes one set.

    Raises:
        ValueError: There is no set of that name.
    """
    if name in SCANS:
        points, normals = SCANS[name](shared, target.parent)
        return ply.write_points(target, len(points), [(points, normals)])
    known = (*names(), *LARGE)
    if name not in known:
        raise ValueError(f"no set is called '{name}'; there are {', '.join(known)}")
    source = source_of(name, shared)
    assert source is not None
    model = Model.read(source)
    kind = name.rpartition("_")[2]
    count = LARGE.get(name) or {"1m": MILLION, "4500k": 9 * MILLION // 2}.get(kind)
    if count:
        return ply.write_points(target, count, pieces(model, count, seed=1))
    random = np.random.default_rng(2)
    if kind == "uneven":
        made = uneven(model, random)
    else:
        made = WORN[kind](next(pieces(model, MILLION, seed=1)), random)
    return ply.write_points(target, len(made[0]), [made])


def main() -> None:
    """Makes the missing sets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", default=names())
    parser.add_argument("--shared", type=Path, default=SHARED, help="default: %(default)s")
    options = parser.parse_args()
    for name in options.names:
        target = options.folder / f"{name}.ply"
        if not target.exists():
            make(name, target, options.shared)
            print(f"{target}: {target.stat().st_size / 1e6:.0f} MB", flush=True)


if __name__ == "__main__":
    main()
