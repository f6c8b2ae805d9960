# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of a bake as properties, of operators and of the scene."""

import os
from dataclasses import replace
from typing import Any

import bpy

from ..core import preset_menu, presets
from ..core.properties import (
    preference_properties,
    properties,
    shared_properties,
    single_property,
    values,
)
from ..core.registration import classes, registration, state
from ..core.sidebar import GroupedSettings, subpanel
from .choices import (
    FITTED_FILTERS,
    NOT_OF_MODELS,
    ModelSettings,
    ResultSettings,
    Settings,
)
from .importance import suggested_names

_FRAMES = ("use_frames", "frame_start", "frame_end", "frame_step")
_FILE_SETTINGS = (
    *("texture_format", "effort", "supercompression", "quality"),
    "use_multiples_of_4",
)
_ANY_SIZE_PREFIXES = ("rgba", "etc2", "eac", "astc")
"""Prefixes of texel formats whose readers accept images of any size."""
BAKE = presets.Kind("bake", "prefilter_bake", [(ResultSettings, ()), (Settings, _FRAMES)])
MODEL = presets.Kind(
    "model",
    "prefilter_model",
    [(ModelSettings, ()), (Settings, {*NOT_OF_MODELS, *_FRAMES})],
    shared=BAKE.name,
)
_SEARCH = {"search": suggested_names, "search_options": {"SORT", "SUGGESTION"}}


def _follow_path(self: "BakeProperties", context: bpy.types.Context) -> None:
    """Sets the format from the extension of the file."""
    from . import file_names

    del context
    file_format = file_names.format_of(self.filepath)
    if file_format and self.file_format != file_format:
        self.file_format = file_format


def _follow_format(self: "BakeProperties", context: bpy.types.Context) -> None:
    """Sets the extensions of the files from the format."""
    from . import file_names

    del context
    for name in ("filepath", "roughness_filepath"):
        path = getattr(self, name)
        if file_names.format_of(path) not in {"", self.file_format}:
            setattr(self, name, f"{os.path.splitext(path)[0]}.{self.file_format}")


class BakeProperties(GroupedSettings):
    """The properties of a bake, as a mixin for an operator and a property group."""

    __annotations__ = (
        properties(ResultSettings)
        | properties(Settings)
        | {
            "file_format": single_property(ResultSettings, "file_format", update=_follow_format),
            "filepath": single_property(Settings, "filepath", update=_follow_path),
            "importance": single_property(Settings, "importance", **_SEARCH),
        }
    )

    def to_settings(self) -> Settings:
        """Returns the values, with absolute paths.

        A default path contains `file_names.PLACE` for the name of the image.
        """
        settings = values(self, Settings)
        if not self._shows_roughness():
            # Hidden fields may have values from an earlier choice.
            settings = replace(settings, roughness="", roughness_filepath="")
        if self.result != "file":
            return replace(settings, use_images=True, filepath="", roughness_filepath="")
        return replace(
            settings,
            use_images=False,
            filepath=self._file(settings.filepath),
            roughness_filepath=self._file(settings.roughness_filepath)
            if settings.roughness
            else "",
        )

    def draw_basic(self, layout: bpy.types.UILayout) -> None:
        """Draws the basic properties."""
        _draw_result(self, layout)
        if self.result == "file":
            self._draw_file(layout)
        if self.reader != "linear" and self.filter == "pam-trilinear":
            layout.label(text="PAM Trilinear requires Linear Light", icon="ERROR")
        layout.prop(self, "content")
        if self.content == "cutout":
            layout.prop(self, "threshold")
        if self._shows_roughness():
            layout.prop_search(self, "roughness", bpy.data, "images")
            if self.roughness:
                layout.prop(self, "roughness_channel")

    def draw_groups(self, layout: bpy.types.UILayout) -> None:
        """Draws the groups."""
        _, body = subpanel(layout, "surface", "Surface")
        if body:
            body.prop(self, "objects")
            _draw_surface(self, body)
        _draw_frames(self, layout)
        _, body = subpanel(layout, "reading", "Lookups")
        if body:
            _draw_lookups(self, body)
        _, body = subpanel(layout, "levels", "Levels")
        if body:
            body.prop(self, "levels")
            row = body.row()
            row.active = self.content != "normal"
            row.prop(self, "bounds")
        _, body = subpanel(layout, "advanced", "Advanced")
        if body:
            body.prop(self, "filter")

    def _shows_roughness(self) -> bool:
        return self.content == "normal" or (self.content == "auto" and bool(self.roughness))

    def _file(self, path: str) -> str:
        """Returns a path with the extension of the format."""
        from . import file_names

        if not path:
            return bpy.path.abspath(f"//{file_names.PLACE}.{self.file_format}")
        return path if file_names.is_texture(path) else f"{path}.{self.file_format}"

    def _draw_file(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "file_format")
        layout.prop(self, "filepath", placeholder="Beside .blend file")
        if self._shows_roughness() and self.roughness:
            layout.prop(self, "roughness_filepath", placeholder="Beside .blend file")
        _draw_compression(self, layout)


