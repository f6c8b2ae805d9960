# SPDX-License-Identifier: GPL-3.0-or-later

"""Clouds of points before they become a surface: fewer, without outliers, on top of each other."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    ProgressCallback,
    as_int,
    as_number,
    as_one_of,
    as_progress,
    progress_part,
)
from .._border.arrays import as_floats, as_threads
from .._border.names import Against
from .alignment import Prepared, ScanAlignment, SurfaceRounds
from .normals import estimate_normals
from .repairs import has_enough
from .scan import ScanPoints

SUBSAMPLING = _native.SUBSAMPLING
SCANS, SURFACE = "scans", "surface"
AGAINST = (SCANS, SURFACE)
"""What scans are aligned to."""


def subsample_points(
    points: npt.ArrayLike,
    spacing: float,
    *,
    method: str = "poisson",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.int64]:
    """Which points to keep so that they are spread evenly.

    Args:
        points: (points, 3).
        spacing: How far apart they are to be, above 0.
        method: "poisson": none are nearer to each other than the spacing, and each other point is
            nearer than that to one that is kept. "grid": one of each cell of a grid, as wide as the
            spacing: the one that is nearest to the mean of those in it.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        Indices, ascending. Points that hold a value that is not finite or above 1e150 are left out,
        and of points at one position all but the first.

    Raises:
        ValueError: A shape or type is wrong, or a value is not allowed.
        Cancelled: `progress` returned False.
    """
    return _native.subsample(
        as_floats("points", points, ("points", 3), np.float64),
        as_number("spacing", spacing),
        as_one_of("method", method, SUBSAMPLING),
        as_progress(progress),
        as_threads(threads),
    )


def find_outliers(
    points: npt.ArrayLike,
    *,
    neighbours: int = 16,
    factor: float = 2.0,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.bool_]:
    """Which points lie by themselves, such as those that a scanner saw in the air.

    The mean distance of a point to those around it is compared with theirs, not with that of the
    whole cloud: parts that were scanned sparsely are no outliers.

    Args:
        points: (points, 3).
        neighbours: How many points around each count, 3 to 1000: more than twice as many as there
            are in a clump that is to go.
        factor: How many times as far from them a point is, at the least, as the median of them is
            from those around it: above 1. Lower values find more.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (points,) bool. Points that hold a value that is not finite or above 1e150 are outliers.

    Raises:
        ValueError: A shape or type is wrong, or a value is not allowed.
        Cancelled: `progress` returned False.
    """
    return _native.find_outliers(
        as_floats("points", points, ("points", 3), np.float64),
        as_int("neighbours", neighbours, "a whole number from 3 to 1000 is needed"),
        as_number("factor", factor),
        as_progress(progress),
        as_threads(threads),
    )


def align_scans(
    scans: Sequence[ScanPoints],
    *,
    against: Against = "scans",
    reach: float | None = None,
    iterations: int = 40,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> ScanAlignment:
    """Small motions by which scans of one thing that are nearly in place fit each other.

    All scans but the first move, so that points of each are in the planes of those of all others
    nearest to them. Points that fit nowhere count less, and those that only one scan has do not
    count.

    Args:
        scans: Two or more. Normals are estimated where a scan has none, or hardly any.
        against: "scans": that is all. "surface": then a surface of all that overlap is made, each
            is moved onto that by itself, and the same once more. That averages the noise of all.
        reach: How far what belongs together may be apart. None: a 20th of the diagonal of the box
            of all scans.
        iterations: At the most, 1 to 1000.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: There are fewer than two scans, or a value is not allowed.
        Cancelled: `progress` returned False.
    """
    if not all(isinstance(scan, ScanPoints) for scan in scans):
        raise ValueError("scans: a list of ScanPoints is needed")
    prepared = []
    for k, scan in enumerate(scans):
        part = progress_part(progress, 0.4 * k / len(scans), 0.4 * (k + 1) / len(scans))
        prepared.append(_with_normals(scan, part, threads))
    is_to_surface = as_one_of("against", against, AGAINST) == SURFACE
    most = None if reach is None else as_number("reach", reach)
    count = as_int("iterations", iterations, "a whole number from 1 to 1000 is needed")
    between = 0.55 if is_to_surface else 1.0
    found = ScanAlignment.of(
        _native.align_scans(
            prepared, most, count, progress_part(progress, 0.4, between), as_threads(threads)
        )
    )
    if not is_to_surface:
        return found
    rounds = SurfaceRounds(scans, prepared, most, count, threads)
    return rounds.run(found, progress_part(progress, between, 1.0))


def _with_normals(scan: ScanPoints, progress: ProgressCallback | None, threads: int) -> Prepared:
    positions = as_floats("positions", scan.positions, ("points", 3), np.float64)
    if scan.normals is not None and (len(positions) == 0 or has_enough(scan.normals)):
        return positions, as_floats("normals", scan.normals, ("points", 3), np.float64)
    if len(positions) == 0:
        return positions, np.empty((0, 3))
    return positions, estimate_normals(positions, progress=progress, threads=threads)
