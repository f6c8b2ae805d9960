# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.rasterize_svg`: an image of an SVG file."""

from typing import TYPE_CHECKING

import bpy
from bpy.props import StringProperty

from ...core.file_browser import FileBrowserOperator
from .shape_operator import RasterizesOperator

if TYPE_CHECKING:
    from ..rasterization import Rasterization


class PREFILTER_OT_rasterize_svg(FileBrowserOperator, RasterizesOperator, bpy.types.Operator):
    """Asks for an SVG file, and rasterizes it."""

    bl_idname = "prefilter.rasterize_svg"
    bl_label = "Rasterize SVG"
    bl_description = "Make an exact image of an SVG file, at any size"
    bl_options = {"REGISTER", "UNDO"}
    source_drawn = "svg"

    filter_glob: StringProperty(default="*.svg;*.svgz", options={"HIDDEN"})

    def has_file(self) -> bool:
        """Returns whether a file is given."""
        return bool(self.filepath)

    def read_work(self, context: bpy.types.Context) -> "Rasterization":
        """Checks the file."""
        from ..provenance import Request
        from ..rasterization import Rasterization

        settings = self.to_settings()
        return Rasterization.read(Request("svg", filepath=settings.filepath), settings, context)


class PREFILTER_FH_svg(bpy.types.FileHandler):
    """Handles SVG files dropped onto the Image editor."""

    bl_idname = "PREFILTER_FH_svg"
    bl_label = "SVG as Image"
    bl_import_operator = PREFILTER_OT_rasterize_svg.bl_idname
    bl_file_extensions = ".svg;.svgz"

    @classmethod
    def poll_drop(cls, context: bpy.types.Context) -> bool:
        """Returns whether the files are dropped onto an Image editor, which shows the image."""
        return context.area is not None and context.area.type == "IMAGE_EDITOR"
