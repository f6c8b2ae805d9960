# SPDX-License-Identifier: GPL-3.0-or-later

"""Base of the operators that make voxels."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ...core.operator_hooks import LONG_WORK
from ...core.presets import PresetsOperator
from ...core.translations import tr

if TYPE_CHECKING:
    from ..boolean import Boolean
    from ..steps import Load
    from ..voxelization import Voxelization


class VoxelOperator(PresetsOperator, WorkOperator):
    """A mixin: voxels from the selected objects."""

    queue_name = LONG_WORK
    modes = frozenset({"OBJECT"})
    """Modes in which it runs."""

    if TYPE_CHECKING:
        work: Voxelization | Boolean | None

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the result, and keeps its source if the settings say so."""
        from ..placement import Placement

        assert self.work is not None
        if self.work.placement == Placement.ALONE:
            self.work.placement = Placement.KEEPING
        return super().finish(context, result)

    def load(self) -> "list[Load]":
        """Returns the amount of work done."""
        assert self.work is not None
        return self.work.loads

    def duration(self, load: "list[Load]") -> float:
        """Estimates the duration with the present settings, in seconds."""
        return sum((each.seconds(self.to_settings()) for each in load), 0.0)

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns the selected objects."""
        return chosen_solids(context)

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the operator runs in the present mode."""
        if context.mode not in cls.modes:
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        return True


def chosen_solids(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Returns the selected objects that may show a solid."""
    from ...bridge.new_meshes import is_solid

    return [obj for obj in context.selected_objects if is_solid(obj)]
