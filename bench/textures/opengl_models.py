# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the models that bench/textures/opengl.py turns, as arrays.

Usage: blender --background --python-exit-code 1 --python bench/textures/opengl_models.py
       (--help lists the options, after --)

Models are imported by Blender's own importers, and read through the add-on's bridge: the extension
has to be installed and enabled. For each, FOLDER/MODEL.npz has images (`image_0`, ...: (height,
width, 3) scene-linear, row 0 at v = 0), their names and wrap modes, and triangles: `corners`
(m, 3, 3) in space, `uvs` (m, 3, 2), and `used` (m,), the number of the image that a triangle wears
as its base color, or -1.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.textures import cycles, subjects
from bench.textures.sampling import Floats

FOLDER = Path(__file__).resolve().parents[2] / "build/opengl"


def main() -> None:
    """Writes the models of the command line."""
    parser = subjects.argument_parser("opengl_models.py", __doc__)
    parser.add_argument("--folder", type=Path, default=FOLDER, help="default: %(default)s")
    options = subjects.parse(parser)
    options.folder.mkdir(parents=True, exist_ok=True)
    for model in options.models:
        write(options.data / model, options.folder / f"{model}.npz", options.wrap)


def write(model: Path, path: Path, wrap: str) -> None:
    """Writes one model."""
    objects = cycles.load(model)
    worn = dict(cycles.base_colors(objects))
    images = list(dict.fromkeys(worn.values()))
    found = [subjects.read(image.name, objects, image, wrap, all_faces=False) for image in images]
    parts = [(subject.corners, subject.uvs, i) for i, subject in enumerate(found)]
    bare = bare_corners(objects, worn)
    parts.append((bare, np.zeros((len(bare), 3, 2)), -1))
    arrays = {f"image_{i}": cycles.linear(image)[..., :3] for i, image in enumerate(images)}
    np.savez(
        path,
        names=[image.name for image in images],
        wraps=[subject.wrap for subject in found],
        corners=np.concatenate([corners for corners, _, _ in parts]),
        uvs=np.concatenate([uvs for _, uvs, _ in parts]),
        used=np.concatenate([np.full(len(corners), i) for corners, _, i in parts]),
        **arrays,
    )
    counts = ", ".join(f"{len(corners)} of {i}" for corners, _, i in parts)
    print(f"{path.name}: {[image.name for image in images]}; triangles: {counts}", flush=True)


def bare_corners(
    objects: Sequence[bpy.types.Object], worn: dict[bpy.types.Material, bpy.types.Image]
) -> Floats:
    """Returns the corners (m, 3, 3) of the triangles without a picture, which may hide others."""
    corners = []
    for obj in objects:
        mesh = obj.data
        mesh.calc_loop_triangles()
        for triangle in mesh.loop_triangles:
            slots = mesh.materials
            material = slots[triangle.material_index] if len(slots) else None
            if material not in worn:
                corners.append([obj.matrix_world @ mesh.vertices[v].co for v in triangle.vertices])
    return np.array(corners, float).reshape(-1, 3, 3)


if __name__ == "__main__":
    main()
