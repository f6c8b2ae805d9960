# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.align_scans`: aligns the selected scans with each other."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ...core.operator_hooks import LONG_WORK
from ...core.translations import tr
from ..properties import AlignProperties
from .selected import SelectedScans, selected_scans

if TYPE_CHECKING:
    from ..aligning import Alignment


class PREFILTER_OT_align_scans(AlignProperties, SelectedScans, WorkOperator, bpy.types.Operator):
    """Aligns the selected scans with each other."""

    bl_idname = "prefilter.align_scans"
    bl_label = "Align Scans"
    bl_description = (
        "Move and turn the selected scans a little, so that their surfaces coincide where they "
        "overlap. The active scan stays. They have to be nearly in place"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Aligning"
    queue_name = LONG_WORK

    if TYPE_CHECKING:
        work: Alignment | None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether several scans are selected."""
        if not super().poll(context):
            return False
        if not cls.may_be_redone(context) and len(selected_scans(context)) < 2:
            cls.poll_message_set(tr("Select two scans or more"))
            return False
        return True

    def read_work(self, context: bpy.types.Context) -> "Alignment":
        """Copies the points."""
        from ..aligning import Alignment

        depsgraph = context.evaluated_depsgraph_get()
        return Alignment(self.targets(context), self.to_settings(), depsgraph)
