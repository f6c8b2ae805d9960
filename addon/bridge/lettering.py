# SPDX-License-Identifier: GPL-3.0-or-later

"""Text as outlines, from Blender's own font: it needs no file, no window and no GPU."""

from dataclasses import dataclass
from functools import lru_cache

import bpy
import numpy as np
from numpy.typing import NDArray
from prefilter.workflows.shapes.outlines import box_of

from .curves import read_curves


@dataclass(frozen=True)
class Lettering:
    """A line of text of size 1, whose baseline is y = 0; it starts at about x = 0.

    Attributes:
        letters: For each letter its contours: (segments, degree + 1, 3) homogeneous control points,
            which are filled by the nonzero rule.
        low: Where the first letter starts along x.
        high: Where the last letter ends.
    """

    letters: tuple[tuple[NDArray[np.float64], ...], ...]
    low: float
    high: float


@lru_cache(maxsize=256)
def outlines(text: str) -> Lettering:
    """Returns a line of text. Main thread only."""
    curve = bpy.data.curves.new("prefilter lettering", "FONT")
    obj = bpy.data.objects.new("prefilter lettering", curve)
    try:
        curve.body = text
        (found,) = read_curves([obj], bpy.context.evaluated_depsgraph_get())
    finally:
        bpy.data.objects.remove(obj)
        bpy.data.curves.remove(curve)
    letters = tuple(
        tuple(contour[..., [0, 1, 3]] for contour in fill.contours) for fill in found.fills
    )
    boxes = np.array([box_of(contour) for letter in letters for contour in letter])
    if len(boxes) == 0:
        return Lettering((), 0.0, 0.0)
    return Lettering(letters, float(boxes[:, 0, 0].min()), float(boxes[:, 1, 0].max()))
