# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.update_voxels`: updates a result from its sources, in place."""

from collections.abc import Callable, Generator
from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ...core.operator_hooks import LONG_WORK, Compute
from ...core.translations import tr
from ...core.wording import Sentence

if TYPE_CHECKING:
    from ..boolean import Boolean
    from ..updating import Update
    from ..voxelization import Voxelization


class PREFILTER_OT_update_voxels(WorkOperator, bpy.types.Operator):
    """Makes a result again from the present state of its source and operands."""

    bl_idname = "prefilter.update_voxels"
    bl_label = "Update Voxels"
    bl_description = (
        "Run Voxelize or Voxel Boolean again on the sources of the object in their present state, "
        "with the settings of the object"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Updating"
    queue_name = LONG_WORK

    if TYPE_CHECKING:
        work: Voxelization | Boolean | None
        _update: Update | None
    else:
        _update = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is a result to update for the active object."""
        from ..memory import updatable_result

        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if updatable_result(context.active_object) is None:
            cls.poll_message_set(tr("The active object has no stored sources"))
            return False
        return True

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns the active object, as the result may be hidden."""
        return [context.active_object]

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws nothing; the settings belong to the object."""

    def read_work(self, context: bpy.types.Context) -> "Voxelization | Boolean":
        """Copies the sources of the first result to update."""
        from ...bridge.new_meshes import check_editable
        from ..memory import is_changed, updatable_result
        from ..updating import Update

        result = updatable_result(context.active_object)
        if result is None:
            raise ValueError(tr("The active object has no stored sources"))
        check_editable(result)
        if is_changed(result):
            text = "the mesh of '{}' was changed by hand, which is lost; undo brings it back"
            self.warn([Sentence(text, result.name)])
        self._update = Update(result)
        work, warnings = self._update.read(context)
        self.warn(warnings)
        return work

    def read_next_part(self, context: bpy.types.Context) -> Generator[float, None, Compute] | None:
        """Returns a generator that reads the next result, if there is one."""
        assert self._update is not None
        return None if self._update.is_last else self._read_next(context)

    def _read_next(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        assert self.work is not None
        assert self._update is not None
        self._update.put_aside(self.work.result)
        self.work, warnings = self._update.read(context)
        self.warn(warnings)
        return self.work.compute
        yield

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the results."""
        from ..placement import Placement

        assert self.work is not None
        assert self._update is not None
        self.work.placement = Placement.AGAIN
        summary = super().finish(context, result)
        self._update.commit()
        return summary

    def discarder(self) -> Callable[[], None]:
        """Removes the stand-ins for results; returns a callable that releases the rest."""
        if self._update is not None:
            self._update.discard()
        return super().discarder()
