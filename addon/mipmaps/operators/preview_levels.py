# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.preview_levels` and `prefilter.end_preview`: levels in the place of their image."""

import bpy
from bpy.props import StringProperty

from ...bridge import editors, images
from ...core.operator import Compute
from ...core.properties import single_property
from .. import choices
from ..view import preview
from .source import ImageOperator, read_source


class PREFILTER_OT_preview_levels(ImageOperator, bpy.types.Operator):
    """Computes the levels of an image for the editors to draw."""

    bl_idname = "prefilter.preview_levels"
    bl_label = "Preview Levels"
    bl_description = (
        "Compute the levels of the image with the settings of the bake, and draw them at full size "
        "in its place. The image itself is left as it is"
    )
    bl_options = {"REGISTER"}
    doing = "Computing levels"

    image: StringProperty(
        name="Image",
        description="The image to preview; the image of the editor if empty",
        options={"SKIP_SAVE"},
    )
    compare: single_property(choices.PreviewSettings, "compare")

    @classmethod
    def reads_surface(cls, context: bpy.types.Context) -> bool:
        """Tells whether one of the filters of the panels looks at a surface."""
        filters = {
            context.scene.prefilter_bake.filter,
            context.window_manager.prefilter_view.compare,
        }
        return not choices.TEXTURE_SPACE_FILTERS.issuperset(filters)

    def read(self, context: bpy.types.Context) -> Compute:
        """Copies the image and its surfaces."""
        settings = context.scene.prefilter_bake.to_settings()
        needs_surface = self.compare not in choices.TEXTURE_SPACE_FILTERS
        source = read_source(context, self.image, settings, needs_surface=needs_surface)
        self.warn(source.warnings)
        self._name = source.image_name
        uid = images.find(self._name).session_uid
        filters = (source.settings.filter, self.compare)
        return lambda progress: preview.compute(source, uid, filters, progress)

    def finish(self, context: bpy.types.Context, result: preview.Preview) -> str:
        """Has the editors draw the levels."""
        preview.keep(result)
        editors.show(context, images.find(self._name))
        context.window_manager.prefilter_view.use_preview = True
        editors.redraw()
        return f"Computed levels 0 to {result.last_level}"


class PREFILTER_OT_end_preview(bpy.types.Operator):
    """Forgets the levels of the editor's image."""

    bl_idname = "prefilter.end_preview"
    bl_label = "End Preview"
    bl_description = "Show the image itself again, and free the memory of its levels"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the editor draws levels."""
        if preview.find(getattr(context.space_data, "image", None)) is None:
            cls.poll_message_set("The editor's image has no preview")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forgets them."""
        preview.drop(context.space_data.image)
        editors.redraw()
        return {"FINISHED"}
