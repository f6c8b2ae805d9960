# SPDX-License-Identifier: GPL-3.0-or-later

"""Preparation of point clouds: subsampling, removal of outliers, alignment."""

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
from .repairs import has_enough_normals
from .scan import ScanPoints

SUBSAMPLING = _native.SUBSAMPLING
SCANS, SURFACE = "scans", "surface"
AGAINST = (SCANS, SURFACE)
"""Targets of the alignment of scans."""


def subsample_points(
    points: npt.ArrayLike,
    spacing: float,
    *,
    method: str = "poisson",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.int64]:
    """Chooses evenly spread points.

    Args:
        points: (points, 3).
        spacing: Distance between chosen points, above 0.
        method: "poisson": no two chosen points are nearer to each other than the spacing, and every
            other point is nearer than that to a chosen one. "grid": one point per cell of a grid,
            as wide as the spacing: the point nearest to the mean of the cell's points.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        Ascending indices of the chosen points. Points with a value that is not finite or above
        1e150 are left out, and so are all but the first of points at one position.

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
    """Finds isolated points, such as those that a scanner saw in the air.

    A point's mean distance to its neighbors is compared with that of the neighbors, not with that
    of the whole cloud: sparsely scanned parts are no outliers.

    Args:
        points: (points, 3).
        neighbours: Number of neighbors compared, 3 to 1000: more than twice as many as a clump of
            outliers has points.
        factor: Ratio of a point's mean distance to the median of its neighbors' from which on it is
            an outlier: above 1. Lower values find more.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        (points,) bool. Points with a value that is not finite or above 1e150 are outliers.

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
    """Finds small motions that align scans of one object that are nearly in place.

    All scans but the first move, so that their points lie in the planes of the nearest points of
    all other scans. Points that fit badly count less; points seen by one scan only do not count.

    Args:
        scans: Two or more. Normals are estimated where a scan has none, or hardly any.
        against: "scans": scans are aligned to each other only. "surface": then a surface of all
            overlapping scans is made and each is aligned to it, twice. That averages the noise of
            all.
        reach: Greatest distance between corresponding points. None: a 20th of the diagonal of the
            box of all scans.
        iterations: Greatest number of iterations, 1 to 1000.
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
    distance = None if reach is None else as_number("reach", reach)
    count = as_int("iterations", iterations, "a whole number from 1 to 1000 is needed")
    end = 0.55 if is_to_surface else 1.0
    alignment = ScanAlignment.of(
        _native.align_scans(
            prepared, distance, count, progress_part(progress, 0.4, end), as_threads(threads)
        )
    )
    if not is_to_surface:
        return alignment
    rounds = SurfaceRounds(scans, prepared, distance, count, threads)
    return rounds.run(alignment, progress_part(progress, end, 1.0))


def _with_normals(scan: ScanPoints, progress: ProgressCallback | None, threads: int) -> Prepared:
    positions = as_floats("positions", scan.positions, ("points", 3), np.float64)
    if scan.normals is not None and (len(positions) == 0 or has_enough_normals(scan.normals)):
        return positions, as_floats("normals", scan.normals, ("points", 3), np.float64)
    if len(positions) == 0:
        return positions, np.empty((0, 3))
    return positions, estimate_normals(positions, progress=progress, threads=threads)
