# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.drop_points`: asks what to make of files of points that are dropped."""

import os

import bpy

from ...core.translations import marked, reported, tr
from ..choices import EXTENSIONS
from ..properties import FilesProperties
from .import_points import PREFILTER_OT_import_points

_CHOICES = (
    (marked("Import Points"), "IMPORT", False),
    (marked("Reconstruct Surface"), "POINTCLOUD_DATA", True),
)
_OTHERS = frozenset({".ply", ".txt", ".obj"})
"""What Blender or other add-ons read, too."""


class PREFILTER_OT_drop_points(FilesProperties, bpy.types.Operator):
    """Opens a menu of what can be done with files of points."""

    bl_idname = "prefilter.drop_points"
    bl_label = "Scan"
    bl_description = "Import files of points, or import them and reconstruct their surface"
    bl_options = frozenset({"INTERNAL"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether objects can be added."""
        return PREFILTER_OT_import_points.poll(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens the menu."""
        del event
        if bpy.app.background:
            return self.execute(context)
        wanted = self.named_files()

        def draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
            del context
            menu.layout.operator_context = "INVOKE_DEFAULT"
            for text, icon, use_reconstruct in _CHOICES:
                name = PREFILTER_OT_import_points.bl_idname
                made = menu.layout.operator(name, text=text, icon=icon)
                made.use_reconstruct = use_reconstruct
                made.filepath, made.directory = wanted["filepath"], wanted["directory"]
                for one in wanted["files"]:
                    made.files.add().name = one["name"]

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
    """Files of points that are dropped onto the 3D view."""

    bl_idname = "PREFILTER_FH_points"
    bl_label = "Point Cloud"
    bl_import_operator = PREFILTER_OT_drop_points.bl_idname
    # Blender compares the last extension of a name: ".gz" of ".ply.gz".
    bl_file_extensions = ";".join(
        os.path.splitext(f"a{ending}")[1] for ending in EXTENSIONS if ending not in _OTHERS
    )

    @classmethod
    def poll_drop(cls, context: bpy.types.Context) -> bool:
        """Tells whether files are dropped where objects are seen."""
        return context.area is not None and context.area.type == "VIEW_3D"
