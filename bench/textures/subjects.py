# SPDX-License-Identifier: GPL-3.0-or-later

"""Gathered models: images and the surfaces that wear them, as a user of the add-on gets them.

Models are imported by Blender's own importers, and read through the add-on's bridge: the extension
has to be installed and enabled.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
import prefilter
from bl_ext.user_default.prefilter.bridge import images, meshes
from numpy.typing import NDArray

from bench.report import add_json_option
from bench.textures.sampling import Floats, Texels, areas_of, wrapped

DATA = Path(__file__).resolve().parents[3] / "shared/data/textured"
MODELS = (
    "spot",
    "BoomBox",
    "IridescenceLamp",
    "DamagedHelmet",
    "AntiqueCamera",
    "Suzanne",
    "Duck",
    "FlightHelmet",
)
MAGENTA = (1.0, 0.0, 1.0)
WRAP_OF_EXTENSION = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "border"}


@dataclass(frozen=True)
class Subject:
    """An image on its surfaces.

    Attributes:
        name: Its name in tables.
        picture: The image as the add-on reads it.
        image: Its scene-linear values, row 0 at the bottom; where alpha is coverage, colors are
            multiplied by it.
        surfaces: The surfaces that the add-on passes to the library.
        wrap: The wrap mode of the materials, or the one given by --wrap.
        corners: (m, 3, 3) positions and `uvs` (m, 3, 2) of the same triangles, read without the
            add-on and the library.
        uvs: See `corners`.
        parts: (m,) numbers of the objects that they belong to.
    """

    name: str
    picture: images.Picture
    image: Texels
    surfaces: list[prefilter.Surface]
    wrap: str
    corners: Floats
    uvs: Floats
    parts: NDArray[np.int64]

    def painted(self, name: str, unused: NDArray[np.bool_]) -> "Subject":
        """Returns the same with some texels magenta."""
        image = self.image.copy()
        image[unused, :3] = MAGENTA
        return replace(self, name=name, image=image)

    def rounded(self, level: Texels) -> Texels:
        """Returns a level as an 8-bit image datablock of the picture's color space keeps it."""
        if self.picture.alpha_is_straight:
            alpha = level[..., 3:]
            colors = np.divide(
                level[..., :3], alpha, out=np.zeros_like(alpha * level[..., :3]), where=alpha > 0
            )
            level = np.concatenate([colors, alpha], axis=2)
        stored = images.encoded(self.picture, level)
        stored = np.round(255 * stored.clip(0, 1)).astype(np.float32) / 255
        return linear_values(replace(self.picture, texels=stored))


def argument_parser(program: str, description: str) -> argparse.ArgumentParser:
    """Returns a parser with the options that all programs over these models share."""
    parser = argparse.ArgumentParser(prog=program, description=description.splitlines()[0])
    parser.add_argument("models", nargs="*", default=MODELS)
    parser.add_argument(
        "--data",
        type=Path,
        default=DATA,
        help="the folder that holds a folder for each model (default: %(default)s)",
    )
    parser.add_argument(
        "--wrap",
        choices=["auto", *WRAP_OF_EXTENSION.values()],
        default="auto",
        help="the wrap mode; auto: that of the materials, as the add-on does (default: auto)",
    )
    add_json_option(parser)
    return parser


