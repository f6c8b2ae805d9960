# SPDX-License-Identifier: GPL-3.0-or-later

"""A gizmo that drags the line between the halves of a preview plane, in the Image editor."""

import bpy

from ...bridge.wipe import WipeGizmo, WipeGroup
from . import plane


class PREFILTER_GT_plane_wipe(WipeGizmo, bpy.types.Gizmo):
    """The line."""

    bl_idname = "PREFILTER_GT_plane_wipe"
    view = plane.VIEW


class PREFILTER_GGT_plane_wipe(WipeGroup, bpy.types.GizmoGroup):
    """Shows the line when a plane is drawn."""

    bl_idname = "PREFILTER_GGT_plane_wipe"
    gizmo = PREFILTER_GT_plane_wipe
    view = plane.VIEW


register, unregister = bpy.utils.register_classes_factory(
    (PREFILTER_GT_plane_wipe, PREFILTER_GGT_plane_wipe)
)
