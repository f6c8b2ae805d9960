"""The settings of resizing and resampling as properties, of operators and of the scene."""

import bpy
from bpy.props import PointerProperty

from ..core.properties import properties, values
from .choices import CORNERS, ResampleSettings, ResizeSettings


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


class ResampleProperties:
    """The properties of `prefilter.resample_image`."""

    __annotations__ = properties(ResampleSettings)

    def to_settings(self) -> ResampleSettings:
        """Returns the settings."""
        return values(self, ResampleSettings)

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "warp")
        if self.warp == "affine":
            self._draw_transform(layout)
        else:
            for name in CORNERS:
                layout.row(align=True).prop(self, name)
        layout.prop(self, "size")
        if self.size == "pixels":
            column = layout.column(align=True)
            column.prop(self, "width")
            column.prop(self, "height")
        layout.prop(self, "method")
        layout.prop(self, "filter")
        if self.filter == "gaussian":
            layout.prop(self, "max_probes")
        layout.prop(self, "wrap")

    def _draw_transform(self, layout: bpy.types.UILayout) -> None:
        column = layout.column(align=True)
        column.prop(self, "scale_x")
        column.prop(self, "scale_y", text="Y")
        layout.prop(self, "rotation")
        column = layout.column(align=True)
        # Where the result is fitted to the image, it moves along.
        column.active = self.size != "fit"
        column.prop(self, "offset_x")
        column.prop(self, "offset_y", text="Y")


class PREFILTER_PG_resize(ResizeProperties, bpy.types.PropertyGroup):
    """The settings of resizing that the panel shows; they stay with the scene."""


class PREFILTER_PG_resample(ResampleProperties, bpy.types.PropertyGroup):
    """The settings of resampling that the panel shows; they stay with the scene."""


_GROUPS = {"prefilter_resize": PREFILTER_PG_resize, "prefilter_resample": PREFILTER_PG_resample}


def register() -> None:
    """Registers the settings on the scene."""
    for name, group in _GROUPS.items():
        bpy.utils.register_class(group)
        setattr(bpy.types.Scene, name, PointerProperty(type=group))


def unregister() -> None:
    """Removes the settings from the scene."""
    for name, group in reversed(_GROUPS.items()):
        delattr(bpy.types.Scene, name)
        bpy.utils.unregister_class(group)
