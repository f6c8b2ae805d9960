# SPDX-License-Identifier: GPL-3.0-or-later

"""The user interface of shapes: panels in the 3D view and the Image editor, menus, a header."""

import bpy

from ..core.buttons import Button
from ..core.menus import PREFILTER_MT_image, PREFILTER_MT_object
from ..core.presets import PresetsPanel
from ..core.registration import classes, entry, registration
from ..core.sidebar import ImagePanel, SidebarPanel, button, main_button, note
from ..core.translations import tr
from .choices import RasterizeSettings
from .operators.rasterize import PREFILTER_OT_rasterize
from .operators.rasterize_svg import PREFILTER_OT_rasterize_svg
from .operators.update_drawn import PREFILTER_OT_update_drawn
from .operators.use_as_decal import PREFILTER_OT_use_as_decal
from .properties import RASTERIZE

_RASTERIZE = Button(PREFILTER_OT_rasterize, "IMAGE_DATA", RASTERIZE.group, {RasterizeSettings: ()})
_SVG = Button(PREFILTER_OT_rasterize_svg, "FILE_IMAGE", RASTERIZE.group, {RasterizeSettings: ()})


class _CurvesPanel(SidebarPanel):
    required_object = "a curve or a text"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Returns whether an object is a curve or text."""
        from ..bridge.curves import is_curve

        return is_curve(obj)


class PREFILTER_PT_rasterize(_CurvesPanel, PresetsPanel, bpy.types.Panel):
    """The button and the settings for curves and texts."""

    bl_label = "Rasterize"
    presets = RASTERIZE

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from .provenance import latest_image_of

        row = main_button(self.layout, context, PREFILTER_OT_rasterize)
        if row:
            _RASTERIZE.draw(row, context, "Make Image").source = "curves"
        image = latest_image_of(context.active_object)
        if image is not None:
            width, height = image.size
            size = tr("{} x {} pixels").format(width, height)
            note(self.layout, context, f"'{image.name}': {size}", "CHECKMARK")
            _draw_decal(self.layout, image)
        context.scene.prefilter_rasterize.draw_collapsed(self.layout, "curves")


class PREFILTER_PT_drawn(ImagePanel, bpy.types.Panel):
    """The button that updates the editor's image, and its settings."""

    bl_label = "Rasterized Image"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the editor's image was made by Rasterize."""
        from .provenance import is_drawn

        return is_drawn(context.space_data.image)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.layout
        image = context.space_data.image
        drawn = image.prefilter_drawn
        row = main_button(layout, context, PREFILTER_OT_update_drawn)
        if row:
            update = PREFILTER_OT_update_drawn.bl_idname
            operator = row.operator(update, text="Update", icon="FILE_REFRESH")
            operator.image = image.name
        _draw_decal(layout, image, context.active_object)
        if drawn.source == "svg":
            layout.prop(drawn, "filepath", text="")
        drawn.draw_collapsed(layout, drawn.source)


class PREFILTER_PT_shapes(ImagePanel, PresetsPanel, bpy.types.Panel):
    """The buttons and the settings for SVG files, and for a mask of the active mesh's UV map."""

    bl_label = "Rasterize"
    presets = RASTERIZE

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        row = main_button(self.layout, context, PREFILTER_OT_rasterize_svg)
        if row:
            # An empty path makes the operator open the file browser.
            _SVG.draw(row, context, "Make Image of SVG...").filepath = ""
        row = button(self.layout, context, PREFILTER_OT_rasterize)
        if row:
            _draw_uv_mask(row, context)
        context.scene.prefilter_rasterize.draw_collapsed(self.layout, "svg")


def _draw_decal(
    layout: bpy.types.UILayout, image: bpy.types.Image, active: bpy.types.Object | None = None
) -> None:
    """Draws the buttons that put an image on a plane, or into the active mesh's material."""
    from ..bridge.uv_layouts import has_uv_map

    row = layout.row(align=True)
    name, is_mask = PREFILTER_OT_use_as_decal.bl_idname, image.prefilter_drawn.source == "uv"
    if not is_mask:
        operator = row.operator(name, icon="MESH_PLANE")
        operator.image, operator.target = image.name, "plane"
    if has_uv_map(active):
        operator = row.operator(name, text="On Material", icon="MATERIAL")
        operator.image, operator.target = image.name, "material"


def _draw_decal_entry(layout: bpy.types.UILayout) -> None:
    layout.operator(PREFILTER_OT_use_as_decal.bl_idname, icon="MESH_PLANE").target = "plane"


def _draw_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _RASTERIZE.draw(menu.layout, context)
    _draw_decal_entry(menu.layout)


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_uv_mask(menu.layout, context)
    _draw_svg(menu.layout, context)
    menu.layout.operator(PREFILTER_OT_update_drawn.bl_idname, icon="FILE_REFRESH")
    _draw_decal_entry(menu.layout)


def _draw_uv_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _draw_uv_mask(menu.layout, context)


def _draw_header(header: bpy.types.Header, context: bpy.types.Context) -> None:
    from .provenance import is_drawn

    image = context.space_data.image
    if is_drawn(image):
        update = PREFILTER_OT_update_drawn.bl_idname
        header.layout.operator(update, text="Update", icon="FILE_REFRESH").image = image.name


def _draw_import(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    _SVG.draw(menu.layout, context, "SVG as Image (.svg)", "NONE").filepath = ""


def _draw_svg(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    # An empty path makes the operator open the file browser.
    _SVG.draw(layout, context, "Rasterize SVG...").filepath = ""


def _draw_uv_mask(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draws the button for a mask, with the size of the editor's image."""
    operator = _RASTERIZE.draw(layout, context, "Rasterize UV Map", "UV", is_changed=True)
    operator.source = "uv"
    image = getattr(context.space_data, "image", None)
    if image is not None and all(image.size):
        operator.width, operator.height = image.size


register, unregister = registration(
    classes(PREFILTER_PT_rasterize, PREFILTER_PT_drawn, PREFILTER_PT_shapes),
    entry(PREFILTER_MT_object, _draw_object_menu),
    entry(PREFILTER_MT_image, _draw_image_menu),
    entry(bpy.types.IMAGE_MT_uvs, _draw_uv_menu),
    entry(bpy.types.TOPBAR_MT_file_import, _draw_import),
    entry(bpy.types.IMAGE_HT_header, _draw_header),
)
