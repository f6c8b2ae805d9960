# SPDX-License-Identifier: GPL-3.0-or-later

"""What the operators share that make images of shapes."""

from typing import TYPE_CHECKING

import bpy

from ...bridge.image_operator import MakesImage

if TYPE_CHECKING:
    from ..rasterization import Load, Rasterization


class ShapeOperator(MakesImage):
    """A mixin: an image of shapes."""

    doing = "Rasterizing"
    if TYPE_CHECKING:
        work: Rasterization | None
    source_drawn = "curves"
    """The source whose settings the redo panel shows."""

    def load(self) -> "Load":
        """Returns how much there was to do."""
        assert self.work is not None
        assert self.work.load is not None
        return self.work.load

    def effort(self, load: "Load") -> float:
        """Returns about how many seconds the image takes with the present settings."""
        return load.seconds(self.to_settings())

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout, self.source_drawn)
