# SPDX-License-Identifier: GPL-3.0-or-later

"""Where a user finds shapes: the sidebars of the 3D view and the Image editor, menus, a header."""

import bpy

from ..core.menus import PREFILTER_MT_image, PREFILTER_MT_object
from ..core.presets import PresetsPanel
from ..core.properties import copy
from ..core.sidebar import ImagePanel, SidebarPanel, main_button
from .choices import RasterizeSettings
from .operators.rasterize import PREFILTER_OT_rasterize
from .operators.rasterize_svg import PREFILTER_OT_rasterize_svg
from .operators.update_drawn import PREFILTER_OT_update_drawn
from .properties import RASTERIZE


class _CurvesPanel(SidebarPanel):
    wanted = "a curve or a text"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object."""
        from ..bridge.curves import is_curve

        return is_curve(obj)


class PREFILTER_PT_rasterize(_CurvesPanel, PresetsPanel, bpy.types.Panel):
    """Button and settings for curves and texts."""

    bl_label = "Rasterize"
    presets = RASTERIZE

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        place = main_button(self.layout, context, PREFILTER_OT_rasterize)
        if place:
            _draw_rasterize(place, context, "curves")
        context.scene.prefilter_rasterize.draw_in(self.layout, "curves")


class PREFILTER_PT_drawn(ImagePanel, bpy.types.Panel):
    """The button that makes the image of the editor again, and what it was made with."""

    bl_label = "Rasterized Image"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the editor shows an image that remembers how it was made."""
        from .memory import is_drawn

        return is_drawn(context.space_data.image)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.layout
        image = context.space_data.image
        drawn = image.prefilter_drawn
        place = main_button(layout, context, PREFILTER_OT_update_drawn)
        if place:
            update = PREFILTER_OT_update_drawn.bl_idname
            operator = place.operator(update, text="Update", icon="FILE_REFRESH")
            operator.image = image.name
        if drawn.source == "svg":
            layout.prop(drawn, "filepath", text="")
        drawn.draw_in(layout, drawn.source)


class PREFILTER_PT_shapes(ImagePanel, PresetsPanel, bpy.types.Panel):
    """SVG files, and the UV map of the active mesh as a mask."""

    bl_label = "Rasterize"
    presets = RASTERIZE
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        column = self.layout.column(align=True)
        place = main_button(column, context, PREFILTER_OT_rasterize_svg)
        if place:
            _draw_svg(place, context)
        place = main_button(column, context, PREFILTER_OT_rasterize)
        if place:
            _draw_uv_mask(place, context)
        context.scene.prefilter_rasterize.draw_in(self.layout, "svg")


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_PT_rasterize, PREFILTER_PT_drawn, PREFILTER_PT_shapes)
)


def register() -> None:
    """Registers the panels and the menu entries."""
    _register_classes()
    PREFILTER_MT_object.append(_draw_object_menu)
    PREFILTER_MT_image.append(_draw_image_menu)
    bpy.types.IMAGE_MT_uvs.append(_draw_uv_menu)
    bpy.types.IMAGE_HT_header.append(_draw_header)


def unregister() -> None:
    """Removes them."""
    bpy.types.IMAGE_HT_header.remove(_draw_header)
    bpy.types.IMAGE_MT_uvs.remove(_draw_uv_menu)
    PREFILTER_MT_image.remove(_draw_image_menu)
    PREFILTER_MT_object.remove(_draw_object_menu)
    _unregister_classes()


def _draw_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_rasterize(menu.layout, context, "auto")


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_uv_mask(menu.layout, context)
    _draw_svg(menu.layout, context)
    menu.layout.operator(PREFILTER_OT_update_drawn.bl_idname, icon="FILE_REFRESH")


def _draw_uv_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_uv_mask(menu.layout, context)


def _draw_header(header: bpy.types.Header, context: bpy.types.Context) -> None:
    from .memory import is_drawn

    image = context.space_data.image
    if is_drawn(image):
        update = PREFILTER_OT_update_drawn.bl_idname
        header.layout.operator(update, text="Update", icon="FILE_REFRESH").image = image.name


def _draw_rasterize(
    layout: bpy.types.UILayout, context: bpy.types.Context, source: str
) -> bpy.types.OperatorProperties:
    operator = layout.operator(PREFILTER_OT_rasterize.bl_idname, icon="IMAGE_DATA")
    copy(context.scene.prefilter_rasterize, operator, RasterizeSettings)
    operator.source = source
    return operator


def _draw_svg(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    operator = layout.operator(
        PREFILTER_OT_rasterize_svg.bl_idname, text="Rasterize SVG...", icon="FILE_IMAGE"
    )
    copy(context.scene.prefilter_rasterize, operator, RasterizeSettings)
    # Empty, so that the file browser opens.
    operator.filepath = ""


def _draw_uv_mask(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws the button of a mask, of the size of the image that the editor shows."""
    operator = layout.operator(PREFILTER_OT_rasterize.bl_idname, text="Rasterize UV Map", icon="UV")
    copy(context.scene.prefilter_rasterize, operator, RasterizeSettings)
    operator.source = "uv"
    image = getattr(context.space_data, "image", None)
    if image is not None and all(image.size):
        operator.width, operator.height = image.size
