# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.update_voxels`: a result made again of what it was made of, in place."""

from typing import TYPE_CHECKING

import bpy

from ...core.doing import LONG_WORK
from ...core.operator import WorkOperator
from ...core.translations import tr

if TYPE_CHECKING:
    from ..boolean import Boolean
    from ..voxelization import Voxelization


class PREFILTER_OT_update_voxels(WorkOperator, bpy.types.Operator):
    """Makes an object again, of what it was and what it was combined with are now."""

    bl_idname = "prefilter.update_voxels"
    bl_label = "Update Voxels"
    bl_description = (
        "Run Voxelize or Voxel Boolean again on what the object was made of, as that is now, with "
        "the settings of the object"
    )
    bl_options = {"REGISTER", "UNDO"}
    doing = "Updating"
    line = LONG_WORK

    if TYPE_CHECKING:
        work: Voxelization | Boolean | None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the active object remembers how it was made, or was used for one."""
        from ..memory import made_of

        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if made_of(context.active_object) is None:
            cls.poll_message_set(tr("The active object does not know what it was made of"))
            return False
        return True

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns what is active: the result may be hidden."""
        return [context.active_object]

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws nothing: the object has the settings."""

    def read_work(self, context: bpy.types.Context) -> "Voxelization | Boolean":
        """Copies what the object was made of."""
        from ...bridge.kept_sources import evaluated
        from ...bridge.new_meshes import check_editable
        from ..boolean import Boolean
        from ..choices import BooleanSettings
        from ..memory import made_of, recall
        from ..voxelization import Voxelization

        result = made_of(context.active_object)
        if result is None:
            raise ValueError(tr("The active object does not know what it was made of"))
        check_editable(result)
        request = recall(result)
        self.warn(request.warnings)
        source, operands, settings = request.source, request.operands, request.settings
        with evaluated(result, [source, *operands], context) as depsgraph:
            if isinstance(settings, BooleanSettings):
                return Boolean.read(source, operands, settings, depsgraph, result.name)
            return Voxelization.read([source], settings, depsgraph, result.name)

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the result."""
        from ..showing import Way

        assert self.work is not None
        self.work.way = Way.AGAIN
        return super().finish(context, result)
