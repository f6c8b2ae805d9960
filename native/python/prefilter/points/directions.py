# SPDX-License-Identifier: GPL-3.0-or-later

"""Which way the normals of points point: as users ask for, and where they leave it open."""

from dataclasses import dataclass
from typing import Any, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_one_of, progress_part
from .._border.arrays import as_threads
from .normals import as_viewpoints, estimate_normals, seen_points, side_of

Viewpoints: TypeAlias = npt.NDArray[np.float64]

AUTO, UP, VIEWPOINT, OUTWARD, GIVEN = "auto", "up", "viewpoint", "outward", "given"
DIRECTIONS = (AUTO, UP, VIEWPOINT, OUTWARD, GIVEN)


@dataclass(frozen=True, eq=False)
class Wanted:
    """What a user asks for.

    Attributes:
        direction: One of DIRECTIONS.
        viewpoints: Where scanners stood, (n, 3): one for all or several; (0, 3) where the user does
            not say.
    """

    direction: str
    viewpoints: Viewpoints

    def of_given(self) -> str:
        """The direction of normals that points have: as they are, unless the user asks for one."""
        return GIVEN if self.direction == AUTO else self.direction

    def told(self, usual: str) -> str:
        """The direction of normals that a scanner's grid or faces tell, which usually is known."""
        return usual if self.direction in (AUTO, GIVEN) else self.direction

    def of_missing(
        self,
        rows: npt.NDArray[np.floating],
        has_viewpoint: bool,
        is_from_above: bool,
        progress: ProgressCallback | None,
        threads: int,
    ) -> tuple[str, str]:
        """The direction of normals that are to be estimated, and what the origin is; see `side_of`.

        Raises:
            ValueError: The user asks for them as given.
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
        seen = seen_points(np.asarray(rows, np.float64), progress_part(progress, 0.0, 0.3), used)
        return side_of(seen, progress_part(progress, 0.3, 1.0), used)


def as_wanted(direction: str, viewpoint: npt.ArrayLike | None) -> Wanted:
    """Checks what a user asks for.

    Raises:
        ValueError: There is no such direction, or a viewpoint is of a wrong shape or type, or
            beside a direction that has no use for one.
    """
    chosen = as_one_of("direction", direction, DIRECTIONS)
    viewpoints = as_viewpoints(viewpoint)
    if len(viewpoints) and chosen not in (AUTO, VIEWPOINT):
        raise ValueError(
            f"viewpoint: given beside the direction '{chosen}'; 'viewpoint' is needed, or no "
            "viewpoint"
        )
    return Wanted(VIEWPOINT if len(viewpoints) else chosen, viewpoints)


def turned(
    points: _native.PointSource, direction: str, viewpoints: Viewpoints
) -> _native.PointSource:
    """Points whose own normals have a direction, as far as each can be turned by itself."""
    if direction in (UP, VIEWPOINT):
        return _native.TurnedPoints(points, direction == UP, viewpoints)
    return points


def estimated(
    rows: npt.NDArray[np.floating],
    direction: str,
    viewpoints: Viewpoints,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float64]:
    """Normals that have a direction; toward the origin where no viewpoint is known."""
    if direction == VIEWPOINT:
        seen_from = viewpoints if len(viewpoints) else np.zeros((1, 3))
        return estimate_normals(rows, viewpoint=seen_from, progress=progress, threads=threads)
    return estimate_normals(
        rows, direction=cast("Any", direction), progress=progress, threads=threads
    )


def parts(progress: ProgressCallback | None) -> tuple[ProgressCallback | None, ...]:
    """Those of finding a direction, and of estimating normals."""
    return progress_part(progress, 0.0, 0.05), progress_part(progress, 0.05, 1.0)
