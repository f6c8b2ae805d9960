# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures Cycles's renders with PAM in its texture cache, against the cache that Blender makes.

Usage: blender --background --python-exit-code 1 --python bench/textures/cycles.py -- [MODEL...]
       (--help lists the options; Blender 5.2 or later is needed)

Each model gets an emission shader with its base color, and is rendered from four sides by an
orthographic camera with a box pixel filter: without the cache (the reference), with Blender's, and
with the one of `prefilter.bake_texture_cache`. The figure is the RMSE against the reference, in
scene-linear values, over the pixels that the model covers fully in it. Ends with status 1 if a
criterion of docs/benchmarks/renders.md does not hold.
"""

import argparse
import math
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
import prefilter
from mathutils import Euler, Vector
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.textures import subjects

Texels = NDArray[np.float32]

MODELS = ("spot", "DamagedHelmet")
BARS = {("spot", "clean"): 0.77, ("spot", "painted"): 0.62}
NO_LOSS = 1.0
KINDS = {"float": ".exr", "8-bit sRGB": ".png"}
VIEWS = 4
ELEVATION = math.radians(25)
CACHES = ("box", "PAM")


@dataclass(frozen=True)
class Frame:
    """A render: (height, width, 3) scene-linear colors, and the covered share of each pixel."""

    colors: Texels
    coverage: Texels


def main() -> None:
    """Measures the models of the command line."""
    options = parse()
    report = Report()
    rows = []
    for model in options.models:
        for painted in (False, True):
            for kind in KINDS:
                with tempfile.TemporaryDirectory() as folder:
                    errors = measure(options, model, kind, Path(folder), painted=painted)
                rows.extend(judge(report, model, kind, errors, painted=painted))
    head = ["model", "texels nobody reads", "image", "pixels", *CACHES, "PAM / box"]
    report.table(f"RMSE of renders, {options.samples} samples", head, rows, "error")
    report.write(options.json)
    if report.failures:
        raise SystemExit("\n".join(report.failures))


def parse() -> argparse.Namespace:
    """Reads the arguments after Blender's `--`."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="cycles.py", description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=MODELS)
    parser.add_argument(
        "--data",
        type=Path,
        default=Path(__file__).resolve().parents[3] / "shared/data/textured",
        help="the folder that holds a folder for each model (default: %(default)s)",
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[128, 48], metavar="PIXELS")
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--reference", type=int, default=1024, help="samples of the reference")
    add_json_option(parser)
    options = parser.parse_args(arguments)
    for model in options.models:
        if not (options.data / model).is_dir():
            parser.error(f"there is no folder '{options.data / model}'")
    return options


def measure(
    options: argparse.Namespace, model: str, kind: str, folder: Path, *, painted: bool
) -> dict[int, dict[str, float]]:
    """Returns the RMSE over all views, by the size of the render and the cache."""
    objects = load(options.data / model)
    worn = base_colors(objects)
    emitted = {}
    for image in dict.fromkeys(image for _, image in worn):
        pixels = linear(image)
        if painted:
            pixels[unused(objects, image)] = (*subjects.MAGENTA, 1.0)
        emitted[image] = write(pixels, folder / f"{image.name}{KINDS[kind]}")
    for material, image in worn:
        emit(material, emitted[image])
    scene = bpy.context.scene
    set_up(scene, objects)
    frames: dict[str, dict[tuple[int, int], Frame]] = {}
    for cache in ("none", *CACHES):
        scene.render.use_texture_cache = cache != "none"
        if cache == "box":
            bpy.ops.render.generate_texture_cache()
        elif cache == "PAM":
            bpy.ops.prefilter.bake_texture_cache()
        scene.cycles.samples = options.reference if cache == "none" else options.samples
        frames[cache] = {
            (size, view): render(scene, objects, size, view, folder / "render.exr")
            for size in options.sizes
            for view in range(VIEWS)
        }
    return {
        size: {cache: rmse(frames[cache], frames["none"], size) for cache in CACHES}
        for size in options.sizes
    }


def judge(
    report: Report,
    model: str,
    kind: str,
    errors: dict[int, dict[str, float]],
    *,
    painted: bool,
) -> list[list[str]]:
    """Returns rows of a table, and adds whether the criteria hold to the report."""
    which = "painted" if painted else "clean"
    bar = BARS.get((model, which), NO_LOSS)
    rows = []
    for size, found in errors.items():
        ratio = found["PAM"] / found["box"]
        rows.append(
            [model, which, kind, str(size), *(f"{found[c]:.5f}" for c in CACHES), f"{ratio:.3f}"]
        )
        report.verdict(
            ratio <= bar, f"{model}, {which}, {kind}, {size} pixels: {ratio:.3f}, at most {bar}"
        )
    return rows


