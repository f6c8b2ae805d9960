# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.boolean`: union, intersection and difference of any meshes, through voxels."""

from typing import TYPE_CHECKING

import bpy

from ...core.translations import tr
from ..properties import BOOLEAN, BooleanProperties
from .voxel_operator import VoxelOperator, chosen_solids

if TYPE_CHECKING:
    from ..boolean import Boolean


class PREFILTER_OT_boolean(BooleanProperties, VoxelOperator, bpy.types.Operator):
    """Combines the active object with the other selected ones."""

    bl_idname = "prefilter.boolean"
    bl_label = "Voxel Boolean"
    bl_description = (
        "Combine the active object with the other selected objects, in one grid of voxels. Works "
        "on open, leaky and self-intersecting meshes. The active object gets the result; modifiers "
        "are applied"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Combining"
    presets = BOOLEAN
    _is_resolution_set = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether an editable object is active, and others are selected."""
        from ...bridge.new_meshes import is_editable

        if not super().poll(context):
            return False
        if cls.may_be_redone(context):
            return True
        active = context.active_object
        chosen = chosen_solids(context)
        if active not in chosen:
            cls.poll_message_set(
                tr("Select an object that has a surface, and make it the active one")
            )
            return False
        if len(chosen) < 2:
            cls.poll_message_set(tr("Select one more object that has a surface"))
            return False
        if not is_editable(active):
            cls.poll_message_set(tr("The active object is linked: make it local first"))
            return False
        return True

    def follow_scene(self, context: bpy.types.Context) -> None:
        """Copies the scene's settings; notes first whether the caller sets the resolution."""
        self._is_resolution_set = self._sets_resolution()
        super().follow_scene(context)

    def complete_settings(self) -> None:
        """Completes the settings that the caller left out."""
        if not self.options.is_invoke or self.options.is_repeat:
            self._is_resolution_set = self._sets_resolution()
        super().complete_settings()

    def _sets_resolution(self) -> bool:
        """Whether the caller sets the resolution."""
        is_set = self.properties.is_property_set
        return bool(self.preset) or any(map(is_set, ("resolution", "depth", "voxel_size")))

    def read_work(self, context: bpy.types.Context) -> "Boolean":
        """Copies the selected objects."""
        from ..boolean import Boolean
        from ..memory import with_same_cells

        active = context.active_object
        others = [obj for obj in chosen_solids(context) if obj != active]
        if self._is_resolution_set and not self.options.is_repeat:
            self.use_keep_resolution = False
        settings = self.to_settings()
        if not self._is_resolution_set:
            settings = with_same_cells(active, settings)
            # The redo panel shows these.
            self.resolution, self.voxel_size = settings.resolution, settings.voxel_size
        return Boolean.read(active, others, settings, context.evaluated_depsgraph_get())
