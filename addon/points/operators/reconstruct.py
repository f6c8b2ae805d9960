# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.reconstruct`: reconstructs the surface of points as a new object."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ...core.operator_hooks import LONG_WORK
from ...core.presets import PresetsOperator
from ...core.translations import report
from ..properties import RECONSTRUCT, ScanProperties
from .selected import SelectedScans

if TYPE_CHECKING:
    from ..reconstruction import Load, ObjectsReconstruction


class PREFILTER_OT_reconstruct(
    ScanProperties, SelectedScans, PresetsOperator, WorkOperator, bpy.types.Operator
):
    """Reconstructs the surface of the selected points."""

    bl_idname = "prefilter.reconstruct"
    bl_label = "Reconstruct Surface"
    bl_description = (
        "Make one surface from the points of all selected scans: meshes without "
        "faces and point clouds. Normals are estimated for points without the attribute "
        "'normal'"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Reconstructing"
    queue_name = LONG_WORK
    presets = RECONSTRUCT

    if TYPE_CHECKING:
        work: ObjectsReconstruction | None

    @classmethod
    def chosen(cls, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns the selected points, including points from modifiers."""
        from ...bridge.points import may_be_points

        return [obj for obj in context.selected_objects if may_be_points(obj)]

    def complete_settings(self) -> None:
        """Completes the settings; a given depth or voxel size also sets the kind of resolution."""
        named = self.properties.is_property_set
        if not named("resolution") and (named("depth") or named("voxel_size")):
            self.resolution = "depth" if named("depth") else "size"
        super().complete_settings()

    def read_work(self, context: bpy.types.Context) -> "ObjectsReconstruction":
        """Copies the selected points."""
        from ..reconstruction import ObjectsReconstruction

        return ObjectsReconstruction.read(
            self.chosen(context),
            context.active_object,
            self.to_settings(),
            context.evaluated_depsgraph_get(),
        )

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Makes the object, and makes 3D views show its colors."""
        from ...bridge.color_materials import show_in_views

        summary = super().finish(context, result)
        assert self.work is not None
        if self.work.has_colors and show_in_views(context, are_points=False):
            self.report({"INFO"}, report("3D views in Solid mode show color attributes now"))
        return summary

    def load(self) -> "Load":
        """Returns the amount of work done."""
        assert self.work is not None
        return self.work.load

    def duration(self, load: "Load") -> float:
        """Estimates the duration with the present settings, in seconds."""
        return load.seconds(self.to_settings())

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)
