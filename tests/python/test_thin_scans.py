# SPDX-License-Identifier: GPL-3.0-or-later

"""Parts about a cell thick, which smoothing would push below the iso-value."""

import numpy as np
import prefilter
import pytest
import solids
from numpy.typing import NDArray

Floats = NDArray[np.float64]

DEPTH = 7
BASE = np.array([1.0, 1.0, 0.2])
CELL = 1.0 / 97  # At that depth, with a base as large as this one.


def turned(vectors: Floats) -> Floats:
    """Rotates vectors so that no axis or face is aligned with the grid."""
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    sine, cosine = np.sin(0.4), np.cos(0.4)
    along = (vectors @ axis)[:, None] * axis
    return cosine * (vectors - along) + sine * np.cross(axis, vectors) + along


def box(low: Floats, size: Floats, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Points on a box, two for each face of a cell, and their normals."""
    points, normals = [], []
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        count = int(2.0 * np.prod(size[others]) / CELL**2)
        for side in (0.0, 1.0):
            found = low + size * random.random((count, 3))
            found[:, axis] = low[axis] + side * size[axis]
            points.append(found)
            normals.append(np.tile((2.0 * side - 1.0) * np.eye(3)[axis], (count, 1)))
    return np.concatenate(points), np.concatenate(normals)


def cloud_with(size_in_cells: tuple[float, float, float]) -> tuple[Floats, Floats, Floats]:
    """A part above a base: all points, all normals, and the points of the part."""
    random = np.random.default_rng(5)
    base = box(np.zeros(3), BASE, random)
    part = box(np.array([0.4, 0.3, 0.4]), CELL * np.array(size_in_cells), random)
    points = turned(np.concatenate([base[0], part[0]]))
    return points, turned(np.concatenate([base[1], part[1]])), turned(part[0])


PARTS = {
    "plate of one cell": (1.0, 40.0, 40.0),
    "plate of 1.4": (1.4, 40.0, 40.0),
    "rod of 1.5": (1.5, 1.5, 40.0),
    "rod of two": (2.0, 2.0, 40.0),
}


@pytest.mark.parametrize("size", PARTS.values(), ids=PARTS)
def test_thin_parts_are_kept(size: tuple[float, float, float]) -> None:
    points, normals, part = cloud_with(size)
    report = prefilter.ReconstructionReport()
    positions, triangles = prefilter.reconstruct(points, normals, depth=DEPTH, report=report)
    assert abs(report.cell / CELL - 1.0) < 0.02
    assert solids.surface_faults(positions, triangles).none
    off = prefilter.nearest_points(part, positions, triangles)[2] / report.cell
    assert off.max() < 2.0
    assert np.mean(off) < 0.2


def test_thin_parts_are_the_same_in_slabs() -> None:
    points, normals, _ = cloud_with(PARTS["plate of one cell"])
    report = prefilter.ReconstructionReport()
    at_once = prefilter.reconstruct(points, normals, depth=8, threads=1)
    spilled = prefilter.reconstruct(
        points, normals, depth=8, threads=3, memory_limit=0, report=report
    )
    assert report.is_spilled
    for a, b in zip(at_once, spilled, strict=True):
        np.testing.assert_array_equal(a, b)