def load(folder: Path) -> list[bpy.types.Object]:
    """Imports a model into an empty scene; a bare one gets the picture beside it."""
    bpy.ops.wm.read_homefile(use_empty=True)
    for path in folder.glob("*.gltf"):
        bpy.ops.import_scene.gltf(filepath=str(path))
    for path in folder.glob("*_triangulated.obj"):
        bpy.ops.wm.obj_import(filepath=str(path))
    objects = [obj for obj in bpy.context.view_layer.objects if obj.type == "MESH"]
    if not base_colors(objects):
        (path,) = folder.glob("*.png")
        material = bpy.data.materials.new(folder.name)
        material.use_nodes = True
        node = material.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.load(str(path))
        shader = material.node_tree.nodes["Principled BSDF"]
        material.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
        for obj in objects:
            obj.data.materials.clear()
            obj.data.materials.append(material)
    return objects


def base_colors(
    objects: Sequence[bpy.types.Object],
) -> list[tuple[bpy.types.Material, bpy.types.Image]]:
    """Returns the materials whose base color is a picture that was gathered, and that picture."""
    found = {}
    for obj in objects:
        for material in obj.data.materials:
            for node in material.node_tree.nodes if material is not None else ():
                is_base = node.type == "TEX_IMAGE" and any(
                    link.to_socket.name == "Base Color" for link in node.outputs["Color"].links
                )
                if is_base and node.image is not None and node.image.size[0] > 0:
                    found[material] = node.image
    return list(found.items())


def linear(image: bpy.types.Image) -> Texels:
    """Returns an image's opaque scene-linear pixels."""
    read = subjects.images.read(image)
    pixels = np.ones((*read.shape[:2], 4), np.float32)
    pixels[..., :3] = subjects.images.scene_linear(read)[..., :3]
    return pixels


def unused(objects: Sequence[bpy.types.Object], image: bpy.types.Image) -> NDArray[np.bool_]:
    """Returns which texels no lookup on the objects reads: no triangle touches one beside them."""
    _, uvs, _ = subjects.read_triangles(objects, image, all_faces=False)
    width, height = image.size
    return ~subjects.dilated(subjects.touched_texels(uvs, width, height, "repeat"), "repeat")


def write(pixels: Texels, path: Path) -> bpy.types.Image:
    """Writes scene-linear pixels, row 0 at the bottom, to an EXR or an 8-bit sRGB file."""
    is_float = path.suffix == ".exr"
    stored = pixels if is_float else prefilter.to_srgb(pixels)
    buffer = oiio.ImageBuf(np.ascontiguousarray(stored[::-1, :, :3]))
    if not buffer.write(str(path), "float" if is_float else "uint8"):
        raise OSError(buffer.geterror())
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Linear Rec.709" if is_float else "sRGB"
    return image


def emit(material: bpy.types.Material, image: bpy.types.Image) -> None:
    """Lets a material emit an image."""
    tree = material.node_tree
    tree.nodes.clear()
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    shader = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])


def set_up(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> None:
    """Sets the renderer and a camera up; materials without a picture are black."""
    textured = {material for material, _ in emitting(objects)}
    for material in bpy.data.materials:
        if material not in textured and material.node_tree is not None:
            material.node_tree.nodes.clear()
    scene.world = None
    scene.render.engine = "CYCLES"
    scene.render.film_transparent = True
    scene.render.dither_intensity = 0
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "RGBA"
    scene.cycles.device = "CPU"
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0
    camera = bpy.data.cameras.new("Camera")
    camera.type = "ORTHO"
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.collection.objects.link(scene.camera)


def emitting(
    objects: Sequence[bpy.types.Object],
) -> list[tuple[bpy.types.Material, bpy.types.Image]]:
    """Returns the materials that emit an image."""
    return [
        (material, node.image)
        for obj in objects
        for material in obj.data.materials
        if material is not None
        for node in material.node_tree.nodes
        if node.type == "TEX_IMAGE" and any(n.type == "EMISSION" for n in material.node_tree.nodes)
    ]


def render(
    scene: bpy.types.Scene, objects: Sequence[bpy.types.Object], size: int, view: int, path: Path
) -> Frame:
    """Renders a square picture of the objects from one of the sides."""
    corners = [obj.matrix_world @ Vector(corner) for obj in objects for corner in obj.bound_box]
    center = sum(corners, Vector()) / len(corners)
    radius = max((corner - center).length for corner in corners)
    turn = Euler((math.pi / 2 - ELEVATION, 0, 2 * math.pi * view / VIEWS + math.pi / 7))
    camera = scene.camera
    camera.rotation_euler = turn
    camera.location = center + turn.to_matrix() @ Vector((0, 0, 3 * radius))
    camera.data.ortho_scale = 2 * radius
    camera.data.clip_start, camera.data.clip_end = 0.1 * radius, 10 * radius
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    pixels = oiio.ImageBuf(str(path)).get_pixels("float")
    path.unlink()
    return Frame(pixels[..., :3], pixels[..., 3])


def rmse(
    frames: dict[tuple[int, int], Frame], reference: dict[tuple[int, int], Frame], size: int
) -> float:
    """Returns the error over the fully covered pixels of all views of a size."""
    squares = []
    for view in range(VIEWS):
        true = reference[size, view]
        covered = true.coverage >= 1
        squares.append((frames[size, view].colors - true.colors)[covered].ravel() ** 2)
    return float(np.sqrt(np.concatenate(squares).mean()))


if __name__ == "__main__":
    main()
