# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.resample_image`: scales and rotates an image, or warps it by its corners."""

from typing import TYPE_CHECKING

import bpy

from ...core.presets import PresetsOperator
from ..properties import RESAMPLE, ResampleProperties
from .new_image_operator import NewImageOperator

if TYPE_CHECKING:
    from prefilter.workflows.images.resampling import Resampling

    from ...bridge.images import Picture


class PREFILTER_OT_resample_image(
    ResampleProperties, PresetsOperator, NewImageOperator, bpy.types.Operator
):
    """Resamples an image."""

    bl_idname = "prefilter.resample_image"
    bl_label = "Resample Image"
    bl_description = (
        "Make a copy of the image that is scaled and rotated, pinned by its corners or "
        "rectified, filtered in linear light, with colors weighted by alpha"
    )
    bl_options = {"REGISTER", "UNDO"}
    presets = RESAMPLE
    activity = "Resampling"

    def chosen_image(self, context: bpy.types.Context) -> bpy.types.Image:
        """Returns the named image, or the source of the shown one."""
        image = super().chosen_image(context)
        return image if self.image else self.source_of(image)

    def work_on(self, picture: "Picture") -> "Resampling":
        """Returns the work on an image."""
        from prefilter.workflows.images.resampling import Resampling

        return Resampling(picture, self.to_settings(), keep=self.keep)

    def duration(self, load: tuple[int, int]) -> float:
        """Estimates the duration."""
        from prefilter.workflows.images.resampling import effort

        return effort(self.to_settings(), *load)
