# SPDX-License-Identifier: GPL-3.0-or-later

"""A camera that looks at a plane tiled with an image."""

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from prefilter.workflows.images.placement import Matrix

_FOCAL_LENGTH = 1.0  # In picture heights.


def uv_of_picture(
    tilt: float, rotation: float, tiles: float, *, picture_aspect: float, image_aspect: float
) -> "Matrix":
    """Returns the transform from a picture, [0, 1]^2 from its lower left corner, to UVs.

    The homogeneous coordinate w is positive below the horizon.

    Args:
        tilt: The angle between the plane's normal and the line of sight, in radians, below pi / 2.
        rotation: The rotation of the image about the middle of the picture, in radians,
            counterclockwise.
        tiles: The number of tiles over the picture's height without a tilt.
        picture_aspect: The width of the picture divided by its height.
        image_aspect: The width of the image divided by its height.
    """
    to_rays = np.array([[picture_aspect, 0.0, -picture_aspect / 2], [0.0, 1.0, -0.5], [0, 0, 1]])
    cosine, sine = math.cos(tilt), math.sin(tilt)
    # Intersects rays (x, y, -focal length) with the plane through (0, 0, -tiles * focal length).
    to_plane = np.array(
        [
            [tiles * _FOCAL_LENGTH * cosine, 0.0, 0.0],
            [0.0, tiles * _FOCAL_LENGTH, 0.0],
            [0.0, -sine, _FOCAL_LENGTH * cosine],
        ]
    )
    cos_rotation, sin_rotation = math.cos(rotation), math.sin(rotation)
    to_uv = np.array(
        [
            [cos_rotation / image_aspect, sin_rotation / image_aspect, 0.5],
            [-sin_rotation, cos_rotation, 0.5],
            [0.0, 0.0, 1.0],
        ]
    )
    return to_uv @ to_plane @ to_rays
