# SPDX-License-Identifier: GPL-3.0-or-later

"""The panels that show levels, errors and texel weights, in the sidebar of the Image editors."""

from typing import Any

import bpy
import bpy.utils.previews
import numpy as np

from ...core.sidebar import ImagePanel, button
from ...core.translations import CONTEXT, tr
from ..operators.fill_unused import PREFILTER_OT_fill_unused
from ..operators.plot_error import PREFILTER_OT_plot_error
from ..operators.preview_levels import PREFILTER_OT_end_preview, PREFILTER_OT_preview_levels
from ..operators.show_weights import PREFILTER_OT_show_source, PREFILTER_OT_show_weights
from ..view import preview

_SWATCH_SIDE = 16
_UNUSED = "unused"
_swatches: list[tuple[str, str]] = []
_icons: Any = None


class PREFILTER_PT_preview(ImagePanel, bpy.types.Panel):
    """The level slider and the wipe."""

    bl_label = "Preview"
    bl_parent_id = "PREFILTER_PT_bake"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        preview.VIEW.draw_switch(self.layout, context)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.window_manager.prefilter_view
        image = context.space_data.image
        shown = preview.find(image)
        place = button(layout, context, PREFILTER_OT_preview_levels)
        if place:
            row = place.row(align=True)
            text = "Preview Levels" if shown is None else "Refresh"
            operator = row.operator(
                PREFILTER_OT_preview_levels.bl_idname, text=text, icon="FILE_REFRESH"
            )
            operator.compare = settings.compare
            if shown is not None:
                row.operator(PREFILTER_OT_end_preview.bl_idname, text="", icon="X")
        if shown is not None:
            column = layout.column()
            column.active = settings.use_preview
            column.prop(settings, "mip_value", slider=True)
            row = column.row(heading="Wipe", heading_ctxt=CONTEXT)
            row.prop(settings, "use_wipe", text="")
            part = row.row()
            part.active = settings.use_wipe
            part.prop(settings, "wipe", text="", slider=True)
            if settings.mip_value > shown.last_level:
                column.label(text=tr("The last level is {}").format(shown.last_level), icon="INFO")
            if image.use_view_as_render:
                column.label(text="Drawn without View as Render", icon="INFO")
            settings_now = context.scene.prefilter_bake.to_settings()
            if shown.is_stale:
                layout.label(text="The image or a mesh has changed", icon="ERROR")
            elif shown.settings != preview.settings_for_preview(settings_now):
                layout.label(text="The settings have changed", icon="ERROR")
            elif settings.compare not in shown.levels:
                layout.label(text="The filter has changed", icon="ERROR")
        layout.prop(settings, "compare")


class PREFILTER_PT_error(ImagePanel, bpy.types.Panel):
    """The error plot."""

    bl_label = "Error Plot"
    bl_parent_id = "PREFILTER_PT_bake"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = context.window_manager.prefilter_view
        place = button(self.layout, context, PREFILTER_OT_plot_error)
        if place:
            operator = place.operator(PREFILTER_OT_plot_error.bl_idname, icon="FCURVE")
            operator.filters = settings.plot_filters
        _draw_back(self.layout, context)
        self.layout.column(align=True).prop(settings, "plot_filters")
        reader = context.scene.prefilter_bake.reader
        if reader != "linear" and "pam-trilinear" in settings.plot_filters:
            self.layout.label(text="PAM Trilinear requires Linear Light", icon="ERROR")


class PREFILTER_PT_texel_use(ImagePanel, bpy.types.Panel):
    """Texel weights, and filling of unused texels."""

    bl_label = "Texel Use"
    bl_parent_id = "PREFILTER_PT_bake"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.layout
        for operator, icon in (
            (PREFILTER_OT_show_weights, "MOD_VERTEX_WEIGHT"),
            (PREFILTER_OT_fill_unused, "SNAP_FACE"),
        ):
            place = button(layout, context, operator)
            if place:
                place.operator(operator.bl_idname, icon=icon)
        _draw_back(layout, context)
        legend = layout.column(align=True)
        for key, text in _swatches:
            legend.label(text=_legend_text(text), icon_value=_icons[key].icon_id)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_PT_preview, PREFILTER_PT_error, PREFILTER_PT_texel_use)
)


def register() -> None:
    """Registers the panels, and loads the colored squares of the legend."""
    _load_swatches()
    _register_classes()


def unregister() -> None:
    """Removes them."""
    _unregister_classes()
    _free_swatches()


def _load_swatches() -> None:
    from ..view import weights

    global _icons
    _icons = bpy.utils.previews.new()
    for octave in range(weights.OCTAVES, -weights.OCTAVES - 1, -2):
        factor = f"{2**octave}x" if octave >= 0 else f"1/{2**-octave}"
        _add_swatch(factor if octave else "", weights.colors(2.0**octave))
    _add_swatch(_UNUSED, weights.unused_color())


def _free_swatches() -> None:
    global _icons
    bpy.utils.previews.remove(_icons)
    _icons = None
    _swatches.clear()


def _add_swatch(text: str, color: np.ndarray | tuple[float, float, float]) -> None:
    key = str(len(_swatches))
    icon = _icons.new(key)
    icon.icon_size = (_SWATCH_SIDE, _SWATCH_SIDE)
    icon.icon_pixels_float = np.tile([*color, 1.0], _SWATCH_SIDE**2).tolist()
    _swatches.append((key, text))


def _legend_text(swatch: str) -> str:
    """Returns the text of a swatch in the legend."""
    if swatch == _UNUSED:
        return tr("Unused (hatched)")
    if not swatch:
        return tr("Average use")
    text = tr("{} average") if swatch.endswith("x") else tr("{} of average")
    return text.format(swatch)


def _draw_back(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    from ...bridge import derived

    if derived.source_of(context.space_data.image) is not None:
        layout.operator(PREFILTER_OT_show_source.bl_idname, icon="LOOP_BACK")
