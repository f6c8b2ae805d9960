# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of a bake as properties, of the operator and of the scene."""

from dataclasses import replace

import bpy
from bpy.props import PointerProperty

from ..bridge.files import engines
from ..core.properties import properties, values
from .choices import FITTED_FILTERS, NOT_OF_MODELS, ModelSettings, Settings

_OF_FILES = ("texture_format", "supercompression")
"""What is drawn below the kind of a file."""


class BakeProperties:
    """The properties of a bake; a mixin for an operator and a property group."""

    __annotations__ = properties(Settings)

    def to_settings(self) -> Settings:
        """Returns the values, with the files' paths made absolute."""
        settings = values(self, Settings)
        if self._shows_roughness():
            return settings
        # What an earlier choice has left in fields that are not shown.
        return replace(settings, roughness="", roughness_filepath="")

    def _shows_roughness(self) -> bool:
        return self.content == "normal" or (self.content == "auto" and bool(self.roughness))

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the properties."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "filter")
        layout.prop(self, "reader")
        if self.reader != "linear" and self.filter == "pam-trilinear":
            layout.label(text="PAM Trilinear requires Linear Light", icon="ERROR")
        row = layout.row()
        row.active = self.reader == "linear" and self.filter in FITTED_FILTERS
        row.prop(self, "lookups")
        column = layout.column(align=True)
        column.prop(self, "wrap")
        column.prop(self, "wrap_v", text="V")
        layout.prop(self, "content")
        if self.content == "cutout":
            layout.prop(self, "threshold")
        if self._shows_roughness():
            layout.prop_search(self, "roughness", bpy.data, "images")
        has_roughness = self._shows_roughness() and self.roughness
        if has_roughness:
            layout.prop(self, "roughness_channel")
        row = layout.row()
        row.active = self.content != "normal"
        row.prop(self, "bounds")
        layout.prop(self, "levels")
        layout.separator()
        layout.prop(self, "objects")
        layout.prop(self, "importance")
        layout.prop(self, "seam_budget")
        layout.prop(self, "use_subdivision_limit")
        layout.prop(self, "use_frames")
        column = layout.column(align=True)
        column.active = self.use_frames
        column.prop(self, "frame_start")
        column.prop(self, "frame_end")
        column.prop(self, "frame_step")
        layout.separator()
        layout.prop(self, "use_images")
        layout.prop(self, "filepath")
        if has_roughness:
            layout.prop(self, "roughness_filepath")
        paths = (self.filepath, self.roughness_filepath if has_roughness else "")
        if any(engines.has_formats(path) for path in paths):
            layout.prop(self, "texture_format")
        if any(engines.has_supercompression(path) for path in paths):
            layout.prop(self, "supercompression")


class ModelProperties:
    """The properties of a bake of a model; a mixin for an operator and a property group."""

    __annotations__ = properties(ModelSettings) | properties(Settings, NOT_OF_MODELS)

    def to_settings(self) -> tuple[ModelSettings, Settings]:
        """Returns the values, with the folder's path made absolute."""
        return values(self, ModelSettings), values(self, Settings, NOT_OF_MODELS)

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws what is set for models only."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "objects")
        column = layout.column()
        column.prop(self, "folder")
        row = column.column()
        row.active = bool(self.folder)
        row.prop(self, "file_format")
        if engines.has_formats(f".{self.file_format}"):
            row.prop(self, "texture_format")
        if engines.has_supercompression(f".{self.file_format}"):
            row.prop(self, "supercompression")
        layout.prop(self, "use_images")

    def draw_others(self, layout: bpy.types.UILayout) -> None:
        """Draws what all bakes have."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in properties(Settings, {*NOT_OF_MODELS, *_OF_FILES}):
            column = layout.column()
            column.active = not name.startswith("frame_") or self.use_frames
            column.prop(self, name)


class PREFILTER_PG_model(ModelProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


class PREFILTER_PG_bake(BakeProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


def register() -> None:
    """Registers the settings on the scene."""
    bpy.utils.register_class(PREFILTER_PG_bake)
    bpy.utils.register_class(PREFILTER_PG_model)
    bpy.types.Scene.prefilter_bake = PointerProperty(type=PREFILTER_PG_bake)
    bpy.types.Scene.prefilter_model = PointerProperty(type=PREFILTER_PG_model)


def unregister() -> None:
    """Removes the settings from the scene."""
    del bpy.types.Scene.prefilter_model
    del bpy.types.Scene.prefilter_bake
    bpy.utils.unregister_class(PREFILTER_PG_model)
    bpy.utils.unregister_class(PREFILTER_PG_bake)
