# SPDX-License-Identifier: GPL-3.0-or-later

"""Text as outlines of Blender's built-in font, without a file, a window or a GPU."""

from dataclasses import dataclass
from functools import lru_cache

import bpy
import numpy as np
from numpy.typing import NDArray
from prefilter.workflows.shapes.outlines import box_of

from .curves import read_curves


@dataclass(frozen=True)
class Lettering:
    """A line of text of size 1, with its baseline at y = 0 and its start near x = 0.

    Attributes:
        letters: Contours of each letter: (segments, degree + 1, 3) homogeneous control points, to
            be filled by the nonzero rule.
        low: Start of the first letter along x.
        high: End of the last letter along x.
    """

    letters: tuple[tuple[NDArray[np.float64], ...], ...]
    low: float
    high: float


@lru_cache(maxsize=256)
def outlines(text: str) -> Lettering:
    """Returns the outlines of a line of text. Main thread only."""
    curve = bpy.data.curves.new("prefilter lettering", "FONT")
    obj = bpy.data.objects.new("prefilter lettering", curve)
    try:
        curve.body = text
        (curves,) = read_curves([obj], bpy.context.evaluated_depsgraph_get())
    finally:
        bpy.data.objects.remove(obj)
        bpy.data.curves.remove(curve)
    letters = tuple(
        tuple(contour[..., [0, 1, 3]] for contour in fill.contours) for fill in curves.fills
    )
    boxes = np.array([box_of(contour) for letter in letters for contour in letter])
    if len(boxes) == 0:
        return Lettering((), 0.0, 0.0)
    return Lettering(letters, float(boxes[:, 0, 0].min()), float(boxes[:, 1, 0].max()))
