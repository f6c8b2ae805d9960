# SPDX-License-Identifier: GPL-3.0-or-later

"""Geometry of dragged corners, in the image and in the editor.

Positions are in pixels, of the image from its lower left corner, or of the editor's region.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from prefilter.workflows.images.placement import (
    Matrix,
    corners,
    frame,
    homography,
    moved,
    rectangle,
)

from .choices import CORNERS, ResampleSettings

REACH = 14.0
"""Largest distance of a press from the corner that it grabs, in region pixels at a scale of 1."""
GRID = 4
"""Number of grid cells along each side."""

_SLOWNESS = 0.1
_SNAP = 8.0  # Largest distance of an edge to snap to, in region pixels.
_START = (0.2, 0.8)
"""Initial position of corners that are at the corners of the image, as shares of its sides."""


@dataclass(frozen=True)
class Canvas:
    """The position of an image in the region of an editor.

    Attributes:
        origin: The lower left corner of the image in the region.
        scale: The width and height of an image pixel in the region.
    """

    origin: tuple[float, float]
    scale: tuple[float, float]

    def to_region(self, points: ArrayLike) -> NDArray[np.float64]:
        """Converts image positions to region positions."""
        return np.asarray(points, np.float64) * self.scale + self.origin

    def to_image(self, points: ArrayLike) -> NDArray[np.float64]:
        """Converts region positions to image positions."""
        return (np.asarray(points, np.float64) - self.origin) / self.scale


class Drag:
    """A corner that follows the mouse."""

    def __init__(self, corner: ArrayLike, mouse: ArrayLike) -> None:
        """Stores the corner's position in the image, and the mouse's in the region."""
        self._corner = np.array(corner, np.float64)
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
        """Returns the new position of the corner in the image.

        Args:
            mouse: The position of the mouse in the region.
            canvas: The position of the image.
            edges: The width and height of the frame whose edges attract the corner.
            is_slow: Whether the corner moves a tenth as far as the mouse.
            snaps: Whether it snaps to whole pixels, and to edges nearby.
        """
        step = (np.asarray(mouse, np.float64) - self._mouse) / canvas.scale
        self._mouse = np.array(mouse, np.float64)
        self._corner += step * (_SLOWNESS if is_slow else 1.0)
        return snapped(self._corner, canvas, edges) if snaps else self._corner.copy()


def snapped(point: ArrayLike, canvas: Canvas, edges: tuple[int, int]) -> NDArray[np.float64]:
    """Returns the nearest whole pixel, or a nearby edge of the frame from (0, 0) to `edges`."""
    result = np.rint(np.asarray(point, np.float64))
    for axis, high in enumerate(edges):
        for edge in (0.0, float(high)):
            if abs(result[axis] - edge) * canvas.scale[axis] <= _SNAP:
                result[axis] = edge
    return result


def nearest(points: ArrayLike, canvas: Canvas, mouse: ArrayLike, reach: float) -> int | None:
    """Returns the index of the corner nearest to the mouse; None if none is in reach."""
    distances = np.linalg.norm(canvas.to_region(points) - np.asarray(mouse, np.float64), axis=1)
    index = int(np.argmin(distances))
    return index if distances[index] <= reach else None


def shares(
    point: ArrayLike, settings: ResampleSettings, size: tuple[int, int]
) -> tuple[float, ...]:
    """Converts a position in pixels to the relative position that the settings store."""
    return tuple(float(x) for x in np.asarray(point, np.float64) / frame(settings, *size))


def initial_changes(settings: ResampleSettings) -> dict[str, object]:
    """Returns settings to change before dragging, so that there is a warp with visible corners."""
    changed: dict[str, object] = {}
    if settings.warp == "affine":
        changed["warp"] = "rectify"
    whole = rectangle(1.0, 1.0)
    if settings.warp != "corners" and np.array_equal(corners(settings, 1, 1), whole):
        low, high = _START
        for name, corner in zip(CORNERS, low + whole * (high - low), strict=True):
            changed[name] = tuple(corner.tolist())
    return changed


def grid(points: ArrayLike) -> NDArray[np.float64]:
    """Returns the lines of a grid in perspective between four corners: (n, 2, 2) end points.

    Raises:
        ValueError: The corners do not form a convex quadrilateral.
    """
    transform = homography(rectangle(1.0, 1.0), points)
    steps = np.arange(1, GRID) / GRID
    ends = [((x, 0.0), (x, 1.0)) for x in steps] + [((0.0, y), (1.0, y)) for y in steps]
    flat = np.array(ends).reshape(-1, 2)
    rows = flat @ transform[:, :2].T + transform[:, 2]
    return (rows[:, :2] / rows[:, 2:]).reshape(-1, 2, 2)


def uv_of_box(
    transform: Matrix, low: ArrayLike, extent: ArrayLike, size: tuple[int, int]
) -> Matrix:
    """Returns the transform from a box, [0, 1]^2 from its lower left corner, to UVs of an image.

    Args:
        transform: The transform from positions to pixels of the image.
        low: The position of the box's lower left corner.
        extent: The width and height of the box.
        size: The width and height of the image.
    """
    x, y = np.asarray(low, np.float64)
    to_positions = moved(x, y) @ np.diag([*np.asarray(extent, np.float64), 1.0])
    return np.diag([1.0 / size[0], 1.0 / size[1], 1.0]) @ transform @ to_positions
