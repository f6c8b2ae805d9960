# SPDX-License-Identifier: GPL-3.0-or-later

"""Base of the operators on the selected scans."""

import bpy

from ...core.operator_hooks import OperatorHooks
from ...core.translations import tr


class SelectedScans(OperatorHooks):
    """A mixin: works on the selected objects with points."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether points are selected."""
        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        if cls.may_be_redone(context):
            return True
        if not cls.chosen(context):
            cls.poll_message_set(tr("Select objects with vertices and no faces, or point clouds"))
            return False
        return True

    @classmethod
    def chosen(cls, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns the selected objects with points, the active one first."""
        return selected_scans(context)

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns the selected objects with points."""
        return self.chosen(context)


def selected_scans(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Returns the selected objects with points of their own, the active one first."""
    from ...bridge.kept_points import may_lose_points

    scans = [obj for obj in context.selected_objects if may_lose_points(obj)]
    return sorted(scans, key=lambda obj: obj != context.active_object)
