# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.show_weights` and `prefilter.show_source`: the surface area in each texel."""

from functools import partial
from typing import TYPE_CHECKING, Any, cast

import bpy
import prefilter

from ...bridge import editors
from ...core.jobs import Progress
from ...core.operator_hooks import Compute
from ...core.translations import tr
from ...core.wording import Sentence
from .source import SurfaceOperator, read_source

if TYPE_CHECKING:
    from ..source import Source
    from ..view import weights


class PREFILTER_OT_show_weights(SurfaceOperator, bpy.types.Operator):
    """Makes a picture of texel weights."""

    bl_idname = "prefilter.show_weights"
    bl_label = "Show Texel Weights"
    bl_description = (
        "Make a picture of how much of the meshes' surface lies in each texel of the image"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Weighing texels"

    def read(self, context: bpy.types.Context) -> Compute:
        """Copies the surfaces."""
        self._source = read_source(context, self.image, context.scene.prefilter_bake.to_settings())
        self.warn(self._source.warnings)
        return partial(_weigh, self._source)

    def finish(self, context: bpy.types.Context, result: "weights.Weights") -> str:
        """Writes the picture."""
        from ...bridge import derived

        image = derived.write_picture(self._source.picture, "weights", result.picture)
        editors.show(context, image)
        share = f"{result.used_share:.1%}"
        return Sentence("{} of the texels hold some of the surface; see '{}'", share, image.name)


class PREFILTER_OT_show_source(bpy.types.Operator):
    """Shows the image from which a picture was made."""

    bl_idname = "prefilter.show_source"
    bl_label = "Back to Image"
    bl_description = "Show the image from which this picture was made"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the editor shows a picture made from an image."""
        from ...bridge import derived

        if derived.source_of(getattr(context.space_data, "image", None)) is None:
            cls.poll_message_set(tr("The editor shows no picture that was made from an image"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Shows the image."""
        from ...bridge import derived

        context.space_data.image = derived.source_of(context.space_data.image)
        return {"FINISHED"}


def _weigh(source: "Source", progress: Progress) -> "weights.Weights":
    from ..view import weights

    height, width = source.picture.shape[:2]
    with source.naming_objects():
        texel_weights = prefilter.texel_weights(
            source.surfaces,
            width,
            height,
            wrap=cast("Any", source.wrap),
            progress=progress,
            threads=source.threads,
        )
    used_share = float((texel_weights > 0).mean())
    return weights.Weights(weights.picture(texel_weights), used_share)
