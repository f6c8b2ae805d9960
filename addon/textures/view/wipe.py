# SPDX-License-Identifier: GPL-3.0-or-later

"""Gizmos that drag the wipe between two filters, in the Image editor and the 3D view."""

import bpy

from ...bridge.wipe import WipeGizmo, WipeGroup
from . import on_model, preview


class PREFILTER_GT_level_wipe(WipeGizmo, bpy.types.Gizmo):
    """The line in the Image editor."""

    bl_idname = "PREFILTER_GT_level_wipe"
    view = preview.VIEW


class PREFILTER_GGT_level_wipe(WipeGroup, bpy.types.GizmoGroup):
    """Shows the line when two filters are compared."""

    bl_idname = "PREFILTER_GGT_level_wipe"
    gizmo = PREFILTER_GT_level_wipe
    view = preview.VIEW

    @classmethod
    def is_there(cls, context: bpy.types.Context) -> bool:
        """Returns whether the editor draws the line."""
        state, shown = cls.view.state(context), cls.view.here(context)
        if shown is None or not super().is_there(context):
            return False
        compares = state.compare in shown.levels and state.compare != next(iter(shown.levels))
        return state.use_wipe and compares


class PREFILTER_GT_model_wipe(WipeGizmo, bpy.types.Gizmo):
    """The line in the 3D view."""

    bl_idname = "PREFILTER_GT_model_wipe"
    view = preview.VIEW


class PREFILTER_GGT_model_wipe(WipeGroup, bpy.types.GizmoGroup):
    """Shows the line when two filters are compared on the model."""

    bl_idname = "PREFILTER_GGT_model_wipe"
    bl_space_type = "VIEW_3D"
    gizmo = PREFILTER_GT_model_wipe
    view = preview.VIEW

    @classmethod
    def is_there(cls, context: bpy.types.Context) -> bool:
        """Returns whether the view draws the line."""
        state, shown = cls.view.state(context), on_model.current()
        if shown is None or not (state.use_model and state.use_wipe):
            return False
        return state.compare in shown.levels and state.compare != next(iter(shown.levels))


register, unregister = bpy.utils.register_classes_factory(
    (
        PREFILTER_GT_level_wipe,
        PREFILTER_GGT_level_wipe,
        PREFILTER_GT_model_wipe,
        PREFILTER_GGT_model_wipe,
    )
)
