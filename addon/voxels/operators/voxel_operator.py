"""What the operators share that work on voxels."""

import time
from functools import partial
from typing import Any, ClassVar

import bpy
from bpy.props import BoolProperty

from ...bridge.new_meshes import is_solid
from ...core.operator import BackgroundOperator, Work
from ..boolean import Boolean
from ..voxelization import Voxelization

_QUICK_SECONDS = 1.0
"""Work up to this long may be redone while a user drags a slider."""


class VoxelOperator(BackgroundOperator):
    """A mixin: voxels from the selected objects, with a redo panel where that is quick."""

    work: Voxelization | Boolean
    label: ClassVar[str]

    # Kept between calls of one operation: what a redo costs is known from the first time.
    is_slow: BoolProperty(default=False, options={"HIDDEN", "SKIP_SAVE"})

    def read_work(self, context: bpy.types.Context) -> Voxelization | Boolean:
        """Reads from Blender."""
        raise NotImplementedError

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the settings in the redo panel, unless each change would take long."""
        del context
        if self.is_slow:
            column = self.layout.column()
            column.label(text="This takes too long to adjust here", icon="INFO")
            column.label(text="Undo, change the settings, run again", icon="BLANK1")
        else:
            self.draw_in(self.layout)

    def read(self, context: bpy.types.Context) -> Work:
        """Copies the objects."""
        self._began = time.monotonic()
        self.work = self.read_work(context)
        return partial(_compute, self.work)

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Puts the results into place."""
        del context, result
        outcome = self.work.write()
        self.is_slow = time.monotonic() - self._began > _QUICK_SECONDS
        return self.tell(outcome)

    def discard(self) -> None:
        """Removes what was staged."""
        self.work.discard()

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the operator may run now, whatever is selected."""
        if not super().poll(context):
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to Object Mode first")
            return False
        return True


def chosen_solids(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Returns the selected objects that may show something with an inside."""
    return [obj for obj in context.selected_objects if is_solid(obj)]


def _compute(work: Voxelization | Boolean, progress: Any) -> None:
    try:
        work.compute(progress)
    except BaseException:
        work.discard()
        raise
