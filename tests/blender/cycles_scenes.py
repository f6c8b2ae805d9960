# SPDX-License-Identifier: GPL-3.0-or-later

"""Scenes for Cycles, the files of its texture cache, and the expected renders."""

from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
import scenes
from numpy.typing import NDArray

Array = NDArray[np.float32]

MAGENTA = (1.0, 0.0, 1.0)
GREEN, BLUE = (0.1, 0.8, 0.2), (0.2, 0.1, 0.9)
HAS_CACHE = "use_texture_cache" in bpy.types.RenderSettings.bl_rna.properties


def bake() -> set[str]:
    """Bakes the texture cache of the scene."""
    return bpy.ops.prefilter.bake_texture_cache()


def generate() -> set[str]:
    """Has Blender make its own."""
    return bpy.ops.render.generate_texture_cache()


def contents(folder: Path) -> dict[Path, bytes]:
    """Returns the files of a folder and its subfolders."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def write_picture(path: Path, pixels: Array, kind: str) -> bpy.types.Image:
    """Writes pixels, row 0 at the bottom, to a file of a pixel type, and loads it."""
    buffer = oiio.ImageBuf(np.ascontiguousarray(pixels[::-1], np.float32))
    assert buffer.write(str(path), kind), buffer.geterror()
    return bpy.data.images.load(str(path))


def emission(name: str, image: bpy.types.Image) -> bpy.types.Material:
    """Makes a material that emits an image."""
    made = bpy.data.materials.new(name)
    scenes.use_nodes(made)
    tree = made.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    texture = scenes.image_node(tree, image)
    tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def shown_on(image: bpy.types.Image, uvs=scenes.UNIT_SQUARE, name="Quad") -> bpy.types.Object:
    """Makes a unit square that emits an image."""
    made = scenes.quads(name, [uvs])
    made.data.materials.append(emission(f"{name} material", image))
    return made


def set_up(scene: bpy.types.Scene) -> None:
    """Sets Cycles up to render the unit square head on, with a box as wide as a pixel."""
    scene.render.engine = "CYCLES"
    if hasattr(scene.render, "use_auto_generate_texture_cache"):
        scene.render.use_auto_generate_texture_cache = False
    scene.render.dither_intensity = 0
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.cycles.device = "CPU"
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.samples = 256
    data = bpy.data.cameras.new("Camera")
    data.type = "ORTHO"
    data.ortho_scale = 1
    scene.camera = bpy.data.objects.new("Camera", data)
    scene.camera.location = (0.5, 0.5, 1)
    scene.collection.objects.link(scene.camera)


def render(scene: bpy.types.Scene, size: int, path: Path) -> Array:
    """Returns a render of (size, size, 3) scene-linear colors, row 0 at the bottom."""
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return oiio.ImageBuf(str(path)).get_pixels("float")[::-1, :, :3]


def cache_files(folder: Path, name: str = "") -> list[Path]:
    """Returns the cache files of an image file, or of all in a folder."""
    return sorted((folder / "blender_tx").glob(f"{name}*.tx"))


def cache_file(folder: Path, name: str = "") -> Path:
    """Returns the one cache file of an image file."""
    (path,) = cache_files(folder, name)
    return path


def level(path: Path, number: int) -> Array:
    """Returns a level as it is stored, row 0 at the bottom."""
    reader = oiio.ImageInput.open(str(path))
    assert reader.seek_subimage(0, number)
    return reader.read_image(0, number, 0, reader.spec().nchannels, "float")[::-1]


def metadata(path: Path) -> dict[str, object]:
    """Returns the attributes of level 0."""
    spec = oiio.ImageInput.open(str(path)).spec()
    found = {attribute.name: attribute.value for attribute in spec.extra_attribs}
    return found | {
        "size": (spec.width, spec.height, spec.nchannels),
        "format": str(spec.format),
        "tile": (spec.tile_width, spec.tile_height),
    }


def looked_up(texels: Array, u: Array, v: Array) -> Array:
    """Returns bilinear lookups of texels, that go on with their edge."""
    height, width = texels.shape[:2]
    x, y = u * width - 0.5, v * height - 0.5
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    right, up = (x - column)[..., None], (y - row)[..., None]

    def texel(i, j):
        return texels[np.clip(j, 0, height - 1), np.clip(i, 0, width - 1)]

    below = texel(column, row) * (1 - right) + texel(column + 1, row) * right
    above = texel(column, row + 1) * (1 - right) + texel(column + 1, row + 1) * right
    return below * (1 - up) + above * up


def pixel_means(texels: Array, size: int, *, is_encoded: bool = False) -> Array:
    """Returns the means over square pixels of Cycles's lookups in a level."""
    samples = 8
    at = (np.arange(size * samples) + 0.5) / (size * samples)
    values = looked_up(texels, *np.meshgrid(at, at))
    if is_encoded:
        values = scenes.to_linear(values)
    return values.reshape(size, samples, size, samples, -1).mean(axis=(1, 3))


def smooth(height: int, width: int, channels: int, *, seed: int = 3) -> Array:
    """Returns values in [0, 1] with detail at every scale."""
    random = np.random.default_rng(seed)
    total = np.zeros((height, width, channels))
    for cell in (1, 2, 4, 8, 16):
        coarse = random.random((height // cell, width // cell, channels))
        total += np.kron(coarse, np.ones((cell, cell, 1))) * cell**0.5
    total -= total.min()
    return (total / total.max()).astype(np.float32)


def udim(tmp_path: Path, *, missing: bool = False) -> bpy.types.Image:
    """Returns a UDIM image of two tiles, magenta except the lower and the upper half."""
    for number, rows, color in ((1001, slice(0, 32), GREEN), (1002, slice(32, 64), BLUE)):
        pixels = np.zeros((64, 64, 3), np.float32)
        pixels[:] = MAGENTA
        pixels[rows] = color
        if number == 1002 and missing:
            continue
        one = write_picture(tmp_path / f"paint.{number}.exr", pixels, "half")
    bpy.data.images.remove(one)
    image = bpy.data.images.load(str(tmp_path / "paint.1001.exr"))
    image.source = "TILED"
    if len(image.tiles) < 2:
        image.tiles.new(1002)
    assert [tile.number for tile in image.tiles] == [1001, 1002]
    return image


def packed_picture(folder: Path, name: str, pixels: Array) -> tuple[bpy.types.Image, bytes]:
    """An image with bytes of a file that is gone, as of Blender's glTF importer."""
    image = write_picture(folder / name, pixels, "uint8")
    data = (folder / name).read_bytes()
    image.pack()
    (folder / name).unlink()
    image.filepath = ""
    return image, data
