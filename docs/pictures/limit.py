# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws where the surface of Blender's monkey spends its area: as a mesh, and as its limit surface.

usage: blender --background --python limit.py -- TARGET.png
"""

import importlib
import sys

import addon_utils
import bpy
import numpy as np
import OpenImageIO as oiio
import prefilter

SIZE = 512
PACKAGE = "bl_ext.user_default.prefilter"
# From low to high, relative to an average texel: steps of a perceptually even scale.
COLORS = np.array(
    [(13, 8, 135), (126, 3, 168), (204, 71, 120), (248, 149, 64), (240, 249, 33)], float
)
UNUSED = (40, 40, 40)


def main(target: str) -> None:
    """Writes both maps side by side."""
    assert addon_utils.enable(PACKAGE) is not None
    meshes = importlib.import_module(f"{PACKAGE}.bridge.meshes")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    monkey.modifiers.new("Subdivision", "SUBSURF").levels = 0
    image = bpy.data.images.new("Fur", 4, 4)
    panels = []
    for use_limit in (False, True):
        found = meshes.image_surfaces(
            [monkey],
            image,
            bpy.context.evaluated_depsgraph_get(),
            meshes.SurfaceOptions(subdivision_limit=use_limit),
            all_faces=True,
        )
        panels.append(drawn(prefilter.texel_weights(found.surfaces, SIZE, SIZE)))
    gap = np.full((SIZE, 16, 3), 255, np.uint8)
    picture = np.concatenate([panels[0], gap, panels[1]], axis=1)[::-1]
    if not oiio.ImageBuf(np.ascontiguousarray(picture)).write(target):
        raise SystemExit(f"cannot write {target}")


def drawn(weights: np.ndarray) -> np.ndarray:
    """Returns weights as colors, over two stops to either side of the average."""
    used = weights > 0
    stops = np.log2(np.where(used, weights, 1.0)) / 4 + 0.5
    place = np.clip(stops, 0, 1) * (len(COLORS) - 1)
    colors = [np.interp(place, range(len(COLORS)), channel) for channel in COLORS.T]
    return np.where(used[..., None], np.stack(colors, -1), UNUSED).astype(np.uint8)


main(sys.argv[sys.argv.index("--") + 1])
