# SPDX-License-Identifier: GPL-3.0-or-later

"""Given normals that are missing or contradict each other, and work that is done again then."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress, progress_part
from .._border.arrays import as_threads

MISSING, CONTRADICTORY = "missing", "contradictory"
"""What may be wrong with given normals."""

_NEIGHBORS = 16
_LEAST_GIVEN = 0.01
"""The share of points whose normals say where those of the others point."""
_SAME_AXIS = 0.5
"""Cosine between a given normal and an estimated one, from which on the given one is used."""

Normals = npt.NDArray[np.float64]
Made = TypeVar("Made")


def run_until_sound(
    run: Callable[[frozenset[str], bool, ProgressCallback | None], tuple[Made, Mapping[str, Any]]],
    progress: ProgressCallback | None,
) -> Made:
    """Does work, and again where the library finds a fault in the normals.

    Args:
        run: Takes the faults that are known, whether to look for more, and what to tell of the
            progress; returns its result, and what the library has found.
        progress: Called with the fraction done.
    """
    faults: frozenset[str] = frozenset()
    done = 0.0
    progress = as_progress(progress)
    while True:
        last = done

        def tell(share: float, last: float = last) -> bool | None:
            nonlocal done
            done = last + (1.0 - last) * share
            return None if progress is None else progress(done)

        # One fault may hide the other, and each is repaired once.
        made, found = run(faults, len(faults) < 2, None if progress is None else tell)
        fault = found["normal_fault"]
        if not fault:
            return made
        if fault in faults:
            return run(faults, False, progress_part(progress, done, 1.0))[0]
        faults |= {fault}


def lacking(normals: npt.NDArray[np.floating]) -> npt.NDArray[np.bool_]:
    """Which normals have no direction."""
    largest = np.abs(normals).max(axis=1, initial=0.0)
    return np.asarray(~(np.isfinite(largest) & (largest > 0.0)))


def has_enough(normals: npt.NDArray[np.floating]) -> bool:
    """Whether enough points have a normal, so that those of the others follow from them."""
    return bool(np.count_nonzero(~lacking(normals)) > _LEAST_GIVEN * len(normals))


def completed(
    points: npt.NDArray[np.floating],
    normals: npt.NDArray[np.floating],
    progress: ProgressCallback | None,
    threads: int,
) -> Normals:
    """The normals, and where they have no direction those that the points around say."""
    return _native.completed_normals(
        np.ascontiguousarray(points, np.float64),
        np.ascontiguousarray(normals, np.float64),
        _NEIGHBORS,
        as_progress(progress),
        as_threads(threads),
    )


def reoriented(given: npt.NDArray[np.floating], estimated: Normals) -> Normals:
    """Given normals as estimated ones point; and these, where the given ones are others."""
    with np.errstate(all="ignore"):
        wide = given.astype(np.float64)
        axes = wide / np.abs(wide).max(axis=1, keepdims=True)
        axes /= np.sqrt(np.square(axes).sum(axis=1, keepdims=True))
        cosines = (axes * estimated).sum(axis=1, keepdims=True)
    return np.where(np.abs(cosines) > _SAME_AXIS, np.sign(cosines) * axes, estimated)
