# SPDX-License-Identifier: GPL-3.0-or-later

"""A camera that looks at a plane tiled with an image."""

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from prefilter.workflows.resampling.placement import Matrix

_FOCAL_LENGTH = 1.0  # In heights of the picture.


def uv_of_picture(
    tilt: float, rotation: float, tiles: float, *, picture_aspect: float, image_aspect: float
) -> "Matrix":
    """Returns the transform from a picture, [0, 1]^2 from its lower left corner, to UVs.

    The factor of (u, v, 1) is above 0 below the horizon.

    Args:
        tilt: Between the plane's normal and the line of sight, in radians, below pi / 2.
        rotation: Of the image about the middle of the picture, in radians, counterclockwise.
        tiles: How many tiles high the middle of the picture would be without a tilt.
        picture_aspect: Its width by its height.
        image_aspect: That of the image.
    """
    to_rays = np.array([[picture_aspect, 0.0, -picture_aspect / 2], [0.0, 1.0, -0.5], [0, 0, 1]])
    cosine, sine = math.cos(tilt), math.sin(tilt)
    # Of the rays (x, y, -focal length) with the plane through (0, 0, -tiles focal length).
    to_plane = np.array(
        [
            [tiles * _FOCAL_LENGTH * cosine, 0.0, 0.0],
            [0.0, tiles * _FOCAL_LENGTH, 0.0],
            [0.0, -sine, _FOCAL_LENGTH * cosine],
        ]
    )
    turned_x, turned_y = math.cos(rotation), math.sin(rotation)
    to_uv = np.array(
        [
            [turned_x / image_aspect, turned_y / image_aspect, 0.5],
            [-turned_y, turned_x, 0.5],
            [0.0, 0.0, 1.0],
        ]
    )
    return to_uv @ to_plane @ to_rays
