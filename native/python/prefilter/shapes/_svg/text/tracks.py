# SPDX-License-Identifier: GPL-3.0-or-later

"""Paths that text runs along."""

import numpy as np
import numpy.typing as npt

from ...affine import Matrix
from ..model.outline import Outline

_STEPS = 256
_MAX_STEPS = 1_000_000
_FloatArray = npt.NDArray[np.float64]


def _rotate(points: _FloatArray, turn: _FloatArray) -> _FloatArray:
    # Multiplies term by term: matrix products of numpy round differently across processors.
    turned: _FloatArray = points[..., :1] * turn[0] + points[..., 1:] * turn[1]
    return turned


class Track:
    """An outline parametrized by arc length.

    Curves are approximated by chords short enough for lengths to be exact to 1e-5. Directions are
    those of the curves.

    Attributes:
        length: Total length, without gaps between subpaths.
    """

    def __init__(self, outline: Outline, matrix: Matrix) -> None:
        starts, ends, before, after = _chords(outline, matrix)
        self._starts, self._moves = starts, ends - starts
        self._before, self._after = before, after
        lengths = np.sqrt((self._moves * self._moves).sum(axis=1))
        self._ends = np.cumsum(lengths)
        self._lengths = lengths
        self.length = float(self._ends[-1]) if len(self._ends) else 0.0

    def at(self, distance: float) -> Matrix | None:
        """Returns the position and rotation at a distance from the start; None beyond the ends."""
        if not 0.0 <= distance <= self.length or self.length == 0.0:
            return None
        index = int(np.searchsorted(self._ends, distance))
        length = self._lengths[index]
        share = 1.0 - (self._ends[index] - distance) / length if length > 0.0 else 0.0
        x, y = self._starts[index] + share * self._moves[index]
        u, v = (1.0 - share) * self._before[index] + share * self._after[index]
        norm = float(np.sqrt(u * u + v * v))
        cos, sin = (float(u) / norm, float(v) / norm) if norm > 0.0 else (1.0, 0.0)
        return (cos, sin, -sin, cos, float(x), float(y))


def _chords(
    outline: Outline, matrix: Matrix
) -> tuple[_FloatArray, _FloatArray, _FloatArray, _FloatArray]:
    """Returns starts and ends of all chords, and the curve's directions at both."""
    count = sum(1 for kind, _ in outline.segments() if kind in "QCW")
    steps = max(8, min(_STEPS, _MAX_STEPS // max(count, 1)))
    turn, move = np.array(matrix[:4]).reshape(2, 2), np.array(matrix[4:])
    curves: list[tuple[_FloatArray, _FloatArray]] = []
    current = start = np.zeros(2)
    for kind, numbers in outline.segments():
        if kind == "M":
            current = start = _rotate(np.array(numbers), turn) + move
            continue
        weight = numbers[2] if kind == "W" else 1.0
        values = numbers[:2] + numbers[3:] if kind == "W" else numbers
        inner = _rotate(np.array(values).reshape(-1, 2), turn) + move if values else start[None]
        controls = np.concatenate([current[None], inner])
        if kind in "LZ":
            points, slopes = controls, np.repeat(controls[1:] - controls[:1], 2, axis=0)
        else:
            points, slopes = _samples(controls, weight, np.linspace(0.0, 1.0, steps + 1))
        curves.append((points, slopes))
        current = controls[-1]
    if not curves:
        nothing = np.zeros((0, 2))
        return nothing, nothing, nothing, nothing
    starts = np.concatenate([points[:-1] for points, _ in curves])
    ends = np.concatenate([points[1:] for points, _ in curves])
    before = np.concatenate([_units(slopes)[:-1] for _, slopes in curves])
    after = np.concatenate([_units(slopes)[1:] for _, slopes in curves])
    return starts, ends, before, after


def _samples(
    controls: _FloatArray, weight: float, t: _FloatArray
) -> tuple[_FloatArray, _FloatArray]:
    """Returns points of a curve, and its derivatives up to a positive factor."""
    t = t[:, None]
    s = 1.0 - t
    p = controls
    if len(p) == 4:
        points = (
            s * s * s * p[0] + 3.0 * s * s * t * p[1] + 3.0 * s * t * t * p[2] + t * t * t * p[3]
        )
        slopes = s * s * (p[1] - p[0]) + 2.0 * s * t * (p[2] - p[1]) + t * t * (p[3] - p[2])
    else:
        total = s * s + 2.0 * weight * s * t + t * t
        points = (s * s * p[0] + 2.0 * weight * s * t * p[1] + t * t * p[2]) / total
        slopes = (
            s * s * weight * (p[1] - p[0]) + s * t * (p[2] - p[0]) + t * t * weight * (p[2] - p[1])
        )
    # Where control points coincide, the direction is that of the adjacent chord.
    still = (slopes * slopes).sum(axis=1) == 0.0
    if still.any():
        chords = np.diff(points, axis=0)
        slopes = np.where(still[:, None], np.concatenate([chords, chords[-1:]]), slopes)
    return points, slopes


def _units(slopes: _FloatArray) -> _FloatArray:
    lengths = np.sqrt((slopes * slopes).sum(axis=1, keepdims=True))
    return slopes / np.where(lengths > 0.0, lengths, 1.0)
