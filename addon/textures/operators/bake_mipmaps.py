# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.bake_mipmaps`: the levels of an image, fitted to the meshes that use it."""

import os
from collections.abc import Generator
from dataclasses import replace
from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ...core.operator_hooks import LONG_WORK, Compute, run_steps
from ...core.presets import PresetsOperator
from ...core.properties import set_unset
from ...core.translations import tr
from ...core.wording import Sentence
from ..choices import TEXTURE_SPACE_FILTERS, Settings
from ..properties import BAKE, BakeProperties
from ..view.preview import VIEW, PreviewWork
from .preview_levels import read_preview_steps
from .source import SurfaceOperator

if TYPE_CHECKING:
    from ..bake import Bake
    from ..udim import TiledBake

_FILE_PROPERTIES = ("filepath", "file_format", "roughness_filepath")


class PREFILTER_OT_bake_mipmaps(
    BakeProperties, PresetsOperator, WorkOperator, SurfaceOperator, bpy.types.Operator
):
    """Bakes the levels of an image; reads in steps, because there may be many frames."""

    bl_idname = "prefilter.bake_mipmaps"
    bl_label = "Bake Mipmaps"
    bl_description = (
        "Make the mipmap levels of the image, weighted by the surface of the objects that use it"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Baking mipmaps"
    queue_name = LONG_WORK
    presets = BAKE

    if TYPE_CHECKING:
        work: Bake | TiledBake | PreviewWork | None

    @classmethod
    def reads_surface(cls, context: bpy.types.Context) -> bool:
        """Returns whether the filter of the panel needs a surface."""
        return context.scene.prefilter_bake.filter not in TEXTURE_SPACE_FILTERS

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)

    def complete_settings(self) -> None:
        """Infers the result from given files, and the format from the extension."""
        from .. import file_names

        is_set = self.properties.is_property_set
        if any(map(is_set, _FILE_PROPERTIES)):
            set_unset(self, {"result": "file"})
        lacks_image = bool(self.roughness_filepath) and not self.roughness
        if lacks_image and is_set("roughness_filepath") and not self.options.is_repeat:
            raise ValueError(Sentence("Roughness File: choose a Roughness image too"))
        file_format = file_names.format_of(self.filepath or self.roughness_filepath)
        if file_format:
            set_unset(self, {"file_format": file_format})
        super().complete_settings()

    def read(self, context: bpy.types.Context) -> Compute:
        """Copies the image and its surfaces."""
        return run_steps(self.read_steps(context))

    def read_steps(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Copies the image and its surfaces, one frame per step."""
        from .. import bake_inputs, users

        image, settings = self.chosen_image(context), self.to_settings()
        self.activity = tr("Baking {}").format(f"'{image.name}'")
        if self.result == "preview":
            compare = context.window_manager.prefilter_view.compare
            self.work = yield from read_preview_steps(context, image.name, settings, compare)
            return self.work.compute
        objects, warnings = users.objects_to_read(context, image, settings.objects)
        self.warn(warnings)
        settings = self._with_files(image, settings)
        depsgraph = context.evaluated_depsgraph_get()
        self.work = yield from bake_inputs.read_steps(
            bake_inputs.Request(image, objects, settings, depsgraph)
        )
        return self.work.compute

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the levels, or shows them in the editors."""
        summary = super().finish(context, result)
        if isinstance(self.work, PreviewWork):
            VIEW.show(context, self.work.image_name)
        return summary

    def _with_files(self, image: bpy.types.Image, settings: Settings) -> Settings:
        """Returns the settings with complete file paths, by default beside the .blend file."""
        from prefilter.workflows.files import patterns

        from ...bridge import images
        from .. import file_names

        paths = (settings.filepath, settings.roughness_filepath)
        own_paths = (self.filepath, self.roughness_filepath)
        if any(
            path and not bpy.data.is_saved and (not own or own.startswith("//"))
            for path, own in zip(paths, own_paths, strict=True)
        ):
            raise ValueError(
                Sentence(
                    "File: goes beside the .blend file; save that first, or choose a file elsewhere"
                )
            )
        filled = []
        for path, name in zip(paths, (image.name, settings.roughness), strict=True):
            folder, last = os.path.split(path)
            patterns.check("File", last, (file_names.NAME,))
            if patterns.has(path, file_names.NAME):
                (path,) = file_names.paths(file_names.Pattern(path), [images.find(name)])
            else:
                path = os.path.join(folder, patterns.filled(last, {}))
            filled.append(path)
        return replace(settings, filepath=filled[0], roughness_filepath=filled[1])
