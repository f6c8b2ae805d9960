# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of Rasterize as properties of operators, of the scene and of images."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatVectorProperty, PointerProperty

from ..core import preset_menu, presets
from ..core.properties import properties, values
from ..core.registration import classes, registration, state
from ..core.sidebar import GroupedSettings, subpanel
from .choices import RasterizeSettings

RASTERIZE = presets.Kind(
    "rasterize", "prefilter_rasterize", [(RasterizeSettings, ("source", "tile"))]
)


class RasterizeProperties(GroupedSettings):
    """The properties of `prefilter.rasterize`, as a mixin."""

    __annotations__ = properties(RasterizeSettings)

    def to_settings(self) -> RasterizeSettings:
        """Returns the settings."""
        return values(self, RasterizeSettings)

    def draw_basic(self, layout: bpy.types.UILayout, source: str) -> None:
        """Draws the basic settings for a source: a key of `choices.SOURCES` except "auto"."""
        if self._is_free(source):
            layout.prop(self, "resolution")
        if self._is_free(source) and self.resolution != "size":
            layout.prop(self, self.resolution)
        else:
            column = layout.column(align=True)
            column.prop(self, "width")
            column.prop(self, "height")
        layout.prop(self, "filter")
        if source == "curves":
            layout.prop(self, "view")
        elif source == "uv":
            layout.prop(self, "tile")
            layout.prop(self, "uv_margin")

    def draw_groups(self, layout: bpy.types.UILayout, source: str) -> None:
        """Draws the groups for a source."""
        if source != "uv":
            _, body = subpanel(layout, "shape_color", "Color")
            if body:
                self._draw_color(body, source)
        _, body = subpanel(layout, "shape_image", "Image")
        if body:
            body.prop(self, "pixel_type")
            if source != "uv" and self.color != "mask":
                body.prop(self, "alpha")
                body.prop(self, "use_bleed")
            self._draw_name(body)

    def _draw_color(self, layout: bpy.types.UILayout, source: str) -> None:
        layout.prop(self, "color")
        if self.color != "mask":
            layout.prop(self, "background")
            if self.background == "color":
                layout.prop(self, "background_color", text="")
        layout.prop(self, "light" if source == "svg" else "overlap")
        if source == "svg":
            layout.prop(self, "font_folder")
        if not self._is_camera(source):
            layout.prop(self, "margin")

    def _draw_name(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "image_name")

    def _is_camera(self, source: str) -> bool:
        return source == "curves" and self.view == "camera"

    def _is_free(self, source: str) -> bool:
        """Returns whether the size may depend on the shapes."""
        return source != "uv" and not self._is_camera(source)


class PREFILTER_PG_rasterize(RasterizeProperties, bpy.types.PropertyGroup):
    """The settings of the panel, stored in the scene."""


class PREFILTER_PG_drawn_object(bpy.types.PropertyGroup):
    """An object that an image shows."""

    obj: PointerProperty(type=bpy.types.Object)


class PREFILTER_PG_drawn(RasterizeProperties, bpy.types.PropertyGroup):
    """The inputs and settings of an image, stored in the image. The source is never "auto"."""

    is_drawn: BoolProperty()
    objects: CollectionProperty(type=PREFILTER_PG_drawn_object)
    has_place: BoolProperty()
    rotation: FloatVectorProperty(size=4)
    box: FloatVectorProperty(size=4)

    def _draw_name(self, layout: bpy.types.UILayout) -> None:
        """Draws nothing: the image has a name already."""


register, unregister = registration(
    state(bpy.types.Scene, RASTERIZE.group, PREFILTER_PG_rasterize),
    classes(PREFILTER_PG_drawn_object),
    state(bpy.types.Image, "prefilter_drawn", PREFILTER_PG_drawn),
    classes(preset_menu.panel(RASTERIZE)),
)
