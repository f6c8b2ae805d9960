# SPDX-License-Identifier: GPL-3.0-or-later

"""Proportions of a rectangle in a perspective view (Zhang and He, 2007, section 3.1).

The camera has square pixels and looks through the center of its image. The vanishing points of two
perpendicular directions then determine its focal length, and that the proportions. If one of them
is at infinity, as for a level camera, any focal length is possible.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import _native
from ..matrices import inner

_FARTHEST = 100.0
"""Largest distance of a usable vanishing point, in diagonals of the image; beyond that, rounding of
the corners to pixels dominates."""
_SHORTEST, _LONGEST = 0.25, 15.0  # Plausible focal lengths, in diagonals.
_USUAL = 0.65  # Focal length of a phone in diagonals, 28 mm equivalent.


@dataclass(frozen=True)
class Proportions:
    """Proportions derived from the perspective.

    Attributes:
        aspect: Width of the rectangle / its height.
        is_certain: Whether the corners alone determine it; otherwise a usual lens was assumed.
    """

    aspect: float
    is_certain: bool


def proportions(corners: ArrayLike, width: int, height: int) -> Proportions:
    """Returns the proportions of a rectangle.

    Args:
        corners: (4, 2) positions in pixels, around a convex quadrilateral; the side between the
            first two counts as the width.
        width: Width of the image in pixels.
        height: Height of the image in pixels.
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
        # In a frontal view the proportions are those of the picture, with any lens.
        return Proportions(aspect, all(is_far))
    return Proportions(_length(along, focal) / _length(up, focal), True)


def _directions(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the homogeneous directions of both sides, scaled by their relative lengths."""
    m1, m2, m4, m3 = np.column_stack([points, np.ones(4)])
    across = np.cross(m1, m4)
    k2 = inner(across, m3) / inner(np.cross(m2, m4), m3)
    k3 = inner(across, m2) / inner(np.cross(m3, m4), m2)
    return k2 * m2 - m1, k3 * m3 - m1


def _focal_length(along: NDArray[np.float64], up: NDArray[np.float64]) -> float | None:
    """Returns the focal length that makes the sides perpendicular; None if it is implausible."""
    square = -inner(along[:2], up[:2]) / float(along[2] * up[2])
    return float(np.sqrt(square)) if _SHORTEST**2 <= square <= _LONGEST**2 else None


def _length(direction: NDArray[np.float64], focal: float) -> float:
    return _native.hypot(_native.hypot(*direction[:2]) / focal, direction[2])
