# SPDX-License-Identifier: GPL-3.0-or-later

"""Menu entry of the importer of point files: File > Import."""

import bpy

from ..core.registration import entry
from .operators.import_points import PREFILTER_OT_import_points


def _draw_import(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.operator(
        PREFILTER_OT_import_points.bl_idname,
        text="Point Cloud (.las/.laz/.e57/.pcd/.xyz/.pts/.ply ...)",
    )


_import = entry(bpy.types.TOPBAR_MT_file_import, _draw_import)
register, unregister = _import.register, _import.unregister
