# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.preview_on_model` and `prefilter.end_model_preview`: levels drawn on objects."""

import bpy

from ...bridge import editors
from ...core.translations import tr
from ..view import on_model
from .preview_levels import PreviewOperator


class PREFILTER_OT_preview_on_model(PreviewOperator, bpy.types.Operator):
    """Computes the levels of an image, and shows them in the 3D views."""

    bl_idname = "prefilter.preview_on_model"
    bl_label = "Preview on Model"
    bl_description = (
        "Compute the levels of the active object's base color image with the settings of the bake, "
        "and draw them over the objects that show it in the 3D views, without lighting. Nothing of "
        "the scene changes"
    )
    bl_options = {"REGISTER"}

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Shows the levels in the 3D views."""
        summary = super().finish(context, result)
        assert self.work is not None
        on_model.begin(bpy.data.images[self.work.image_name])
        context.window_manager.prefilter_view.use_model = True
        editors.redraw()
        return summary


class PREFILTER_OT_end_model_preview(bpy.types.Operator):
    """Deletes the preview in the 3D views."""

    bl_idname = "prefilter.end_model_preview"
    bl_label = "End Preview on Model"
    bl_description = "Show the objects as they are again, and free the memory of the levels"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the 3D views show levels."""
        del context
        if on_model.current() is None:
            cls.poll_message_set(tr("The 3D views draw no levels"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Deletes it."""
        from ..view import preview

        del context
        image = on_model.shown_image()
        on_model.end()
        if image is not None:
            preview.drop(image)
        editors.redraw()
        return {"FINISHED"}
