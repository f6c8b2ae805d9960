# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.crop_points`: crops the selected scans to the box of the active object."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ...core.translations import tr
from ..properties import CropProperties
from .selected import SelectedScans, selected_scans

if TYPE_CHECKING:
    from ..cleaning import Cleaning


class PREFILTER_OT_crop_points(CropProperties, SelectedScans, WorkOperator, bpy.types.Operator):
    """Keeps the points of the selected scans in the box of the active object."""

    bl_idname = "prefilter.crop_points"
    bl_label = "Crop Points"
    bl_description = (
        "Keep the points of the selected scans in the bounding box of the active object, such as a "
        "cube that is placed and turned around them"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Cropping"

    if TYPE_CHECKING:
        work: Cleaning | None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether points are selected, and another object is active."""
        if not super().poll(context):
            return False
        if not cls.may_be_redone(context) and _box(context) is None:
            cls.poll_message_set(tr("Select scans, then the object to crop them to"))
            return False
        return True

    def read_work(self, context: bpy.types.Context) -> "Cleaning":
        """Copies the positions of the points, and the box."""
        from ..cleaning import cropping

        box = _box(context)
        if box is None:
            raise ValueError("the active object is a scan itself")
        return cropping(self.targets(context), box, self.to_settings())


def _box(context: bpy.types.Context) -> bpy.types.Object | None:
    active = context.active_object
    return None if active is None or active in selected_scans(context) else active
