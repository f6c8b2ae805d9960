# SPDX-License-Identifier: GPL-3.0-or-later

"""Bakes the mipmaps of a painted model with several filters, and makes pictures of them.

Usage: blender --background --python scripts/demo_scene.py -- FOLDER

The extension has to be installed and enabled. Writes FOLDER/level3.png to level5.png (the model
with its full texture, and with that level of each filter) and FOLDER/levels.png (the levels), and
prints how far each level is from the full texture over the surface.
"""

import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
import prefilter
from numpy.typing import NDArray

Array = NDArray[np.float32]

IMAGE = "Paint"
TEXTURE_SIZE = 1024
MARGIN = 1.5  # Paint around a chart, in texels.
SHOWN_LEVELS = (3, 4, 5)
SHEET_LEVELS = range(1, 8)
FILTERS = {"box": "Box", "lanczos3": "Lanczos 3", "pam-bilinear": "PAM bilinear"}

PANEL_WIDTH, PANEL_HEIGHT = 480, 400  # Pixels of a render.
SAMPLES = 12
CELL = 176  # Side of a level on the contact sheet, in pixels.
GAP = 16
PAPER, INK = 0.955, 0.13
MAGENTA = (1.0, 0.0, 1.0)
OUTLINE = np.array((0.10, 0.13, 0.20))
PALETTE = np.array(
    [
        [(0.96, 0.93, 0.84), (0.86, 0.33, 0.20)],
        [(0.13, 0.47, 0.51), (0.95, 0.79, 0.35)],
        [(0.98, 0.76, 0.30), (0.25, 0.22, 0.42)],
        [(0.93, 0.90, 0.82), (0.13, 0.47, 0.51)],
    ]
)


@dataclass(frozen=True)
class Model:
    """A mesh as arrays: corner positions (m, 3, 3) and UVs (m, 3, 2), and the library's surface."""

    corners: NDArray[np.float64]
    uvs: NDArray[np.float64]
    surface: prefilter.Surface


