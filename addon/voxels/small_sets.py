# SPDX-License-Identifier: GPL-3.0-or-later

"""Small sets of faces, such as face sets of Sculpt Mode, in which no center of a new face may lie.

Each new face has the number of the nearest face of its source, so a set of the size of a cell may
get none. It then gets the faces that it covers most of, until they have its area.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from .quads import halves

_LEAST = 0.5
"""Of the area of a face, that a set needs to get the face."""
_MOST_CELLS = 16.0
"""Area, in faces of a cell, above which a set that no face is of was not missed, but is gone."""
_SPACING = 0.25
"""In cells, between samples of a set."""
_MOST_STEPS = 64
"""Samples along a side of a triangle."""
_REACH = 1.0
"""In cells, of samples from the surface."""

Floats = NDArray[np.floating]
Integers = NDArray[np.int32]
Numbers = NDArray[Any]


@dataclass(frozen=True)
class NumberedFaces:
    """Triangles or quads, with a number each.

    Attributes:
        positions: (n, 3).
        faces: (m, 3) or (m, 4).
        numbers: (m,) whole numbers, or booleans.
    """

    positions: Floats
    faces: Integers
    numbers: Numbers

    def only(self, chosen: Numbers) -> "NumberedFaces":
        """Returns some of the faces."""
        return NumberedFaces(self.positions, self.faces[chosen], self.numbers[chosen])

    def areas(self) -> NDArray[np.float64]:
        """Returns the area of each face."""
        a, b, c = np.moveaxis(self.positions[halves(self.faces)].astype(np.float64), 1, 0)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
        return np.asarray(areas.reshape(len(self.faces), -1).sum(axis=1))


def with_small_sets(
    source: NumberedFaces, surface: NumberedFaces, cell: float, threads: int
) -> Numbers:
    """Returns the numbers of a surface, with those of small sets of its source that it lacks.

    Args:
        source: Triangles.
        surface: What was made of them.
        cell: The side of a cell.
        threads: How many, or 0.
    """
    missed = source.only(~np.isin(source.numbers, surface.numbers))
    if not len(missed.faces):
        return surface.numbers
    areas = surface.areas()
    sets, of_faces = np.unique(missed.numbers, return_inverse=True)
    of_faces = of_faces.reshape(-1)
    sizes = np.bincount(of_faces, missed.areas())
    is_small = (sizes >= _LEAST * areas.min()) & (sizes <= _MOST_CELLS * cell**2)
    chosen = is_small[of_faces]
    if not chosen.any():
        return surface.numbers
    small = NumberedFaces(missed.positions, missed.faces[chosen], of_faces[chosen])
    of_sets, faces, covered = _covered(small, surface, cell, threads)
    order = np.lexsort([faces, -covered / areas[faces], of_sets])
    numbers = surface.numbers.copy()
    _, owners, left = np.unique(numbers, return_inverse=True, return_counts=True)
    owners = owners.reshape(-1)
    for one, face in zip(of_sets[order].tolist(), faces[order].tolist(), strict=True):
        # None gets the last face of another set, or one that it got just now.
        if sizes[one] < _LEAST * areas[face] or owners[face] < 0 or left[owners[face]] == 1:
            continue
        sizes[one] -= areas[face]
        left[owners[face]] -= 1
        owners[face] = -1
        numbers[face] = sets[one]
    return numbers


def _covered(
    source: NumberedFaces, surface: NumberedFaces, cell: float, threads: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Returns sets, faces of the surface that they cover, and how much area."""
    points, numbers, weights = _samples(source, _SPACING * cell)
    nearest, _, distances = prefilter.nearest_points(
        points, surface.positions, halves(surface.faces), threads=threads
    )
    near = distances <= _REACH * cell
    faces = nearest[near].astype(np.int64) // (surface.faces.shape[1] - 2)
    count = len(surface.faces)
    pairs, rows = np.unique(numbers[near] * count + faces, return_inverse=True)
    covered = np.bincount(rows.reshape(-1), weights[near], len(pairs))
    return pairs // count, pairs % count, np.asarray(covered, np.float64)


def _samples(
    source: NumberedFaces, spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Returns points on triangles, the triangles' numbers, and the area that each stands for."""
    areas = source.areas()
    steps = np.clip(np.ceil(np.sqrt(areas) / spacing), 1, _MOST_STEPS).astype(int)
    points, numbers, weights = [], [], []
    for count in np.unique(steps):
        of = np.flatnonzero(steps == count)
        shares = _centers(int(count))
        corners = source.positions[source.faces[of]].astype(np.float64)
        points.append(np.einsum("ij,kjl->kil", shares, corners).reshape(-1, 3))
        numbers.append(np.repeat(source.numbers[of].astype(np.int64), len(shares)))
        weights.append(np.repeat(areas[of] / len(shares), len(shares)))
    return np.concatenate(points), np.concatenate(numbers), np.concatenate(weights)


def _centers(count: int) -> NDArray[np.float64]:
    """Returns the barycentric coordinates of the centers of equal parts of a triangle."""
    i, j = np.indices((count, count)).reshape(2, -1)
    upright, turned = i + j < count, i + j < count - 1
    thirds = np.concatenate(
        [
            np.stack([3 * i + 1, 3 * j + 1], axis=1)[upright],
            np.stack([3 * i + 2, 3 * j + 2], axis=1)[turned],
        ]
    )
    shares = thirds / (3.0 * count)
    return np.column_stack([shares, 1.0 - shares.sum(axis=1)])
