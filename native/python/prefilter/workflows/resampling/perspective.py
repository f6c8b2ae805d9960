# SPDX-License-Identifier: GPL-3.0-or-later

"""How wide a rectangle is that a camera saw at an angle (Zhang and He, 2007, section 3.1).

The camera has square pixels, and looks through the middle of its image. The vanishing points of two
directions at right angles then tell its focal length, and this the proportions. Where one of them
is at infinity, as of a camera that is held level, every lens is possible.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import _native
from ..matrices import inner

_FARTHEST = 100.0
"""How far away a vanishing point may be to tell something, in diagonals of the image: farther,
what tells is less than the rounding of corners to a pixel."""
_SHORTEST, _LONGEST = 0.25, 15.0  # Focal lengths that are believed, in diagonals.
_USUAL = 0.65  # A lens of 28 mm, by the measure of film 36 mm wide: that of a phone.


@dataclass(frozen=True)
class Proportions:
    """What the perspective tells.

    Attributes:
        aspect: The width of the rectangle by its height.
        is_certain: Whether the corners alone tell it; else the lens is taken to be a usual one.
    """

    aspect: float
    is_certain: bool


def proportions(corners: ArrayLike, width: int, height: int) -> Proportions:
    """Returns the proportions of a rectangle.

    Args:
        corners: (4, 2) places in pixels, around a convex quadrilateral: the first two are the ends
            of the side that is the width.
        width: Of the image, in pixels.
        height: Of the image.
    """
    diagonal = _native.hypot(width, height)
    along, up = _directions((np.asarray(corners, np.float64) - (width / 2, height / 2)) / diagonal)
    lean = (along[2], up[2])
    is_far = [
        abs(w) * _FARTHEST <= _native.hypot(*d[:2]) for w, d in zip(lean, (along, up), strict=True)
    ]
    focal = None if any(is_far) else _focal_length(along, up)
    if focal is None:
        aspect = _length(along, _USUAL) / _length(up, _USUAL)
        # What is seen from the front has the proportions of its picture, whatever the lens.
        return Proportions(aspect, all(is_far))
    return Proportions(_length(along, focal) / _length(up, focal), True)


def _directions(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the homogeneous images of the two sides, as long as these in a unit of their own."""
    m1, m2, m4, m3 = np.column_stack([points, np.ones(4)])
    across = np.cross(m1, m4)
    k2 = inner(across, m3) / inner(np.cross(m2, m4), m3)
    k3 = inner(across, m2) / inner(np.cross(m3, m4), m2)
    return k2 * m2 - m1, k3 * m3 - m1


def _focal_length(along: NDArray[np.float64], up: NDArray[np.float64]) -> float | None:
    """Returns at which distance the sides are at right angles; None where no lens has it."""
    square = -inner(along[:2], up[:2]) / float(along[2] * up[2])
    return float(np.sqrt(square)) if _SHORTEST**2 <= square <= _LONGEST**2 else None


def _length(direction: NDArray[np.float64], focal: float) -> float:
    return _native.hypot(_native.hypot(*direction[:2]) / focal, direction[2])
