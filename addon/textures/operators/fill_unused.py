# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.fill_unused`: a copy of an image with filled unused texels."""

from functools import partial
from typing import TYPE_CHECKING, Any, cast

import bpy
import numpy as np
import prefilter
from bpy.props import BoolProperty

from ...bridge import editors
from ...core.jobs import Progress
from ...core.operator_hooks import Compute
from ...core.translations import CONTEXT
from ...core.wording import Sentence
from .source import SurfaceOperator, read_source

if TYPE_CHECKING:
    from ...bridge.images import FloatArray
    from ..source import Source


class PREFILTER_OT_fill_unused(SurfaceOperator, bpy.types.Operator):
    """Makes a copy of an image with its unused texels filled."""

    bl_idname = "prefilter.fill_unused"
    bl_label = "Fill Unused Texels"
    bl_description = (
        "Make a copy of the image in which unused texels are filled from the used ones "
        "around them, so that no filter or compressor sees the background"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Filling texels"

    use_in_place: BoolProperty(
        name="Use Copy Everywhere",
        translation_context=CONTEXT,
        description="Make materials and all other users of the image use the copy instead",
        default=False,
    )

    def read(self, context: bpy.types.Context) -> Compute:
        """Copies the image and its surfaces."""
        self._source = read_source(context, self.image, context.scene.prefilter_bake.to_settings())
        self.warn(self._source.warnings)
        return partial(_fill, self._source)

    def finish(self, context: bpy.types.Context, result: "FloatArray") -> str:
        """Writes the copy."""
        from ...bridge import derived, images

        picture = self._source.picture
        filled = derived.write_picture(picture, "filled", result, like_source=True)
        if self.use_in_place:
            images.find(picture.name).user_remap(filled)
        editors.show(context, filled)
        changed = float(np.any(result != picture.stored, axis=2).mean())
        return Sentence("Filled {} of the texels in '{}'", f"{changed:.1%}", filled.name)


def _fill(source: "Source", progress: Progress) -> "FloatArray":
    """Returns the filled image as stored values; used texels keep their values bit for bit."""
    from ...bridge import images

    linear = source.linear(progress)
    with source.naming_objects():
        filled = prefilter.fill_unused(
            linear,
            source.surfaces,
            wrap=cast("Any", source.wrap),
            progress=progress,
            threads=source.threads,
        )
    stored = images.encoded(source.picture, filled)
    is_same = np.all((filled == linear) | (np.isnan(filled) & np.isnan(linear)), axis=2)
    return np.where(is_same[..., None], source.picture.stored, stored)
