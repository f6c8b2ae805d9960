# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.import_points`: imports files of points as objects."""

from typing import TYPE_CHECKING, Any

import bpy
from bpy.props import StringProperty
from prefilter.points.extensions import POINT_EXTENSIONS

from ...core.file_browser import FileBrowserOperator
from ...core.operator import WorkOperator
from ...core.translations import tr
from ..properties import RECONSTRUCT, ImportProperties

if TYPE_CHECKING:
    from ..importing import PointsImport


class PREFILTER_OT_import_points(
    ImportProperties, FileBrowserOperator, WorkOperator, bpy.types.Operator
):
    """Imports files of points that the user chooses, each as an object."""

    bl_idname = "prefilter.import_points"
    bl_label = "Import Point Cloud"
    bl_description = (
        "Import the points of scans with their normals, colors and other values, each file as an "
        "object. From LAS, LAZ, E57, PCD, PLY, and text such as XYZ and PTS"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Importing"
    queue_name = "files"

    filter_glob: StringProperty(
        default=";".join(f"*{ending}" for ending in POINT_EXTENSIONS), options={"HIDDEN"}
    )

    if TYPE_CHECKING:
        work: PointsImport | None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether objects can be added."""
        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Switch to Object Mode first"))
            return False
        return True

    def has_file(self) -> bool:
        """Whether files are named."""
        return bool(self.paths())

    def read_work(self, context: bpy.types.Context) -> "PointsImport":
        """Collects the files to read."""
        del context
        from ..importing import PointsImport

        paths = self.paths()
        if not paths:
            raise ValueError("filepath: no file is given")
        return PointsImport(paths, self.to_settings())

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Makes the objects, and starts reconstructing their surface if chosen."""
        from ...bridge.color_materials import show_in_views

        summary = super().finish(context, result)
        assert self.work is not None
        if self.use_show_colors and self.work.has_colors and not self.use_reconstruct:
            show_in_views(context, are_points=True)
        if self.use_reconstruct:
            bpy.ops.prefilter.reconstruct("INVOKE_DEFAULT", **RECONSTRUCT.of_scene(context))
        return summary

    def restart_settings(self) -> dict[str, Any]:
        """Returns the settings and the files."""
        return super().restart_settings() | self.named_files()
