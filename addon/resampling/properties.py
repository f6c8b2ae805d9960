"""The settings of resizing as properties, of the operator and of the scene."""

import bpy
from bpy.props import PointerProperty

from ..core.properties import properties, values
from .choices import ResizeSettings


class ResizeProperties:
    """The properties of `prefilter.resize_image`."""

    __annotations__ = properties(ResizeSettings)

    def to_settings(self) -> ResizeSettings:
        """Returns the settings."""
        return values(self, ResizeSettings)

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "size")
        if self.size == "percent":
            layout.prop(self, "percent")
        else:
            column = layout.column(align=True)
            column.prop(self, "width")
            row = column.row(align=True)
            row.active = not self.use_aspect
            row.prop(self, "height")
            layout.prop(self, "use_aspect")
        layout.prop(self, "filter")
        layout.prop(self, "use_constrained")
        layout.prop(self, "wrap")


class PREFILTER_PG_resize(ResizeProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


def register() -> None:
    """Registers the settings on the scene."""
    bpy.utils.register_class(PREFILTER_PG_resize)
    bpy.types.Scene.prefilter_resize = PointerProperty(type=PREFILTER_PG_resize)


def unregister() -> None:
    """Removes the settings from the scene."""
    del bpy.types.Scene.prefilter_resize
    bpy.utils.unregister_class(PREFILTER_PG_resize)
