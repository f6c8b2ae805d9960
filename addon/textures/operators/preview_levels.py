# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.preview_levels` and `prefilter.end_preview`: levels drawn in place of their image."""

from collections.abc import Generator

import bpy

from ...bridge.views import EndsView
from ...core.operator import WorkOperator
from ...core.operator_hooks import Compute, run_steps
from ...core.properties import single_property
from .. import choices
from ..choices import Settings
from ..view import preview
from .source import SurfaceOperator, read_source_steps


class PreviewOperator(WorkOperator, SurfaceOperator):
    """A mixin: computes the levels of an image for a preview."""

    activity = "Computing levels"

    compare: single_property(choices.PreviewSettings, "compare")

    work: preview.PreviewWork | None = None

    @classmethod
    def reads_surface(cls, context: bpy.types.Context) -> bool:
        """Returns whether one of the panels' filters needs a surface."""
        filters = {
            context.scene.prefilter_bake.filter,
            context.window_manager.prefilter_view.compare,
        }
        return not choices.TEXTURE_SPACE_FILTERS.issuperset(filters)

    def read(self, context: bpy.types.Context) -> Compute:
        """Copies the image and its surfaces."""
        return run_steps(self.read_steps(context))

    def read_steps(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Copies the image and its surfaces, one frame per step."""
        settings = context.scene.prefilter_bake.to_settings()
        self.work = yield from read_preview_steps(context, self.image, settings, self.compare)
        return self.work.compute


class PREFILTER_OT_preview_levels(PreviewOperator, bpy.types.Operator):
    """Computes the levels of an image, and shows them in the editors."""

    bl_idname = "prefilter.preview_levels"
    bl_label = "Preview Levels"
    bl_description = (
        "Compute the levels of the image with the settings of the bake, and draw them at "
        "full size in its place. The image itself does not change"
    )
    bl_options = {"REGISTER"}

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Shows the levels in the editors."""
        summary = super().finish(context, result)
        assert self.work is not None
        preview.VIEW.show(context, self.work.image_name)
        return summary


class PREFILTER_OT_end_preview(EndsView, bpy.types.Operator):
    """Deletes the preview of the editor's image."""

    bl_idname = "prefilter.end_preview"
    bl_label = "End Preview"
    bl_description = "Show the image itself again, and free the memory of its levels"
    bl_options = {"REGISTER"}
    view = preview.VIEW
    nothing = "The editor's image has no preview"


def read_preview_steps(
    context: bpy.types.Context, name: str, settings: Settings, compare: str
) -> Generator[float, None, preview.PreviewWork]:
    """Reads an image and its surfaces for a preview, one frame per step.

    Args:
        context: The context.
        name: See `read_source_steps`.
        settings: The settings of the bake.
        compare: The filter on the left of the wipe.

    Yields:
        The fraction done.
    """
    from ...bridge import images

    needs_surface = compare not in choices.TEXTURE_SPACE_FILTERS
    source = yield from read_source_steps(context, name, settings, needs_surface=needs_surface)
    uid = images.find(source.image_name).session_uid
    return preview.PreviewWork(source, uid, (source.settings.filter, compare))