def main(folder: Path) -> None:
    """Makes the pictures."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    obj = add_monkey()
    model = read_model(obj)
    print("painting the model", flush=True)
    image = new_image(paint(model))
    shown = add_material(obj, image)
    set_up_render()

    print("rendering it with the full texture", flush=True)
    full = ("Full texture", f"{TEXTURE_SIZE} x {TEXTURE_SIZE}", render(folder))
    panels = {level: [full] for level in SHOWN_LEVELS}
    levels, errors = {}, {}
    for name, label in FILTERS.items():
        shown.image = image
        bpy.ops.prefilter.bake_mipmaps(image=IMAGE, filter=name)
        levels[name] = read_levels()
        errors[name] = surface_errors(model, levels[name])
        print(f"rendering it with levels of {label}", flush=True)
        for level in SHOWN_LEVELS:
            shown.image = bpy.data.images[f"{IMAGE}.mip{level:02d}"]
            note = f"surface error {errors[name][level - 1]:.3f}"
            panels[level].append((f"{label}, level {level}", note, render(folder)))
    print_table(errors)
    for level in SHOWN_LEVELS:
        save(comparison(panels[level]), folder / f"level{level}.png")
    save(contact_sheet(levels), folder / "levels.png")


def add_monkey() -> bpy.types.Object:
    """Adds the model; its charts have very different texel densities."""
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.modifiers.new("Smooth", "SUBSURF").levels = 2
    obj.modifiers["Smooth"].render_levels = 2
    bpy.ops.object.shade_smooth()
    return obj


def read_model(obj: bpy.types.Object) -> Model:
    """Copies the evaluated triangles."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    loops = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    vertices = np.empty(len(mesh.loops), np.int32)
    mesh.attributes[".corner_vert"].data.foreach_get("value", vertices)
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", positions.ravel())
    uvs = np.empty((len(mesh.loops), 2), np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", uvs.ravel())
    evaluated.to_mesh_clear()
    triangles = vertices[loops].reshape(-1, 3)
    corner_uvs = uvs[loops].reshape(-1, 3, 2)
    surface = prefilter.Surface(positions, triangles, corner_uvs)
    return Model(positions[triangles].astype(float), corner_uvs.astype(float), surface)


def paint(model: Model) -> Array:
    """Paints a pattern that continues from chart to chart; texels outside charts are magenta."""
    uvs = model.uvs * TEXTURE_SIZE
    to_uv = np.concatenate([uvs, np.ones((len(uvs), 3, 1))], axis=2).transpose(0, 2, 1)
    solid = np.abs(np.linalg.det(to_uv)) > 1e-9
    to_barycentric = np.linalg.inv(to_uv[solid])
    points = np.full((TEXTURE_SIZE, TEXTURE_SIZE, 3), np.nan)
    for margin in (MARGIN, 0.0):
        for corners, corner_uvs, matrix in zip(
            model.corners[solid], uvs[solid], to_barycentric, strict=True
        ):
            rows, columns, weights = texels_of(corner_uvs, matrix, margin)
            points[rows, columns] = weights @ corners
    pixels = np.empty(points.shape, np.float32)
    pixels[:] = MAGENTA
    used = np.isfinite(points[..., 0])
    pixels[used] = pattern(points[used])
    return pixels


def texels_of(
    uvs: NDArray[np.float64], to_barycentric: NDArray[np.float64], margin: float
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Returns the texels of a triangle, grown by a margin, and their barycentric coordinates."""
    left, bottom = np.maximum(np.floor(uvs.min(axis=0) - margin), 0).astype(int)
    right, top = np.minimum(np.ceil(uvs.max(axis=0) + margin), TEXTURE_SIZE).astype(int)
    y, x = np.indices((top - bottom, right - left)).reshape(2, -1)
    rows, columns = y + bottom, x + left
    centers = np.stack([columns + 0.5, rows + 0.5, np.ones(len(rows))])
    weights = to_barycentric @ centers
    grown = margin * np.hypot(to_barycentric[:, 0], to_barycentric[:, 1]) + 1e-9
    inside = (weights >= -grown[:, None]).all(axis=0)
    return rows[inside], columns[inside], weights[:, inside].T


def pattern(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns sRGB colors of points: wavy bands, each with its own stripes or dots."""
    x, y, z = points.T
    height = 3.2 * (z + 0.07 * np.sin(6 * x) + 0.3 * y)
    band = np.floor(height).astype(int) % len(PALETTE)
    color, accent = PALETTE[band, 0], PALETTE[band, 1]
    stripes = np.sin(34 * (x + 0.5 * y) + 12 * z) > 0.2
    dots = np.sin(20 * x) * np.sin(20 * y) * np.sin(20 * z + 20 * x) > 0.12
    marked = np.where(band % 2 == 0, stripes, dots)
    edge = np.abs(height - np.round(height)) < 0.10
    painted = np.where(marked[:, None], accent, color)
    return np.where(edge[:, None], OUTLINE, painted)


def new_image(pixels: Array) -> bpy.types.Image:
    """Makes the image datablock."""
    image = bpy.data.images.new(IMAGE, TEXTURE_SIZE, TEXTURE_SIZE)
    opaque = np.concatenate([pixels, np.ones((*pixels.shape[:2], 1), np.float32)], axis=2)
    image.pixels.foreach_set(opaque.ravel())
    image.update()
    image.pack()
    return image


def add_material(obj: bpy.types.Object, image: bpy.types.Image) -> bpy.types.Node:
    """Shows the image on the object, and returns the node that does it."""
    material = bpy.data.materials.new("Painted")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.interpolation = "Linear"
    texture.extension = "EXTEND"
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(texture.outputs["Color"], diffuse.inputs["Color"])
    links.new(diffuse.outputs[0], output.inputs["Surface"])
    obj.data.materials.append(material)
    return texture


def set_up_render() -> None:
    """Adds light and camera, and chooses a small render in true colors."""
    scene = bpy.context.scene
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 2.2
    sun.rotation_euler = (math.radians(50), math.radians(-15), math.radians(-30))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 2.62
    turn = math.radians(24)
    camera.location = (10 * math.sin(turn) + 0.20, -10 * math.cos(turn), 1.0)
    camera.rotation_euler = (math.radians(84), 0, turn)
    world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.55
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    for obj in (sun, camera):
        scene.collection.objects.link(obj)
    scene.world = world
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 1
    scene.render.resolution_x, scene.render.resolution_y = PANEL_WIDTH, PANEL_HEIGHT
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"


def render(folder: Path) -> Array:
    """Renders the scene and returns it on paper, sRGB, rows from the top."""
    path = folder / ".render.png"
    bpy.context.scene.render.filepath = str(path)
    with quiet():
        bpy.ops.render.render(write_still=True)
    try:
        # OpenImageIO associates alpha with the encoded colors on reading.
        pixels = oiio.ImageBuf(str(path)).get_pixels("float")
    finally:
        path.unlink(missing_ok=True)
    return pixels[..., :3] + PAPER * (1 - pixels[..., 3:])


@contextmanager
def quiet() -> Iterator[None]:
    """Keeps what Blender prints about each sample off standard output."""
    sys.stdout.flush()
    kept = os.dup(1)
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def read_levels() -> list[Array]:
    """Returns the image and its levels as sRGB, rows from the bottom."""
    names = [IMAGE]
    while f"{IMAGE}.mip{len(names):02d}" in bpy.data.images:
        names.append(f"{IMAGE}.mip{len(names):02d}")
    levels = []
    for name in names:
        image = bpy.data.images[name]
        pixels = np.empty((image.size[1], image.size[0], 4), np.float32)
        image.pixels.foreach_get(pixels.ravel())
        levels.append(np.ascontiguousarray(pixels[..., :3]))
    return levels


def surface_errors(model: Model, levels: Sequence[Array]) -> NDArray[np.float64]:
    """Returns the RMS difference of each level to the image, over the surface, in linear light."""
    linear = [prefilter.to_linear(level) for level in levels]
    mip_values = list(SHEET_LEVELS)
    return prefilter.mipmap_error(linear, linear[0], model.surface, mip_values)


def print_table(errors: dict[str, NDArray[np.float64]]) -> None:
    """Prints the error of each filter and level."""
    print("\nRMS difference to the full texture over the surface, in linear light")
    print(f"{'level':14}" + "".join(f"{level:9}" for level in SHEET_LEVELS))
    for name, row in errors.items():
        print(f"{FILTERS[name]:14}" + "".join(f"{error:9.4f}" for error in row))
    print(flush=True)


def comparison(panels: Sequence[tuple[str, str, Array]]) -> Array:
    """Puts renders side by side, with two lines of text under each."""
    page = blank(len(panels) * (PANEL_WIDTH + GAP) + GAP, PANEL_HEIGHT + GAP + 92)
    for index, (title, note, pixels) in enumerate(panels):
        left = GAP + index * (PANEL_WIDTH + GAP)
        center = left + PANEL_WIDTH // 2
        place(page, left, GAP, pixels)
        write(page, center, GAP + PANEL_HEIGHT + 36, title, 30)
        write(page, center, GAP + PANEL_HEIGHT + 72, note, 24, ink=0.42)
    return page


def contact_sheet(levels: dict[str, list[Array]]) -> Array:
    """Puts the levels of each filter in a row, enlarged without interpolation."""
    label_width, header = 190, 48
    page = blank(
        label_width + len(SHEET_LEVELS) * (CELL + GAP), header + len(levels) * (CELL + GAP)
    )
    for column, level in enumerate(SHEET_LEVELS):
        left = label_width + column * (CELL + GAP)
        size = TEXTURE_SIZE >> level
        write(page, left + CELL // 2, 32, f"{level}: {size} x {size}", 20)
        for row, (name, pyramid) in enumerate(levels.items()):
            top = header + row * (CELL + GAP)
            texels = np.arange(CELL) * size // CELL
            place(page, left, top, pyramid[level][::-1][np.ix_(texels, texels)])
            if column == 0:
                write(page, label_width // 2, top + CELL // 2 + 8, FILTERS[name], 22)
    return page


def blank(width: int, height: int) -> Array:
    """Returns an empty page."""
    return np.full((height, width, 3), PAPER, np.float32)


def place(page: Array, left: int, top: int, pixels: Array) -> None:
    """Puts an image on a page."""
    height, width = pixels.shape[:2]
    page[top : top + height, left : left + width] = pixels


def write(page: Array, x: int, y: int, text: str, size: int, ink: float = INK) -> None:
    """Writes text centered at x, with its base line at y, in Blender's own font."""
    font = str(Path(bpy.utils.system_resource("DATAFILES", path="fonts")) / "Inter.woff2")
    buffer = oiio.ImageBuf(page)
    color = (ink, ink, ink)
    if not oiio.ImageBufAlgo.render_text(buffer, x, y, text, size, font, color, "center"):
        raise RuntimeError(f"cannot write '{text}': {buffer.geterror()}")
    page[:] = buffer.get_pixels("float")


def save(page: Array, path: Path) -> None:
    """Saves a page as an 8-bit picture."""
    buffer = oiio.ImageBuf(page)
    buffer.set_write_format("uint8")
    if not buffer.write(str(path)):
        raise OSError(f"cannot write '{path}': {buffer.geterror()}")
    print(f"wrote {path}", flush=True)


if __name__ == "__main__":
    target = Path(sys.argv[sys.argv.index("--") + 1])
    target.mkdir(parents=True, exist_ok=True)
    main(target)
