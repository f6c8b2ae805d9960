# SPDX-License-Identifier: GPL-3.0-or-later

"""Placement of an image in its result: projective transforms of pixel coordinates.

A point (x, y) of an image is in pixels from its lower left corner, with y upwards. A transform is a
3 x 3 matrix that maps (x, y, 1) to a multiple of (x', y', 1).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import _native
from ...options.images import CORNERS, LONGEST_SIDE, ResampleSettings
from ..matrices import inverse, product
from .perspective import proportions

Matrix = NDArray[np.float64]

_ROUNDING = 1e-6  # Rounding tolerance of extents above a whole number, in pixels.
_PLACES = 16  # Samples along x and y for a mean over the result.
_FLATTEST = 1e-9  # Least twice the area at a corner / the square of the longest side.


@dataclass(frozen=True)
class Placement:
    """The size of a result, and the transform from it to the image.

    Attributes:
        transform: Maps pixels of the result to those of the image; the factor of (x', y', 1) is
            positive on the image's side of the horizon.
        width: Width of the result in pixels.
        height: Height of the result in pixels.
    """

    transform: Matrix
    width: int
    height: int


def placement(settings: ResampleSettings, width: int, height: int) -> Placement:
    """Returns the placement of an image of this size.

    Raises:
        ValueError: The settings make it flat, fold it, or make it too large.
    """
    if settings.warp == "rectify":
        return _rectified(settings, width, height)
    if settings.warp == "corners":
        forward = homography(rectangle(width, height), corners(settings, width, height))
    else:
        forward = scaled_and_rotated(settings.scale_x, settings.scale_y, settings.rotation)
        forward = product(forward, moved(-width / 2, -height / 2))
    if settings.size == "fit":
        return _fitted(forward, width, height)
    new_width, new_height = _size(settings, width, height)
    if settings.warp == "affine":
        center = (new_width / 2 + settings.offset_x, new_height / 2 + settings.offset_y)
        forward = product(moved(*center), forward)
    return Placement(inverse(forward), new_width, new_height)


def frame(settings: ResampleSettings, width: int, height: int) -> tuple[int, int]:
    """Returns the size that corners are relative to: that of the image, or of the result."""
    if settings.warp == "rectify" or settings.size == "fit":
        return width, height
    return _size(settings, width, height)


def corners(settings: ResampleSettings, width: int, height: int) -> NDArray[np.float64]:
    """Returns the four corners in pixels, for an image of this size: (4, 2)."""
    points = np.array([getattr(settings, name) for name in CORNERS], np.float64)
    return points if settings.use_pixels else points * frame(settings, width, height)


def knows_proportions(settings: ResampleSettings, width: int, height: int) -> bool:
    """Returns whether the settings determine the proportions of the rectified area.

    They do not if the perspective is needed but inconclusive; a usual lens is then assumed.

    Raises:
        ValueError: The corners are not around a convex quadrilateral.
    """
    if (settings.warp, settings.size, settings.proportions) != ("rectify", "fit", "perspective"):
        return True
    places = corners(settings, width, height)
    check_convex(places)
    return proportions(places, width, height).is_certain


def rectangle(width: float, height: float) -> NDArray[np.float64]:
    """Returns the corners of a rectangle at (0, 0), in the order of `CORNERS`."""
    return np.array([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])


def moved(x: float, y: float) -> Matrix:
    """Returns the transform that translates."""
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])


def scaled_and_rotated(scale_x: float, scale_y: float, angle: float) -> Matrix:
    """Returns the transform that scales along x and y, and then rotates counterclockwise.

    Args:
        scale_x: The factor along x; negative factors mirror.
        scale_y: The factor along y.
        angle: Radians; quarter turns are exact.

    Raises:
        ValueError: A factor is 0.
    """
    for label, scale in (("Scale X", scale_x), ("Scale Y", scale_y)):
        if scale == 0.0:
            raise ValueError(f"{label}: found 0; the image would vanish")
    cosine, sine = _native.cos(angle), _native.sin(angle)
    quarters = angle / (math.pi / 2)
    # Blender stores angles in single precision.
    if math.isclose(quarters, round(quarters), rel_tol=1e-6, abs_tol=1e-6):
        cosine, sine = float(round(cosine)), float(round(sine))
    return np.array(
        [
            [cosine * scale_x, -sine * scale_y, 0.0],
            [sine * scale_x, cosine * scale_y, 0.0],
            [0.0, 0.0, 1.0],
        ]
    )


def homography(source: ArrayLike, target: ArrayLike) -> Matrix:
    """Returns the projective transform that maps four points to four others.

    Args:
        source: (4, 2) points, around a convex quadrilateral.
        target: (4, 2) points around a convex quadrilateral, in either direction.

    Raises:
        ValueError: Points of `source` or `target` are not around a convex quadrilateral.
    """
    return product(_from_unit_square(target), inverse(_from_unit_square(source)))


def applied(transform: Matrix, points: ArrayLike) -> NDArray[np.float64]:
    """Returns the images of (n, 2) points under a transform."""
    points = np.asarray(points, np.float64)
    homogeneous = product(points, transform[:, :2].T) + transform[:, 2]
    return homogeneous[:, :2] / homogeneous[:, 2:]


def mean_footprint(placed: Placement, width: int, height: int) -> float:
    """Returns the mean number of image pixels in an upright square as wide as a pixel's filter.

    Each number is at least 1 and at most that of a square as long as the image; pixels of the
    result outside the image count as 0.
    """
    grid = (np.arange(_PLACES) + 0.5) / _PLACES
    x, y = (axis.ravel() for axis in np.meshgrid(grid * placed.width, grid * placed.height))
    rows = product(placed.transform, np.stack([x, y, np.ones_like(x)]))
    rows = rows[:, rows[2] > 0.0]
    places = rows[:2] / rows[2]
    slopes = placed.transform[:2, :2, None] - places[:, None] * placed.transform[2, :2, None]
    widths = _largest_stretch(slopes / rows[2])
    within = np.all((places >= 0.0) & (places <= [[width], [height]]), axis=0)
    pixels = np.clip(widths, 1.0, max(width, height)) ** 2
    return float(np.sum(pixels[within])) / _PLACES**2


def check_convex(quadrilateral: ArrayLike) -> None:
    """Raises ValueError unless four points form a convex quadrilateral."""
    points = np.asarray(quadrilateral, np.float64)
    sides = np.roll(points, -1, axis=0) - points
    onwards = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * onwards[:, 1] - sides[:, 1] * onwards[:, 0]
    least = _FLATTEST * float(np.max(np.sum(sides**2, axis=1)))
    if not (np.all(turns > least) or np.all(turns < -least)):
        shown = ", ".join(f"({x:.4g}, {y:.4g})" for x, y in points)
        raise ValueError(
            f"Corners: found {shown}; they must form a convex quadrilateral, in the order "
            "lower left, lower right, upper right, upper left"
        )


def _from_unit_square(points: ArrayLike) -> Matrix:
    """Returns the transform from (0, 0), (1, 0), (1, 1), (0, 1) to points (Heckbert, 1989)."""
    check_convex(points)
    p0, p1, p2, p3 = np.asarray(points, np.float64)
    across = np.stack([p1 - p2, p3 - p2], axis=1)
    offset = p0 - p1 + p2 - p3
    (a, b), (c, d) = across
    g, h = np.array([d * offset[0] - b * offset[1], a * offset[1] - c * offset[0]]) / (
        a * d - b * c
    )
    columns = (p1 - p0 + g * p1, p3 - p0 + h * p3, p0)
    return np.vstack([np.stack(columns, axis=1), [g, h, 1.0]])


def _largest_stretch(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the larger singular value of (2, 2, n) matrices."""
    (a, b), (c, d) = matrices
    turned, mirrored = (a + d) ** 2 + (c - b) ** 2, (a - d) ** 2 + (c + b) ** 2
    return np.asarray((np.sqrt(turned) + np.sqrt(mirrored)) / 2, np.float64)


