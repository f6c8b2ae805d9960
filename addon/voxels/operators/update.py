# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.update_voxels`: a result made again of what it was made of, in place."""

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
    """Makes an object again, of what it was and what it was combined with are now."""

    bl_idname = "prefilter.update_voxels"
    bl_label = "Update Voxels"
    bl_description = (
        "Run Voxelize or Voxel Boolean again on what the object was made of, as that is now, with "
        "the settings of the object"
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
        """Copies what the first was made of that is made again."""
        from ...bridge.new_meshes import check_editable
        from ..memory import is_changed, made_of
        from ..updating import Update

        result = made_of(context.active_object)
        if result is None:
            raise ValueError(tr("The active object does not know what it was made of"))
        check_editable(result)
        if is_changed(result):
            text = "the mesh of '{}' was changed by hand, which is lost; undo brings it back"
            self.warn([Sentence(text, result.name)])
        self._update = Update(result)
        work, warnings = self._update.read(context)
        self.warn(warnings)
        return work

    def read_next_part(self, context: bpy.types.Context) -> Generator[float, None, Compute] | None:
        """Returns what reads the next that was made of the one before."""
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
        from ..showing import Way

        assert self.work is not None
        assert self._update is not None
        self.work.way = Way.AGAIN
        said = super().finish(context, result)
        self._update.commit()
        return said

    def discarder(self) -> Callable[[], None]:
        """Removes what stands in for results, and returns what removes the rest."""
        if self._update is not None:
            self._update.discard()
        return super().discarder()
