# SPDX-License-Identifier: GPL-3.0-or-later

"""What a drawing consists of: outlines that are filled or stroked."""

from dataclasses import asdict, dataclass

import numpy as np

from ... import _native
from ..shape import Shape
from .outline import Outline
from .paint_servers import Gradient
from .values import Matrix, multiplied


@dataclass(frozen=True, slots=True)
class Stroke:
    """How an outline is stroked, in its own units, as `Shape.stroked` takes it.

    Attributes:
        dash_count: How many dashes there are at most.
    """

    width: float
    cap: str
    join: str
    miter_limit: float
    dashes: tuple[float, ...]
    dash_offset: float
    dash_count: float = 0.0


@dataclass(frozen=True, slots=True)
class Painted:
    """An outline to fill or to stroke.

    Attributes:
        outline: In its own units.
        fill_rule: For what it fills.
        matrix: From its units to those of the drawing.
        paint: A color, multiplied by its alpha, or a gradient in the outline's units.
        stroke: None where it is filled.
    """

    outline: Outline
    fill_rule: str
    matrix: Matrix
    paint: tuple[float, ...] | Gradient
    stroke: Stroke | None

    def shape(self, matrix: Matrix, tolerance: float) -> Shape:
        """In pixels, to which `matrix` leads from the drawing's units.

        `tolerance` is how far a stroke may be off, in pixels.
        """
        whole = multiplied(matrix, self.matrix)
        shape = self.outline.shape(self.fill_rule)
        if self.stroke is not None:
            scale = max(_native.hypot(*whole[:2]), _native.hypot(*whole[2:4]))
            pen = asdict(self.stroke)
            del pen["dash_count"]
            shape = shape.stroked(**pen, tolerance=tolerance / scale)
        a, b, c, d, e, f = whole
        shape = shape.transformed(np.array([[a, c, e], [b, d, f]]))
        if isinstance(self.paint, Gradient):
            self.paint.apply(shape, whole)
        else:
            shape.color = self.paint
        return shape
