# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.bake_model`: the levels of every image of a model, each in a file of its own."""

from collections.abc import Callable, Generator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import bpy

from ...core.doing import LONG_WORK, Compute, read_at_once
from ...core.operator import BackgroundOperator
from ...core.presets import PresetsOperator
from ...core.translations import tr
from ...core.wording import Sentence
from ..properties import MODEL, ModelProperties

if TYPE_CHECKING:
    from ..model.bake import ModelBake


class PREFILTER_OT_bake_model(
    ModelProperties, PresetsOperator, BackgroundOperator, bpy.types.Operator
):
    """Bakes image after image: one is read when that before it is computed."""

    bl_idname = "prefilter.bake_model"
    bl_label = "Bake All Images"
    bl_description = (
        "Make the mipmap levels of every image of the selected meshes, of the scene or of a "
        "material, weighted by the surface that shows it. The nodes tell what an image "
        "holds: color, normals, roughness and other data, cut-outs"
    )
    bl_options = {"REGISTER", "UNDO"}
    doing = "Baking all images"
    line = LONG_WORK
    presets = MODEL

    _model: Any = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether an object shows an image."""
        from ..model import known

        if cls.may_be_redone(context):
            return True
        reason = "" if bpy.data.images else tr("There is no image in this file")
        # Scripts may have changed the scene just now, which panels hear of later.
        if context.area is not None:
            settings = context.scene.prefilter_model
            reason = reason or known.why_none(context, settings.objects, settings.material)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)

    def read(self, context: bpy.types.Context) -> Compute:
        """Looks what there is, and copies the first image and its surfaces."""
        return read_at_once(self.reading(context))

    def reading(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Does what `read` does, frame after frame."""
        self._model = self._planned(context)
        yield 0.0
        following = self.following(context)
        assert following is not None
        return (yield from following)

    def following(self, context: bpy.types.Context) -> Generator[float, None, Compute] | None:
        """Returns what copies the next image and its surfaces."""
        assert self._model is not None
        if not self._model.next_name:
            return None
        self.doing = tr("Baking {}").format(self._model.next_name)
        return self._model.reading(context.evaluated_depsgraph_get())

    def making(self) -> Generator[None, None, None]:
        """Makes the level images, those of an image at a time."""
        assert self._model is not None
        return self._model.staging_images()

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes what was baked."""
        del context, result
        assert self._model is not None
        self._model.write()
        return self.tell(self._model.results.outcome())

    def discard(self) -> None:
        """Removes what was staged."""
        self.releaser()()

    def releaser(self) -> Callable[[], None]:
        """Returns what removes what was staged."""
        return self._model.discard if self._model is not None else super().releaser()

    def _planned(self, context: bpy.types.Context) -> "ModelBake":
        from prefilter.workflows.files import target_files

        from .. import file_names
        from ..model.bake import ModelBake
        from ..model.known import chosen_objects
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
            raise ValueError("\n".join(Results(planned.left_out).nothing()))
        images = [image_of(item.key) for item in planned.items]
        pattern = file_names.Pattern.in_folder(folder, f".{own.file_format}")
        if not target_files.has_formats(pattern.text):
            shared = replace(shared, texture_format="auto")
        paths = file_names.paths(pattern, images, parts=[item.part for item in planned.items])
        files = {item.key: file for item, file in zip(planned.items, paths, strict=True)}
        return ModelBake(planned, shared, files)