def parse(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """Reads the arguments after Blender's `--`."""
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    for model in options.models:
        if not (options.data / model).is_dir():
            parser.error(f"there is no folder '{options.data / model}'")
    return options


def load(folder: Path, wrap: str) -> Iterator[Subject]:
    """Imports a model and yields each of its images that has pixels, with its surfaces."""
    bpy.ops.wm.read_homefile(use_empty=True)
    for path in folder.glob("*.gltf"):
        bpy.ops.import_scene.gltf(filepath=str(path))
    for path in folder.glob("*_triangulated.obj"):
        bpy.ops.wm.obj_import(filepath=str(path))
    objects = [obj for obj in bpy.context.view_layer.objects if obj.type == "MESH"]
    found = meshes.images_of_objects(objects)
    bare = not found
    if bare:
        found = [bpy.data.images.load(str(path)) for path in folder.glob("*.png")]
    # Only some pictures of a model were gathered.
    found = [image for image in found if image.size[0] > 0]
    for image in found:
        name = folder.name if len(found) == 1 else f"{folder.name}, {image.name}"
        yield read(name, objects, image, wrap, all_faces=bare)


def read(
    name: str,
    objects: Sequence[bpy.types.Object],
    image: bpy.types.Image,
    wrap: str,
    *,
    all_faces: bool,
) -> Subject:
    """Reads an image and its surfaces, through the add-on and without it."""
    picture = images.read(image)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found = meshes.image_surfaces(objects, image, depsgraph, all_faces=all_faces)
    if wrap == "auto":
        wrap = WRAP_OF_EXTENSION[found.extensions[0]]
    corners, uvs, parts = read_triangles(objects, image, all_faces=all_faces)
    area = sum(surface.area for surface in found.surfaces)
    if not np.isclose(areas_of(corners).sum(), area, rtol=1e-5):
        raise ValueError(
            f"{name}: the add-on reads an area of {area}, not {areas_of(corners).sum()}"
        )
    return Subject(name, picture, linear_values(picture), found.surfaces, wrap, corners, uvs, parts)


def linear_values(picture: images.Picture) -> Texels:
    """Returns scene-linear values; colors are multiplied by alpha where that is coverage."""
    values = images.scene_linear(picture)
    if picture.alpha_is_straight:
        values = np.concatenate([values[..., :3] * values[..., 3:], values[..., 3:]], axis=2)
    return values


def read_triangles(
    objects: Sequence[bpy.types.Object], image: bpy.types.Image, *, all_faces: bool
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Returns world positions (m, 3, 3), UVs (m, 3, 2) and objects of the faces with an image."""
    corners, uvs, parts = [], [], []
    for part, obj in enumerate(objects):
        mesh = obj.data
        mesh.calc_loop_triangles()
        layer = mesh.uv_layers.active
        slots = {i for i, material in enumerate(mesh.materials) if shows(material, image)}
        for triangle in mesh.loop_triangles:
            if all_faces or triangle.material_index in slots:
                corners.append([obj.matrix_world @ mesh.vertices[v].co for v in triangle.vertices])
                uvs.append([layer.uv[loop].vector for loop in triangle.loops])
                parts.append(part)
    return np.array(corners, float), np.array(uvs, float), np.array(parts)


def shows(material: bpy.types.Material | None, image: bpy.types.Image) -> bool:
    """Returns whether a material has a node with the image."""
    if material is None or not material.use_nodes:
        return False
    return any(n.type == "TEX_IMAGE" and n.image == image for n in material.node_tree.nodes)


def touched_texels(uvs: Floats, width: int, height: int, wrap: str) -> NDArray[np.bool_]:
    """Returns which texels' squares share an area with some triangle (separating axes)."""
    touched = np.zeros((height, width), bool)
    size = np.array([width, height])
    for triangle in uvs * size:
        edges = np.roll(triangle, -1, axis=0) - triangle
        twice_area = edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]
        if twice_area == 0:
            continue
        low = np.floor(triangle.min(axis=0)).astype(int)
        high = np.ceil(triangle.max(axis=0)).astype(int)
        x, y = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
        meets = np.ones(x.shape, bool)
        for corner, edge in zip(triangle, edges * np.sign(twice_area), strict=True):
            center = edge[0] * (y + 0.5 - corner[1]) - edge[1] * (x + 0.5 - corner[0])
            meets &= center + np.abs(edge).sum() / 2 > 0
        touched[wrapped(y[meets], height, wrap), wrapped(x[meets], width, wrap)] = True
    return touched


def dilated(mask: NDArray[np.bool_], wrap: str) -> NDArray[np.bool_]:
    """Returns the mask with the eight neighbors of each texel."""
    height, width = mask.shape
    rows, columns = np.nonzero(mask)
    result = mask.copy()
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            result[wrapped(rows + dy, height, wrap), wrapped(columns + dx, width, wrap)] = True
    return result
