# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes scenes with large or many images, and bakes them; runs inside Blender.

Usage: blender --background --python bench/textures/large_scene.py -- WORK FOLDER

WORK is `make-picture SIZE`: FOLDER/picture.blend, a torus with an image of SIZE x SIZE bytes;
`make-ship`: FOLDER/ship.blend, many small objects with images in tiles; `bake`, which makes
FOLDER/picture.exr of the first; or `bake-cache`, which bakes the second into the texture cache.
Both bakes print their time and memory.
"""

import math
import shutil
import sys
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "peers"))
from clock import clocked

OBJECTS = 300
MATERIALS = 4
TILES = range(1001, 1011)
TILE_SIZE = 256
KINDS = {"Base Color": "sRGB", "Roughness": "Non-Color", "Metallic": "Non-Color"}
SUBDIVIDED = 3  # One object in so many has a subdivision modifier.


def main(work: str, *arguments: str) -> None:
    """Runs the requested work."""
    if work == "make-picture":
        make_picture(int(arguments[0]), Path(arguments[1]))
    elif work == "make-ship":
        make_ship(Path(arguments[0]))
    elif work == "bake":
        bake(Path(arguments[0]))
    elif work == "bake-cache":
        bake_cache(Path(arguments[0]))
    else:
        raise SystemExit(__doc__)


def make_picture(size: int, folder: Path) -> None:
    """Makes a torus with charts, and a picture with details of all sizes."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    write(folder / "picture.png", picture(size, 3, seed=1))
    image = bpy.data.images.load(str(folder / "picture.png"))
    torus = grid("Torus", 96, 48, torus_point)
    torus.data.materials.append(material("Paint", {"Base Color": image}))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "picture.blend"))


def make_ship(folder: Path) -> None:
    """Makes many small parts, some of them subdivided, that share images in tiles."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.engine = "CYCLES"
    made = []
    for index in range(MATERIALS):
        maps = {}
        for kind, space in KINDS.items():
            stem = f"{kind.lower().replace(' ', '_')}_{index}"
            for number in TILES:
                seed = 1000 * index + number + 7 * len(maps)
                pixels = picture(TILE_SIZE, 3, seed=seed)
                write(folder / f"{stem}.{number}.png", pixels)
            image = bpy.data.images.load(str(folder / f"{stem}.{TILES[0]}.png"))
            image.source = "TILED"
            image.filepath = str(folder / f"{stem}.<UDIM>.png")
            for number in TILES[1:]:
                image.tiles.new(number)
            image.colorspace_settings.name = space
            maps[kind] = image
        made.append(material(f"Hull {index}", maps))
    random = np.random.default_rng(5)
    for index in range(OBJECTS):
        tile = index // MATERIALS % len(TILES)
        corner = np.array((tile, 0.0)) + 0.75 * random.random(2)
        part = grid(f"Part {index}", 12, 8, torus_point, corner, 0.25)
        part.location = 20 * random.random(3)
        part.scale = 0.2 + random.random(3)
        part.data.materials.append(made[index % MATERIALS])
        if index % SUBDIVIDED == 0:
            part.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "ship.blend"))


def bake(folder: Path) -> None:
    """Bakes the picture to an OpenEXR file with the extension as it is installed."""
    bpy.ops.wm.open_mainfile(filepath=str(folder / "picture.blend"))
    target = str(folder / "picture.exr")
    clocked(lambda: bpy.ops.prefilter.bake_mipmaps(image="picture.png", filepath=target))


def bake_cache(folder: Path) -> None:
    """Bakes the scene of tiles into the texture cache."""
    shutil.rmtree(folder / "blender_tx", ignore_errors=True)
    bpy.ops.wm.open_mainfile(filepath=str(folder / "ship.blend"))
    clocked(bpy.ops.prefilter.bake_texture_cache)


def picture(size: int, channels: int, *, seed: int) -> NDArray[np.uint8]:
    """Returns a picture with the spectrum of a photograph."""
    random = np.random.default_rng(seed)
    pixels = np.full((size, size, channels), 110, np.float32)
    cells = 4
    while cells <= size:
        values = random.standard_normal((cells, cells, channels)).astype(np.float32)
        pixels += (
            160 / cells**0.5 * np.repeat(np.repeat(values, size // cells, 0), size // cells, 1)
        )
        cells *= 2
    return pixels.clip(0, 255).astype(np.uint8)


def write(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Writes a picture file."""
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, "uint8")
    spec.attribute("png:compressionLevel", 1)
    file = oiio.ImageOutput.create(str(path))
    if not (file.open(str(path), spec) and file.write_image(pixels) and file.close()):
        raise OSError(file.geterror())


def material(name: str, maps: dict[str, bpy.types.Image]) -> bpy.types.Material:
    """Makes a material whose shader gets these inputs from images."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader = nodes.get("Principled BSDF") or nodes.new("ShaderNodeBsdfPrincipled")
    for kind, image in maps.items():
        node = nodes.new("ShaderNodeTexImage")
        node.image = image
        links.new(node.outputs["Color"], shader.inputs[kind])
    return made


def torus_point(u: float, v: float) -> tuple[float, float, float]:
    """Returns the point of a torus at angles of u and v turns."""
    ring = 1.0 + 0.4 * math.cos(math.tau * v)
    return (
        ring * math.cos(math.tau * u),
        ring * math.sin(math.tau * u),
        0.4 * math.sin(math.tau * v),
    )


def grid(name, columns, rows, point, corner=(0.0, 0.0), side=1.0) -> bpy.types.Object:
    """Makes an object of a grid of quads, with a chart of `side` at `corner`."""
    places = [(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    faces = [
        (k, k + 1, k + columns + 2, k + columns + 1)
        for k in (j * (columns + 1) + i for j in range(rows) for i in range(columns))
    ]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([point(*place) for place in places], [], faces)
    uvs = np.float32(np.array(places)[np.array(faces).ravel()] * side + corner)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uvs.ravel())
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1 :])
