# SPDX-License-Identifier: GPL-3.0-or-later

"""Directions of normals: the user's choice, and the automatic one."""

from dataclasses import dataclass
from typing import Any, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_one_of, progress_part
from .._border.arrays import as_threads
from .normals import as_viewpoints, estimate_normals, guess_direction, mask_unseen

Viewpoints: TypeAlias = npt.NDArray[np.float64]

AUTO, UP, VIEWPOINT, OUTWARD, GIVEN = "auto", "up", "viewpoint", "outward", "given"
DIRECTIONS = (AUTO, UP, VIEWPOINT, OUTWARD, GIVEN)


@dataclass(frozen=True, eq=False)
class Orientation:
    """The user's choice of where normals point.

    Attributes:
        direction: One of DIRECTIONS.
        viewpoints: Positions of scanners, (n, 3): one for all, or several; (0, 3) if not given.
    """

    direction: str
    viewpoints: Viewpoints

    def for_given_normals(self) -> str:
        """Direction for normals that points have: kept unless the user chose a direction."""
        return GIVEN if self.direction == AUTO else self.direction

    def for_file_normals(self, usual: str) -> str:
        """Direction for normals from a scanner's grid or faces; `usual` if the user chose none."""
        return usual if self.direction in (AUTO, GIVEN) else self.direction

    def for_missing_normals(
        self,
        rows: npt.NDArray[np.floating],
        has_viewpoint: bool,
        is_from_above: bool,
        progress: ProgressCallback | None,
        threads: int,
    ) -> tuple[str, str]:
        """Direction for normals to be estimated, and role of the origin; see `guess_direction`.

        Raises:
            ValueError: The user chose given normals.
            Cancelled: `progress` returned False.
        """
        if self.direction == GIVEN:
            raise ValueError(
                "direction: 'given', but there are points without normals; use another direction, "
                "or points with normals"
            )
        if self.direction != AUTO:
            return self.direction, "none"
        if has_viewpoint:
            return VIEWPOINT, "none"
        if is_from_above:
            return UP, "none"
        used = as_threads(threads)
        seen = mask_unseen(np.asarray(rows, np.float64), progress_part(progress, 0.0, 0.3), used)
        return guess_direction(seen, progress_part(progress, 0.3, 1.0), used)


def as_orientation(direction: str, viewpoint: npt.ArrayLike | None) -> Orientation:
    """Checks the user's choice.

    Raises:
        ValueError: The direction is unknown; the viewpoint has a wrong shape or type, or does not
            go with the direction.
    """
    chosen = as_one_of("direction", direction, DIRECTIONS)
    viewpoints = as_viewpoints(viewpoint)
    if len(viewpoints) and chosen not in (AUTO, VIEWPOINT):
        raise ValueError(
            f"viewpoint: given beside the direction '{chosen}'; 'viewpoint' is needed, or no "
            "viewpoint"
        )
    return Orientation(VIEWPOINT if len(viewpoints) else chosen, viewpoints)


def orient_points(
    points: _native.PointSource, direction: str, viewpoints: Viewpoints
) -> _native.PointSource:
    """Points whose normals are oriented where each normal can be oriented by itself."""
    if direction in (UP, VIEWPOINT):
        return _native.TurnedPoints(points, direction == UP, viewpoints)
    return points


def estimate_directed(
    rows: npt.NDArray[np.floating],
    direction: str,
    viewpoints: Viewpoints,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float64]:
    """Estimates normals with a direction; "viewpoint" without viewpoints means the origin."""
    if direction == VIEWPOINT:
        seen_from = viewpoints if len(viewpoints) else np.zeros((1, 3))
        return estimate_normals(rows, viewpoint=seen_from, progress=progress, threads=threads)
    return estimate_normals(
        rows, direction=cast("Any", direction), progress=progress, threads=threads
    )
