# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.voxelize`: replaces any mesh by a closed surface, through voxels."""

from collections.abc import Sequence
from dataclasses import replace
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
    activity = "Voxelizing"
    presets = VOXELIZE
    modes = frozenset({"OBJECT", "SCULPT"})

    _chosen: list[bpy.types.Object] | None = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether an object is selected that can be voxelized."""
        if not super().poll(context):
            return False
        if cls.may_be_redone(context):
            return True
        if context.mode == "SCULPT":
            return cls._may_be_sculpted(context)
        if not chosen_solids(context):
            cls.poll_message_set(tr("Select an object that has a surface"))
            return False
        return True

    @classmethod
    def _may_be_sculpted(cls, context: bpy.types.Context) -> bool:
        from ...bridge.sculpting import obstacle

        reason = obstacle(context.active_object)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns the selected objects; in Sculpt Mode the sculpted one."""
        return [context.active_object] if context.mode == "SCULPT" else chosen_solids(context)

    def retarget(self, targets: Sequence[bpy.types.ID]) -> None:
        """Keeps the objects that were selected or sculpted when the button was pressed."""
        self._chosen = list(targets)

    def read_work(self, context: bpy.types.Context) -> "Voxelization":
        """Copies the selected objects."""
        from ..voxelization import Voxelization

        chosen = self.targets(context) if self._chosen is None else self._chosen
        self._chosen = None  # The undo before a redo invalidates these objects.
        self.is_alone = chosen == [context.active_object] and context.mode == "SCULPT"
        if self.is_alone:
            return self._read_sculpted(context)
        return Voxelization.read(chosen, self.to_settings(), context.evaluated_depsgraph_get())

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the result, in Sculpt Mode if it was read there."""
        from ...bridge import sculpting

        if not self.is_alone:
            return super().finish(context, result)
        if self.options.is_invoke and not (self.options.is_repeat or self._replaced):
            sculpting.note_before(tr("Before Voxelize"))
        with sculpting.left():
            return super().finish(context, result)

    def _read_sculpted(self, context: bpy.types.Context) -> "Voxelization":
        """Copies the sculpted object; brushes need small triangles, and a mesh."""
        from ...bridge import sculpting
        from ..placement import Placement
        from ..voxelization import Voxelization

        obj = context.active_object
        reason = sculpting.obstacle(obj)
        if reason:
            raise ValueError(reason)
        settings = replace(self.to_settings(), adaptivity=0.0, output="mesh")
        with sculpting.left():
            work = Voxelization.read([obj], settings, context.evaluated_depsgraph_get())
        work.placement = Placement.SCULPTED
        return work
