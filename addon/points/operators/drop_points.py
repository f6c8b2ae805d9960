# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.drop_points`: asks whether to import or reconstruct dropped files of points."""

import os

import bpy
from prefilter.points.extensions import POINT_EXTENSIONS

from ...core.translations import marked, reported, tr
from ..properties import FilesProperties
from .import_points import PREFILTER_OT_import_points

_CHOICES = (
    (marked("Import Points"), "IMPORT", False),
    (marked("Reconstruct Surface"), "POINTCLOUD_DATA", True),
)
_OTHERS = frozenset({".ply", ".txt", ".obj"})
"""Extensions of files that Blender or other add-ons read, too."""


class PREFILTER_OT_drop_points(FilesProperties, bpy.types.Operator):
    """Opens a menu with the choices for files of points."""

    bl_idname = "prefilter.drop_points"
    bl_label = "Scan"
    bl_description = "Import files of points, or import them and reconstruct their surface"
    bl_options = frozenset({"INTERNAL"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether objects can be added."""
        return PREFILTER_OT_import_points.poll(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens the menu."""
        del event
        if bpy.app.background:
            return self.execute(context)
        named = self.named_files()

        def draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
            del context
            menu.layout.operator_context = "INVOKE_DEFAULT"
            for text, icon, use_reconstruct in _CHOICES:
                name = PREFILTER_OT_import_points.bl_idname
                properties = menu.layout.operator(name, text=text, icon=icon)
                properties.use_reconstruct = use_reconstruct
                properties.filepath = named["filepath"]
                properties.directory = named["directory"]
                for file in named["files"]:
                    properties.files.add().name = file["name"]

        context.window_manager.popup_menu(draw, title=tr(self.bl_label))
        return {"FINISHED"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Imports the files."""
        del context
        try:
            return set(bpy.ops.prefilter.import_points(**self.named_files()))
        except RuntimeError as error:
            self.report({"ERROR"}, reported(error))
            return {"CANCELLED"}


class PREFILTER_FH_points(bpy.types.FileHandler):
    """Handles files of points dropped onto the 3D view."""

    bl_idname = "PREFILTER_FH_points"
    bl_label = "Point Cloud"
    bl_import_operator = PREFILTER_OT_drop_points.bl_idname
    # Blender compares the last extension of a name: ".gz" of ".ply.gz".
    bl_file_extensions = ";".join(
        os.path.splitext(f"a{each}")[1] for each in POINT_EXTENSIONS if each not in _OTHERS
    )

    @classmethod
    def poll_drop(cls, context: bpy.types.Context) -> bool:
        """Whether files are dropped onto a 3D view."""
        return context.area is not None and context.area.type == "VIEW_3D"