class ModelProperties(GroupedSettings):
    """The properties of a model bake, as a mixin for an operator and a property group."""

    __annotations__ = (
        properties(ModelSettings)
        | properties(Settings, NOT_OF_MODELS)
        | {"importance": single_property(Settings, "importance", **_SEARCH)}
    )

    def to_settings(self) -> tuple[ModelSettings, Settings]:
        """Returns the values, with an absolute folder."""
        settings = values(self, Settings, NOT_OF_MODELS)
        return values(self, ModelSettings), replace(settings, use_images=self.result == "images")

    def draw_basic(self, layout: bpy.types.UILayout) -> None:
        """Draws the basic properties."""
        layout.prop(self, "objects")
        layout.prop_search(self, "material", bpy.data, "materials")
        _draw_result(self, layout)
        if self.result == "file":
            layout.prop(self, "folder")
            layout.prop(self, "file_format")
            _draw_compression(self, layout)

    def draw_groups(self, layout: bpy.types.UILayout) -> None:
        """Draws the groups."""
        _, body = subpanel(layout, "model_surface", "Surface")
        if body:
            _draw_surface(self, body)
        _draw_frames(self, layout)
        _, body = subpanel(layout, "model_lookups", "Lookups")
        if body:
            _draw_lookups(self, body)
        _, body = subpanel(layout, "model_levels", "Levels")
        if body:
            body.prop(self, "bounds")
        _, body = subpanel(layout, "model_advanced", "Advanced")
        if body:
            body.prop(self, "filter")


def _draw_result(settings: Any, layout: bpy.types.UILayout) -> None:
    """Draws the buttons across the whole width, without a label."""
    row = layout.row()
    row.use_property_split = False
    row.prop(settings, "result", expand=True)


def _draw_compression(settings: Any, layout: bpy.types.UILayout) -> None:
    """Draws the choices of formats and compression that the file format has."""
    from prefilter.workflows.files import target_files

    extension = f".{settings.file_format}"
    if target_files.has_formats(extension):
        layout.prop(settings, "texture_format")
        layout.prop(settings, "effort")
        row = layout.row()
        row.active = not settings.texture_format.startswith(_ANY_SIZE_PREFIXES)
        row.prop(settings, "use_multiples_of_4")
    if target_files.has_supercompression(extension):
        # ETC1S includes its own compression.
        is_etc1s = settings.texture_format == "etc1s"
        layout.prop(settings, "quality" if is_etc1s else "supercompression")


def _draw_surface(settings: Any, layout: bpy.types.UILayout) -> None:
    layout.prop(settings, "importance", placeholder="Group or attribute")
    layout.prop(settings, "seam_budget")
    layout.prop(settings, "use_subdivision_limit")


def _draw_frames(settings: Any, layout: bpy.types.UILayout) -> None:
    name = "frames" if isinstance(settings, BakeProperties) else "model_frames"
    header, body = layout.panel(f"PREFILTER_{name}", default_closed=True)
    header.use_property_split = False
    header.prop(settings, "use_frames")
    if body:
        column = body.column(align=True)
        column.active = settings.use_frames
        for name in ("frame_start", "frame_end", "frame_step"):
            column.prop(settings, name)


def _draw_lookups(settings: Any, layout: bpy.types.UILayout) -> None:
    layout.prop(settings, "reader")
    row = layout.row()
    row.active = settings.reader == "linear" and settings.filter in FITTED_FILTERS
    row.prop(settings, "lookups")
    column = layout.column(align=True)
    column.prop(settings, "wrap")
    column.prop(settings, "wrap_v", text="V")


class PREFILTER_PG_model(ModelProperties, bpy.types.PropertyGroup):
    """The settings of the panel, stored in the scene.

    The settings that affect levels are shared with `PREFILTER_PG_bake`, so that a bake of all
    images makes the levels that the preview of an image shows.
    """

    __annotations__ = preference_properties(ModelSettings) | shared_properties(
        Settings, BAKE.group, {*NOT_OF_MODELS, *_FILE_SETTINGS}, importance=_SEARCH
    )


class PREFILTER_PG_bake(BakeProperties, bpy.types.PropertyGroup):
    """The settings of the panel, stored in the scene."""

    __annotations__ = preference_properties(ResultSettings, file_format={"update": _follow_format})


register, unregister = registration(
    state(bpy.types.Scene, BAKE.group, PREFILTER_PG_bake),
    state(bpy.types.Scene, MODEL.group, PREFILTER_PG_model),
    classes(preset_menu.panel(BAKE), preset_menu.panel(MODEL)),
)
