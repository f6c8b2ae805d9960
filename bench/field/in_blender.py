# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in Blender: imports a file as its menus do, presses a button, and exports the result.

Usage: blender --background --python in_blender.py -- OPERATOR INPUT RESULT.ply
"""

import sys
from pathlib import Path

import bpy

operator, source, target = sys.argv[sys.argv.index("--") + 1 :]
for obj in list(bpy.data.objects):
    bpy.data.objects.remove(obj)
IMPORTERS = {
    ".stl": lambda: bpy.ops.wm.stl_import(filepath=source),
    ".obj": lambda: bpy.ops.wm.obj_import(filepath=source, forward_axis="Y", up_axis="Z"),
    ".ply": lambda: bpy.ops.wm.ply_import(filepath=source),
}
extension = Path(source).suffix.lower()
if operator == "reconstruct" and extension != ".ply":
    bpy.ops.prefilter.import_points(filepath=source)
elif extension in IMPORTERS:
    IMPORTERS[extension]()
else:
    sys.exit(f"error: Blender has no importer for {extension} files")
bpy.ops.object.select_all(action="SELECT")
bpy.context.view_layer.objects.active = bpy.context.selected_objects[0]
try:
    ended = getattr(bpy.ops.prefilter, operator)()
except RuntimeError as refusal:
    sys.exit(f"error: {refusal}")
print("ended with", *ended)
bpy.ops.wm.ply_export(
    filepath=target,
    export_selected_objects=True,
    export_normals=False,
    export_uv=False,
    export_colors="NONE",
    export_triangulated_mesh=True,
    forward_axis="Y",
    up_axis="Z",
)
