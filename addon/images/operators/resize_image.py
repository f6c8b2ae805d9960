# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.resize_image`: resizes an image, beside the old one or in its place."""

from typing import TYPE_CHECKING

import bpy

from ...core.presets import PresetsOperator
from ..properties import RESIZE, ResizeProperties
from .new_image_operator import NewImageOperator

if TYPE_CHECKING:
    from prefilter.workflows.images.resizing import Resizing

    from ...bridge.images import Picture


class PREFILTER_OT_resize_image(
    ResizeProperties, PresetsOperator, NewImageOperator, bpy.types.Operator
):
    """Resizes an image."""

    bl_idname = "prefilter.resize_image"
    bl_label = "Resize Image"
    bl_description = (
        "Make a larger or smaller copy of the image, filtered in linear light, with colors "
        "weighted by alpha"
    )
    bl_options = {"REGISTER", "UNDO"}
    presets = RESIZE
    activity = "Resizing"

    def work_on(self, picture: "Picture") -> "Resizing":
        """Returns the work on an image."""
        from prefilter.workflows.images.resizing import Resizing

        return Resizing(picture, self.to_settings(), keep=self.keep)

    def duration(self, load: tuple[int, int]) -> float:
        """Estimates the duration: pixels read and written, times the cost of the filter."""
        width, height = self.to_settings().new_size(*load)
        costs = {"least-squares": 8.0, "radial2": 6.0, "radial3": 12.0}
        return (load[0] * load[1] + 2.0 * width * height) * costs.get(self.filter, 1.0)
