# SPDX-License-Identifier: GPL-3.0-or-later

"""Placement of a plane in an image."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...options.shapes import LARGEST_SIDE, RasterizeSettings
from ..memory import Memory
from ..wording import Sentence

FloatArray = NDArray[np.float64]

_BYTES_PER_PIXEL = 40.0
"""Peak memory per pixel: floats, a copy, and bytes."""


@dataclass(frozen=True)
class Frame:
    """The size of an image, and the transform from a plane to it.

    Attributes:
        width: Pixels.
        height: Pixels.
        to_pixels: (3, 3), maps homogeneous points of the plane to those of the image.
    """

    width: int
    height: int
    to_pixels: FloatArray


def whole_frame(width: int, height: int, low: Sequence[float], high: Sequence[float]) -> Frame:
    """Returns the frame that stretches a box over an image."""
    scale = [width / (high[0] - low[0]), height / (high[1] - low[1])]
    return _frame(width, height, scale, [-low[0] * scale[0], -low[1] * scale[1]])


def fitted_frame(box: FloatArray, settings: RasterizeSettings) -> Frame:
    """Returns the frame that centers a box in an image, with the margin around it.

    Args:
        box: (2, 2): the low and the high corner.
        settings: The resolution and the margin.

    Raises:
        ValueError: The box has no size, the margin leaves no room, or the image would be too large.
    """
    size = box[1] - box[0]
    if not np.all(size > 0.0):
        raise ValueError(Sentence("the shapes have no area, as seen from there"))
    if settings.resolution == "density":
        scale = settings.density
        sides = np.ceil(size * scale + 2.0 * settings.margin - 1e-6)
        if np.any(sides > LARGEST_SIDE):
            raise ValueError(
                f"Pixels per Unit: {scale:g} would make an image of {sides[0]:.0f} x "
                f"{sides[1]:.0f} pixels; the limit is {LARGEST_SIDE}"
            )
        width, height = (max(1, int(side)) for side in sides)
    elif settings.resolution == "side":
        inside = settings.side - 2.0 * settings.margin
        if inside <= 0.0:
            raise ValueError(
                f"Margin: {settings.margin:g} leaves no room in {settings.side} pixels"
            )
        scale = inside / float(np.max(size))
        sides = np.ceil(size * scale + 2.0 * settings.margin - 1e-6)
        width, height = (max(1, int(side)) for side in sides)
    else:
        width, height = settings.width, settings.height
        room = np.array([width, height]) - 2.0 * settings.margin
        if np.any(room <= 0.0):
            raise ValueError(
                f"Margin: {settings.margin:g} leaves no room in {width} x {height} pixels"
            )
        scale = float(np.min(room / size))
    shift = np.array([width, height]) / 2.0 - scale * (box[0] + box[1]) / 2.0
    return _frame(width, height, [scale, scale], shift)


def _frame(width: int, height: int, scale: Sequence[float], shift: Sequence[float]) -> Frame:
    matrix = np.array([[scale[0], 0.0, shift[0]], [0.0, scale[1], shift[1]], [0.0, 0.0, 1.0]])
    return Frame(width, height, matrix)


def check_memory(frame: Frame, memory: Memory) -> None:
    """Raises MemoryError if an image would not fit into memory."""
    needed = _BYTES_PER_PIXEL * frame.width * frame.height
    free, why = memory()
    if needed > free:
        raise MemoryError(
            f"an image of {frame.width} x {frame.height} pixels needs about {needed / 1e9:.1f} GB "
            f"of memory; {why}: make it smaller"
        )
