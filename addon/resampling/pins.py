# SPDX-License-Identifier: GPL-3.0-or-later

"""Corners that are dragged: where they are in an editor, and where they go.

A place is in pixels, of the image from its lower left corner, or of the editor's region.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from prefilter.workflows.resampling.placement import (
    Matrix,
    corners,
    frame,
    homography,
    moved,
    rectangle,
)

from .choices import CORNERS, ResampleSettings

REACH = 14.0
"""How far from a corner a press takes it, in pixels of the region at a scale of 1."""
GRID = 4
"""How many parts the grid has along each side."""

_SLOWNESS = 0.1
_SNAP = 8.0  # How near an edge has to be, in pixels of the region.
_START = (0.2, 0.8)
"""Where corners start that are those of the whole image, as shares: there they are in sight."""


@dataclass(frozen=True)
class Canvas:
    """Where an editor shows an image.

    Attributes:
        origin: The lower left corner of the image in the region.
        scale: How wide and high a pixel of the image is there.
    """

    origin: tuple[float, float]
    scale: tuple[float, float]

    def to_region(self, places: ArrayLike) -> NDArray[np.float64]:
        """Returns where places of the image are in the region."""
        return np.asarray(places, np.float64) * self.scale + self.origin

    def to_image(self, places: ArrayLike) -> NDArray[np.float64]:
        """Returns which places of the image are there."""
        return (np.asarray(places, np.float64) - self.origin) / self.scale


class Drag:
    """A corner that follows the mouse."""

    def __init__(self, place: ArrayLike, mouse: ArrayLike) -> None:
        """Takes where the corner is in the image, and the mouse in the region."""
        self._place = np.array(place, np.float64)
        self._mouse = np.array(mouse, np.float64)

    def to(
        self,
        mouse: ArrayLike,
        canvas: Canvas,
        edges: tuple[int, int],
        *,
        is_slow: bool = False,
        snaps: bool = False,
    ) -> NDArray[np.float64]:
        """Returns where the corner then is in the image.

        Args:
            mouse: Where the mouse is in the region.
            canvas: Where the image is.
            edges: The width and height of what has the edges to snap to.
            is_slow: Whether it moves a tenth as far as the mouse.
            snaps: Whether it goes to the nearest whole pixel, or to an edge nearby.
        """
        step = (np.asarray(mouse, np.float64) - self._mouse) / canvas.scale
        self._mouse = np.array(mouse, np.float64)
        self._place += step * (_SLOWNESS if is_slow else 1.0)
        return snapped(self._place, canvas, edges) if snaps else self._place.copy()


def snapped(place: ArrayLike, canvas: Canvas, edges: tuple[int, int]) -> NDArray[np.float64]:
    """Returns the nearest whole pixel, or the edge of (0, 0) to `edges` that is near."""
    found = np.rint(np.asarray(place, np.float64))
    for axis, edge in enumerate(edges):
        for at in (0.0, float(edge)):
            if abs(found[axis] - at) * canvas.scale[axis] <= _SNAP:
                found[axis] = at
    return found


def nearest(places: ArrayLike, canvas: Canvas, mouse: ArrayLike, reach: float) -> int | None:
    """Returns the number of the corner that is nearest to the mouse; None if none is in reach."""
    far = np.linalg.norm(canvas.to_region(places) - np.asarray(mouse, np.float64), axis=1)
    index = int(np.argmin(far))
    return index if far[index] <= reach else None


def shares(
    place: ArrayLike, settings: ResampleSettings, size: tuple[int, int]
) -> tuple[float, ...]:
    """Returns a place in pixels as the settings keep it, for an image of a size."""
    return tuple(float(one) for one in np.asarray(place, np.float64) / frame(settings, *size))


def begun(settings: ResampleSettings) -> dict[str, object]:
    """Returns what to set before corners are dragged: the warp, and corners that are in sight."""
    changed: dict[str, object] = {}
    if settings.warp == "affine":
        changed["warp"] = "rectify"
    whole = rectangle(1.0, 1.0)
    if settings.warp != "corners" and np.array_equal(corners(settings, 1, 1), whole):
        low, high = _START
        for name, place in zip(CORNERS, low + whole * (high - low), strict=True):
            changed[name] = tuple(place.tolist())
    return changed


def grid(places: ArrayLike) -> NDArray[np.float64]:
    """Returns the lines of a grid in perspective between four corners: (n, 2, 2) ends.

    Raises:
        ValueError: The corners are not around a convex quadrilateral.
    """
    transform = homography(rectangle(1.0, 1.0), places)
    at = np.arange(1, GRID) / GRID
    ends = [((x, 0.0), (x, 1.0)) for x in at] + [((0.0, y), (1.0, y)) for y in at]
    flat = np.array(ends).reshape(-1, 2)
    rows = flat @ transform[:, :2].T + transform[:, 2]
    return (rows[:, :2] / rows[:, 2:]).reshape(-1, 2, 2)


def uv_of_box(
    transform: Matrix, low: ArrayLike, extent: ArrayLike, size: tuple[int, int]
) -> Matrix:
    """Returns the transform from a box, [0, 1]^2 from its lower left corner, to UVs of an image.

    Args:
        transform: From places to pixels of the image.
        low: The place of the box's lower left corner.
        extent: Its width and height.
        size: The width and height of the image.
    """
    x, y = np.asarray(low, np.float64)
    to_places = moved(x, y) @ np.diag([*np.asarray(extent, np.float64), 1.0])
    return np.diag([1.0 / size[0], 1.0 / size[1], 1.0]) @ transform @ to_places
