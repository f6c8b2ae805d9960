# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of resizing, resampling and tables as properties of operators and the scene."""

from typing import Any

import bpy

from ..core import preset_menu, presets
from ..core.properties import properties, values
from ..core.registration import classes, registration, state
from ..core.sidebar import GroupedSettings, subpanel
from ..core.translations import CONTEXT
from .choices import CORNERS, SUFFIXES, ResampleSettings, ResizeSettings, TableSettings

RESIZE = presets.Kind("resize", "prefilter_resize", [(ResizeSettings, ())])
RESAMPLE = presets.Kind("resample", "prefilter_resample", [(ResampleSettings, ())])


class ResizeProperties(GroupedSettings):
    """The properties of `prefilter.resize_image`."""

    __annotations__ = properties(ResizeSettings)

    def to_settings(self) -> ResizeSettings:
        """Returns the settings."""
        return values(self, ResizeSettings)

    def draw_basic(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
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
        layout.prop(self, "ringing")
        layout.prop(self, "wrap")


class ResampleProperties(GroupedSettings):
    """The properties of `prefilter.resample_image`."""

    __annotations__ = properties(ResampleSettings)

    def to_settings(self) -> ResampleSettings:
        """Returns the settings."""
        return values(self, ResampleSettings)

    def source_of(self, image: bpy.types.Image) -> bpy.types.Image:
        """Returns the image from which this warp has made an image; otherwise the image itself.

        Corners are positions in the source, so warping the result would warp twice.
        """
        from ..bridge.derived import copied

        return copied(image, SUFFIXES[self.warp]) or image

    def draw_basic(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
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
        elif self.size == "fit" and self.warp == "rectify":
            layout.prop(self, "proportions")
            if self.proportions == "given":
                layout.prop(self, "aspect")
        layout.prop(self, "method")
        if self.method == "table":
            layout.prop(self, "table")
        else:
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
        # A result that is fitted to the image ignores offsets.
        column.active = self.size != "fit"
        column.prop(self, "offset_x")
        column.prop(self, "offset_y", text="Y")


class TableProperties(GroupedSettings):
    """The properties of `prefilter.sampling_table`."""

    __annotations__ = properties(TableSettings)

    def to_settings(self) -> TableSettings:
        """Returns the settings."""
        return values(self, TableSettings)

    def draw_basic(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        layout.prop(self, "table")
        column = layout.column()
        column.active = not self.table
        column.prop(self, "filter")
        column.prop(self, "texels")
        parts = column.column(align=True)
        parts.prop(self, "grid")
        parts.prop(self, "slices")
        column.prop(self, "degree")
        column.prop(self, "ramp_weight")
        column.prop(self, "use_certify")
        layout.prop(self, "language")
        layout.prop(self, "filepath")

    def draw_collapsed(self, layout: bpy.types.UILayout, *source: str) -> None:
        """Draws the settings below a button, with labels above the values to save width."""
        del source
        _, body = subpanel(layout, "table_usual", "Settings")
        if body:
            self._draw_narrow(body)

    def _draw_narrow(self, layout: bpy.types.UILayout) -> None:
        _draw_below_label(self, layout, "table")
        column = layout.column()
        column.active = not self.table
        _draw_below_label(self, column, "filter")
        parts = column.column(align=True)
        for name in ("texels", "grid", "slices", "degree"):
            parts.prop(self, name)
        _draw_below_label(self, column, "ramp_weight")
        column.prop(self, "use_certify")
        _draw_below_label(self, layout, "language")
        _draw_below_label(self, layout, "filepath")


def _draw_below_label(settings: Any, layout: bpy.types.UILayout, name: str) -> None:
    column = layout.column(align=True)
    column.label(text=settings.bl_rna.properties[name].name, text_ctxt=CONTEXT)
    column.prop(settings, name, text="")


class PREFILTER_PG_resize(ResizeProperties, bpy.types.PropertyGroup):
    """The settings of resizing, stored in the scene."""


class PREFILTER_PG_resample(ResampleProperties, bpy.types.PropertyGroup):
    """The settings of resampling, stored in the scene."""


class PREFILTER_PG_sampling_table(TableProperties, bpy.types.PropertyGroup):
    """The settings of sampling tables, stored in the scene."""


register, unregister = registration(
    state(bpy.types.Scene, RESIZE.group, PREFILTER_PG_resize),
    state(bpy.types.Scene, RESAMPLE.group, PREFILTER_PG_resample),
    state(bpy.types.Scene, "prefilter_sampling_table", PREFILTER_PG_sampling_table),
    classes(preset_menu.panel(RESIZE), preset_menu.panel(RESAMPLE)),
)
