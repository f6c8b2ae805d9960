# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.paint_texture`: paints a texture of the active mesh from the selected scans."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ...core.operator_hooks import LONG_WORK
from ...core.translations import tr
from ..properties import PaintProperties
from .selected import SelectedScans, selected_scans

if TYPE_CHECKING:
    from ..painting import Painting


class PREFILTER_OT_paint_texture(PaintProperties, SelectedScans, WorkOperator, bpy.types.Operator):
    """Makes a texture of the active mesh from the colors of the selected scans."""

    bl_idname = "prefilter.paint_texture"
    bl_label = "Colors to Texture"
    bl_description = (
        "Make a texture of the active mesh from the colors of the selected scans, such as those "
        "that it was reconstructed from. A mesh without a UV map is unwrapped"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Painting"
    queue_name = LONG_WORK

    if TYPE_CHECKING:
        work: Painting | None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether points are selected, and a mesh with faces is active."""
        if not super().poll(context):
            return False
        if not cls.may_be_redone(context) and not _is_surface(context):
            cls.poll_message_set(tr("Select scans with colors, then the mesh that gets them"))
            return False
        return True

    def read_work(self, context: bpy.types.Context) -> "Painting":
        """Copies the points and the mesh."""
        from ..painting import Painting

        if not _is_surface(context):
            raise ValueError("the active object has no faces")
        depsgraph = context.evaluated_depsgraph_get()
        settings = self.to_settings()
        return Painting(context.active_object, self.targets(context), settings, depsgraph)


def _is_surface(context: bpy.types.Context) -> bool:
    active = context.active_object
    return (
        active is not None
        and active.type == "MESH"
        and active.is_editable
        and len(active.data.polygons) > 0
        and active not in selected_scans(context)
    )
