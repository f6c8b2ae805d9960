"""Text as triangles, from Blender's own font: it needs no file, no window and no GPU."""

from functools import lru_cache

import bpy
import numpy as np
from numpy.typing import NDArray


@lru_cache(maxsize=256)
def triangles(text: str) -> NDArray[np.float64]:
    """Returns (n, 3, 2) corners of a line of text of size 1.

    The baseline is y = 0, and the line starts at about x = 0. Main thread only.
    """
    curve = bpy.data.curves.new("prefilter lettering", "FONT")
    obj = bpy.data.objects.new("prefilter lettering", curve)
    try:
        curve.body = text
        mesh = obj.to_mesh()
        mesh.calc_loop_triangles()
        corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        positions = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", positions)
        found = positions.reshape(-1, 3)[corners, :2].reshape(-1, 3, 2).astype(np.float64)
        obj.to_mesh_clear()
    finally:
        bpy.data.objects.remove(obj)
        bpy.data.curves.remove(curve)
    found.setflags(write=False)
    return found
