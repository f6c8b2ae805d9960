# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.voxelize`: a closed surface in place of any mesh, through voxels."""

from typing import TYPE_CHECKING

import bpy

from ...core.translations import tr
from ..properties import VOXELIZE, VoxelizeProperties
from .voxel_operator import VoxelOperator, chosen_solids

if TYPE_CHECKING:
    from ..voxelization import Voxelization


class PREFILTER_OT_voxelize(VoxelizeProperties, VoxelOperator, bpy.types.Operator):
    """Voxelizes each of the selected objects."""

    bl_idname = "prefilter.voxelize"
    bl_label = "Voxelize"
    bl_description = (
        "Give each selected object a closed surface, computed from the exact share of every "
        "voxel that it fills. Works on open, leaky and self-intersecting meshes. Modifiers "
        "are applied"
    )
    bl_options = {"REGISTER", "UNDO"}
    doing = "Voxelizing"
    presets = VOXELIZE

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether an object is selected that can be voxelized."""
        if not super().poll(context):
            return False
        if cls.may_be_redone(context):
            return True
        if not chosen_solids(context):
            cls.poll_message_set(tr("Select an object that has a surface"))
            return False
        return True

    def read_work(self, context: bpy.types.Context) -> "Voxelization":
        """Copies the selected objects."""
        from ..voxelization import Voxelization

        return Voxelization.read(
            chosen_solids(context), self.to_settings(), context.evaluated_depsgraph_get()
        )