def _fitted(forward: Matrix, width: int, height: int) -> Placement:
    """Returns the smallest result that holds the whole image, centered."""
    ends = applied(forward, rectangle(width, height))
    low, high = ends.min(axis=0), ends.max(axis=0)
    sizes = [_whole(float(extent)) for extent in high - low]
    shift = (np.array(sizes) - (low + high)) / 2
    return Placement(inverse(product(moved(*shift), forward)), *sizes)


def _rectified(settings: ResampleSettings, width: int, height: int) -> Placement:
    places = corners(settings, width, height)
    check_convex(places)
    new_size = _size(settings, width, height)
    if settings.size == "fit":
        new_size = _fitted_size(settings, places, width, height)
    return Placement(homography(rectangle(*new_size), places), *new_size)


def _fitted_size(
    settings: ResampleSettings, places: NDArray[np.float64], width: int, height: int
) -> tuple[int, int]:
    """Returns the size of the rectified area: no side gets fewer pixels than in the image."""
    sides = [_native.hypot(*side) for side in np.roll(places, -1, axis=0) - places]
    across, up = max(sides[0], sides[2]), max(sides[1], sides[3])
    if settings.proportions == "sides":
        return _whole(across), _whole(up)
    aspect = settings.aspect
    if settings.proportions == "perspective":
        aspect = proportions(places, width, height).aspect
    up = max(up, across / aspect)
    return _whole(aspect * up), _whole(up)


def _size(settings: ResampleSettings, width: int, height: int) -> tuple[int, int]:
    return (settings.width, settings.height) if settings.size == "pixels" else (width, height)


def _whole(extent: float) -> int:
    if not extent <= LONGEST_SIDE:
        raise ValueError(f"the result would be {extent:.0f} pixels long; allowed: {LONGEST_SIDE}")
    return max(1, math.ceil(extent - _ROUNDING))
