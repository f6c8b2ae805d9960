# SPDX-License-Identifier: GPL-3.0-or-later

"""Mixins of operators that make images of shapes."""

from typing import TYPE_CHECKING

import bpy

from ...bridge.image_operator import MakesImage
from ...core.presets import PresetsOperator
from ..properties import RASTERIZE, RasterizeProperties

if TYPE_CHECKING:
    from ..rasterization import Load, Rasterization


class ShapeOperator(MakesImage):
    """A mixin for operators that make an image of shapes."""

    activity = "Rasterizing"
    if TYPE_CHECKING:
        work: Rasterization | None
    source_drawn = "curves"
    """The source whose settings the redo panel shows."""

    def load(self) -> "Load":
        """Returns the size of the finished work."""
        assert self.work is not None
        assert self.work.load is not None
        return self.work.load

    def duration(self, load: "Load") -> float:
        """Estimates the seconds with the present settings."""
        return load.seconds(self.to_settings())

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout, self.source_drawn)


class RasterizesOperator(RasterizeProperties, PresetsOperator, ShapeOperator):
    """A mixin for operators that make a new image of shapes, with settings and presets."""

    presets = RASTERIZE

    def complete_settings(self) -> None:
        """Sets Resolution to Size if the caller gives a width or a height."""
        is_set = self.properties.is_property_set
        if not is_set("resolution") and (is_set("width") or is_set("height")):
            self.resolution = "size"
        super().complete_settings()
