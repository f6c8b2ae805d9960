# SPDX-License-Identifier: GPL-3.0-or-later

"""Repair of given normals that are missing or contradict each other."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress, progress_part
from .._border.arrays import as_threads

MISSING, CONTRADICTORY = "missing", "contradictory"
"""Faults of given normals."""

_NEIGHBORS = 16
_MIN_GIVEN_SHARE = 0.01
"""Share of points with normals above which the others' normals are derived from them."""
_SAME_AXIS_MIN_COSINE = 0.5
"""Cosine between a given and an estimated normal above which the given axis is kept."""

Normals = npt.NDArray[np.float64]
Result = TypeVar("Result")


def run_with_repairs(
    run: Callable[
        [frozenset[str], bool, ProgressCallback | None], tuple[Result, Mapping[str, Any]]
    ],
    progress: ProgressCallback | None,
) -> Result:
    """Runs a reconstruction, again with repaired normals for each fault that is found in them.

    Args:
        run: Takes the faults known so far, whether to look for others, and a progress callback;
            returns its result and the findings of the native module.
        progress: Called with the fraction done.
    """
    faults: frozenset[str] = frozenset()
    done = 0.0
    progress = as_progress(progress)
    while True:
        last = done

        def report(share: float, last: float = last) -> bool | None:
            nonlocal done
            done = last + (1.0 - last) * share
            return None if progress is None else progress(done)

        # One fault may hide the other, and each is repaired once.
        result, findings = run(faults, len(faults) < 2, None if progress is None else report)
        fault = findings["normal_fault"]
        if not fault:
            return result
        if fault in faults:
            return run(faults, False, progress_part(progress, done, 1.0))[0]
        faults |= {fault}


def without_direction(normals: npt.NDArray[np.floating]) -> npt.NDArray[np.bool_]:
    """Mask of the normals that are zero or not finite."""
    largest = np.abs(normals).max(axis=1, initial=0.0)
    return np.asarray(~(np.isfinite(largest) & (largest > 0.0)))


def has_enough_normals(normals: npt.NDArray[np.floating]) -> bool:
    """Whether enough points have a normal to derive those of the others from."""
    return bool(np.count_nonzero(~without_direction(normals)) > _MIN_GIVEN_SHARE * len(normals))


def complete_normals(
    points: npt.NDArray[np.floating],
    normals: npt.NDArray[np.floating],
    progress: ProgressCallback | None,
    threads: int,
) -> Normals:
    """Replaces normals without a direction by those that follow from neighboring points."""
    return _native.completed_normals(
        np.ascontiguousarray(points, np.float64),
        np.ascontiguousarray(normals, np.float64),
        _NEIGHBORS,
        as_progress(progress),
        as_threads(threads),
    )


def reorient_normals(given: npt.NDArray[np.floating], estimated: Normals) -> Normals:
    """Given normals on the side of the estimated ones; estimated ones where the axes disagree."""
    with np.errstate(all="ignore"):
        wide = given.astype(np.float64)
        axes = wide / np.abs(wide).max(axis=1, keepdims=True)
        axes /= np.sqrt(np.square(axes).sum(axis=1, keepdims=True))
        cosines = (axes * estimated).sum(axis=1, keepdims=True)
    return np.where(np.abs(cosines) > _SAME_AXIS_MIN_COSINE, np.sign(cosines) * axes, estimated)
