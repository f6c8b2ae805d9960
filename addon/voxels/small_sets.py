# SPDX-License-Identifier: GPL-3.0-or-later

"""Small sets of faces, such as face sets of Sculpt Mode, transferred to a surface.

Each new face gets the number of the nearest source face, so a set of the size of a cell may get no
face. It then gets the faces that it covers most, up to its own area.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from .quads import halves

_MIN_FACE_SHARE = 0.5
"""Share of a face's area that a set needs to have left to get the face."""
_MAX_CELL_FACES = 16.0
"""Area of a set, in faces of a cell, above which a set without faces is gone on purpose."""
_SAMPLE_SPACING = 0.25
"""Distance between samples of a set, in cells."""
_MAX_SAMPLES_PER_SIDE = 64
"""Greatest number of samples along a side of a triangle."""
_REACH_CELLS = 1.0
"""Greatest distance of samples from the surface, in cells."""

Floats = NDArray[np.floating]
Integers = NDArray[np.int32]
Numbers = NDArray[Any]


@dataclass(frozen=True)
class NumberedFaces:
    """Triangles or quads with a number per face.

    Attributes:
        positions: (n, 3).
        faces: (m, 3) or (m, 4).
        numbers: (m,) whole numbers, or booleans.
    """

    positions: Floats
    faces: Integers
    numbers: Numbers

    def only(self, chosen: Numbers) -> "NumberedFaces":
        """Selects faces."""
        return NumberedFaces(self.positions, self.faces[chosen], self.numbers[chosen])

    def areas(self) -> NDArray[np.float64]:
        """Area of each face."""
        a, b, c = np.moveaxis(self.positions[halves(self.faces)].astype(np.float64), 1, 0)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
        return np.asarray(areas.reshape(len(self.faces), -1).sum(axis=1))


def with_small_sets(
    source: NumberedFaces, surface: NumberedFaces, cell: float, threads: int
) -> Numbers:
    """Gives small sets of the source that no face belongs to faces of the surface.

    Args:
        source: Triangles of the source.
        surface: The surface made of them.
        cell: The side of a cell.
        threads: Number of threads; 0 for all processors.

    Returns:
        The new numbers of the surface's faces.
    """
    missed = source.only(~np.isin(source.numbers, surface.numbers))
    if not len(missed.faces):
        return surface.numbers
    areas = surface.areas()
    sets, set_indices = np.unique(missed.numbers, return_inverse=True)
    set_indices = set_indices.reshape(-1)
    sizes = np.bincount(set_indices, missed.areas())
    is_small = (sizes >= _MIN_FACE_SHARE * areas.min()) & (sizes <= _MAX_CELL_FACES * cell**2)
    chosen = is_small[set_indices]
    if not chosen.any():
        return surface.numbers
    small = NumberedFaces(missed.positions, missed.faces[chosen], set_indices[chosen])
    covering, faces, covered = _covered(small, surface, cell, threads)
    order = np.lexsort([faces, -covered / areas[faces], covering])
    numbers = surface.numbers.copy()
    _, owners, left = np.unique(numbers, return_inverse=True, return_counts=True)
    owners = owners.reshape(-1)
    for index, face in zip(covering[order].tolist(), faces[order].tolist(), strict=True):
        # A set does not take a face that was just assigned, or another set's last one.
        is_taken = owners[face] < 0 or left[owners[face]] == 1
        if sizes[index] < _MIN_FACE_SHARE * areas[face] or is_taken:
            continue
        sizes[index] -= areas[face]
        left[owners[face]] -= 1
        owners[face] = -1
        numbers[face] = sets[index]
    return numbers


def _covered(
    source: NumberedFaces, surface: NumberedFaces, cell: float, threads: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Pairs of sets and faces of the surface that they cover, with the covered area."""
    points, numbers, weights = _samples(source, _SAMPLE_SPACING * cell)
    nearest, _, distances = prefilter.nearest_points(
        points, surface.positions, halves(surface.faces), threads=threads
    )
    near = distances <= _REACH_CELLS * cell
    faces = nearest[near].astype(np.int64) // (surface.faces.shape[1] - 2)
    count = len(surface.faces)
    pairs, rows = np.unique(numbers[near] * count + faces, return_inverse=True)
    covered = np.bincount(rows.reshape(-1), weights[near], len(pairs))
    return pairs // count, pairs % count, np.asarray(covered, np.float64)


def _samples(
    source: NumberedFaces, spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Points on triangles, the triangles' numbers, and the area per point."""
    areas = source.areas()
    steps = np.clip(np.ceil(np.sqrt(areas) / spacing), 1, _MAX_SAMPLES_PER_SIDE).astype(int)
    points, numbers, weights = [], [], []
    for count in np.unique(steps):
        chosen = np.flatnonzero(steps == count)
        shares = _centers(int(count))
        corners = source.positions[source.faces[chosen]].astype(np.float64)
        points.append(np.einsum("ij,kjl->kil", shares, corners).reshape(-1, 3))
        numbers.append(np.repeat(source.numbers[chosen].astype(np.int64), len(shares)))
        weights.append(np.repeat(areas[chosen] / len(shares), len(shares)))
    return np.concatenate(points), np.concatenate(numbers), np.concatenate(weights)


def _centers(count: int) -> NDArray[np.float64]:
    """Barycentric coordinates of the centers of a triangle's `count`² equal parts."""
    i, j = np.indices((count, count)).reshape(2, -1)
    upright, inverted = i + j < count, i + j < count - 1
    thirds = np.concatenate(
        [
            np.stack([3 * i + 1, 3 * j + 1], axis=1)[upright],
            np.stack([3 * i + 2, 3 * j + 2], axis=1)[inverted],
        ]
    )
    shares = thirds / (3.0 * count)
    return np.column_stack([shares, 1.0 - shares.sum(axis=1)])
