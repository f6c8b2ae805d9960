# SPDX-License-Identifier: GPL-3.0-or-later

"""What the operators share that make images of shapes."""

from typing import TYPE_CHECKING

import bpy

from ...bridge.image_operator import MakesImage
from ...core.presets import PresetsOperator
from ..properties import RASTERIZE, RasterizeProperties

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

    def duration(self, load: "Load") -> float:
        """Returns about how many seconds the image takes with the present settings."""
        return load.seconds(self.to_settings())

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout, self.source_drawn)


class RasterizesOperator(RasterizeProperties, PresetsOperator, ShapeOperator):
    """A mixin: a new image of shapes, with settings and presets."""

    presets = RASTERIZE

    def complete_settings(self) -> None:
        """Sets what the caller has left; who names a width means it."""
        named = self.properties.is_property_set
        if not named("resolution") and (named("width") or named("height")):
            self.resolution = "size"
        super().complete_settings()
