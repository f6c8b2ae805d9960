# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.bake_model`: the levels of all images of a model, each in its own file."""

from collections.abc import Callable, Generator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import bpy

from ...core.operator import BackgroundOperator
from ...core.operator_hooks import LONG_WORK, Compute, run_steps
from ...core.presets import PresetsOperator
from ...core.translations import tr
from ...core.wording import Sentence
from ..properties import MODEL, ModelProperties

if TYPE_CHECKING:
    from ..model.bake import ModelBake


class PREFILTER_OT_bake_model(
    ModelProperties, PresetsOperator, BackgroundOperator, bpy.types.Operator
):
    """Bakes all images of a model, one after another."""

    bl_idname = "prefilter.bake_model"
    bl_label = "Bake All Images"
    bl_description = (
        "Make the mipmap levels of every image of the selected meshes, of the scene or of a "
        "material, weighted by the surface that shows it. The nodes tell what an image "
        "holds: color, normals, roughness and other data, cut-outs"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Baking all images"
    queue_name = LONG_WORK
    presets = MODEL

    _model: Any = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether an object shows an image."""
        from ..model import candidates

        if cls.may_be_redone(context):
            return True
        reason = "" if bpy.data.images else tr("There is no image in this file")
        # Only for panels: their cache may be out of date while a script changes the scene.
        if context.area is not None:
            settings = context.scene.prefilter_model
            reason = reason or candidates.missing_reason(
                context, settings.objects, settings.material
            )
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)

    def read(self, context: bpy.types.Context) -> Compute:
        """Plans the bake, and copies the first image and its surfaces."""
        return run_steps(self.read_steps(context))

    def read_steps(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Does the same as `read`, one frame per step."""
        self._model = self._plan(context)
        yield 0.0
        steps = self.read_next_part(context)
        assert steps is not None
        return (yield from steps)

    def read_next_part(self, context: bpy.types.Context) -> Generator[float, None, Compute] | None:
        """Returns a generator that copies the next image and its surfaces."""
        assert self._model is not None
        if not self._model.next_name:
            return None
        self.activity = tr("Baking {}").format(self._model.next_name)
        return self._model.read_steps(context.evaluated_depsgraph_get())

    def build_steps(self) -> Generator[None, None, None]:
        """Makes the level images, one image per step."""
        assert self._model is not None
        return self._model.stage_images_in_steps()

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the results."""
        del context, result
        assert self._model is not None
        self._model.write()
        return self.report_outcome(self._model.results.outcome())

    def discard(self) -> None:
        """Deletes staged files and images."""
        self.discarder()()

    def discarder(self) -> Callable[[], None]:
        """Returns a function that deletes staged files and images."""
        return self._model.discard if self._model is not None else super().discarder()

    def _plan(self, context: bpy.types.Context) -> "ModelBake":
        from prefilter.workflows.files import target_files

        from .. import file_names
        from ..model.bake import ModelBake
        from ..model.candidates import chosen_objects
        from ..model.plan import image_of, plan
        from ..model.results import Results

        own, shared = self.to_settings()
        folder = own.folder if own.result == "file" else ""
        if own.result == "file" and not folder:
            raise ValueError(Sentence("Folder: found none; choose one, or Images as the result"))
        if folder and self.folder.startswith("//") and not bpy.data.is_saved:
            text = (
                "Folder: '{}' is beside the .blend file; save that first, or choose another folder"
            )
            raise ValueError(Sentence(text, self.folder))
        chosen = chosen_objects(context, own.objects)
        planned = plan(
            context.view_layer,
            context.evaluated_depsgraph_get(),
            chosen,
            material=own.material,
            by_role=bool(folder),
        )
        if not planned.items:
            raise ValueError("\n".join(Results(planned.left_out).failure_lines()))
        images = [image_of(item.key) for item in planned.items]
        pattern = file_names.Pattern.in_folder(folder, f".{own.file_format}")
        if not target_files.has_formats(pattern.text):
            shared = replace(shared, texture_format="auto")
        paths = file_names.paths(pattern, images, parts=[item.part for item in planned.items])
        files = {item.key: file for item, file in zip(planned.items, paths, strict=True)}
        return ModelBake(planned, shared, files)
