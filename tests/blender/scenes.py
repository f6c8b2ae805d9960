# SPDX-License-Identifier: GPL-3.0-or-later

"""Small scenes made in code."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

UNIT_SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def noise(height: int, width: int, *, alpha: bool = False, seed: int = 1) -> Array:
    """Returns random RGBA values that a byte holds exactly."""
    values = np.random.default_rng(seed).integers(0, 256, (height, width, 4))
    if not alpha:
        values[..., 3] = 255
    return (values / 255).astype(np.float32)


def image(
    name: str,
    pixels: Array,
    *,
    is_float: bool = False,
    colorspace: str | None = None,
    alpha_mode: str = "STRAIGHT",
) -> bpy.types.Image:
    """Makes a packed image datablock of RGBA pixels, row 0 at the bottom."""
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    if colorspace is not None:
        made.colorspace_settings.name = colorspace
    made.alpha_mode = alpha_mode
    made.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    made.update()
    made.pack()
    return made


def pixels(name: str) -> Array:
    """Returns the pixels of an image datablock as Blender keeps them."""
    found = bpy.data.images[name]
    values = np.empty(len(found.pixels), np.float32)
    found.pixels.foreach_get(values)
    return values.reshape(found.size[1], found.size[0], -1)


def to_linear(encoded: Array) -> Array:
    """Decodes sRGB."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def to_srgb(linear: Array) -> Array:
    """Encodes sRGB."""
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def halved(values: Array) -> Array:
    """Returns the means of 2 x 2 blocks."""
    return (values[::2, ::2] + values[1::2, ::2] + values[::2, 1::2] + values[1::2, 1::2]) / 4


def image_node(tree: bpy.types.NodeTree, picture: bpy.types.Image) -> bpy.types.Node:
    """Adds an Image Texture node."""
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    return node


def material(name: str, picture: bpy.types.Image) -> bpy.types.Material:
    """Makes a material that shows an image in the active render UV map."""
    made = bpy.data.materials.new(name)
    use_nodes(made)
    image_node(made.node_tree, picture)
    return made


def use_nodes(owner: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    """Has a material or a world use nodes, as all do since Blender 5, and returns them."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    return owner.node_tree


def quads(
    name: str,
    uvs: Sequence[Sequence[tuple[float, float]]] = (UNIT_SQUARE,),
    *,
    sizes: Sequence[float] = (),
    select: bool = True,
) -> bpy.types.Object:
    """Makes an object of separate squares, side by side in the plane z = 0.

    Args:
        name: The name of the object and of its mesh.
        uvs: The four UVs of each square.
        sizes: The sides of the squares; 1 if not given.
        select: Whether to select the object.
    """
    sizes = sizes or [1.0] * len(uvs)
    vertices, left = [], 0.0
    for size in sizes:
        vertices += [(left + size * x, size * y, 0.0) for x, y in UNIT_SQUARE]
        left += size
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], [range(4 * i, 4 * i + 4) for i in range(len(uvs))])
    add_uv_map(mesh, "UVMap", uvs)
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    made.select_set(select)
    bpy.context.view_layer.objects.active = made
    return made


def add_uv_map(
    mesh: bpy.types.Mesh, name: str, uvs: Sequence[Sequence[tuple[float, float]]]
) -> None:
    """Adds a UV map to a mesh of squares."""
    layer = mesh.uv_layers.new(name=name)
    layer.uv.foreach_set("vector", np.array(uvs, np.float32).ravel())


def textured_quad(
    picture: bpy.types.Image, name: str = "Quad", *, select: bool = True
) -> bpy.types.Object:
    """Makes one square that shows the whole image."""
    made = quads(name, select=select)
    made.data.materials.append(material(f"{name} material", picture))
    return made


def depsgraph() -> bpy.types.Depsgraph:
    """Returns the evaluated dependency graph."""
    return bpy.context.evaluated_depsgraph_get()


def cube(picture: bpy.types.Image, name: str = "Cube") -> bpy.types.Object:
    """Makes a cube of side 2 with Blender's UVs, a cross of six charts that are joined."""
    bpy.ops.mesh.primitive_cube_add()
    made = bpy.context.object
    made.name = name
    made.data.materials.append(material(f"{name} material", picture))
    return made


def subdivided(obj: bpy.types.Object, **settings: object) -> bpy.types.SubsurfModifier:
    """Adds a Subdivision Surface modifier."""
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    for name, value in settings.items():
        setattr(modifier, name, value)
    return modifier


def scatter(
    obj: bpy.types.Object, instance: bpy.types.Object | None = None
) -> bpy.types.NodesModifier:
    """Puts instances of an object, or of the object's own geometry, on the object's vertices."""
    group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    put = group.nodes.new("GeometryNodeInstanceOnPoints")
    group.links.new(start.outputs[0], put.inputs["Points"])
    source = start.outputs[0]
    if instance is not None:
        info = group.nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = instance
        info.inputs["As Instance"].default_value = True
        source = info.outputs["Geometry"]
    group.links.new(source, put.inputs["Instance"])
    group.links.new(put.outputs[0], end.inputs[0])
    modifier = obj.modifiers.new("Scatter", "NODES")
    modifier.node_group = group
    return modifier


def collection_instance(obj: bpy.types.Object, name: str = "Instancer") -> bpy.types.Object:
    """Moves an object to a collection of its own, outside of the scene, and instances that."""
    collection = bpy.data.collections.new(f"{name} collection")
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    made = bpy.data.objects.new(name, None)
    made.instance_type = "COLLECTION"
    made.instance_collection = collection
    bpy.context.scene.collection.objects.link(made)
    return made


def fcurves(obj: bpy.types.Object) -> list[bpy.types.FCurve]:
    """Returns the animation curves of an object; actions have layers since Blender 4.4."""
    action = obj.animation_data.action
    if bpy.app.version < (4, 4, 0):
        return list(action.fcurves)
    strip = action.layers[0].strips[0]
    return list(strip.channelbag(obj.animation_data.action_slot).fcurves)


@contextmanager
def image_editor(image: bpy.types.Image) -> Iterator[bpy.types.SpaceImageEditor]:
    """Makes an editor that shows an image the context, without a window to be seen."""
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "IMAGE_EDITOR"
    space = area.spaces.active
    space.image = image
    region = next(one for one in area.regions if one.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        yield space


def screen(path: str) -> NDArray[np.uint8]:
    """Returns the pixels of an X screen, (height, width, 3), row 0 at the bottom.

    Args:
        path: The server's framebuffer, in X's window dump format (XWDFile.h).
    """
    with open(path, "rb") as file:
        dump = file.read()
    header = np.frombuffer(dump, ">u4", 25)
    size, width, height, bytes_per_line, colors = header[[0, 4, 5, 12, 19]]
    rows = np.frombuffer(dump, np.uint8, height * bytes_per_line, size + 12 * colors)
    pixels = rows.reshape(height, -1)[:, : 4 * width].reshape(height, width, 4)
    return pixels[::-1, :, 2::-1].copy()


def bilinear(level: Array, u: Array, v: Array) -> Array:
    """Looks up a level at points of UV space, with clamped texels; every point by itself."""
    height, width = level.shape[:2]
    result = np.zeros((*u.shape, level.shape[2]))
    x, y = u * width - 0.5, v * height - 0.5
    for j in (np.floor(y), np.floor(y) + 1):
        for i in (np.floor(x), np.floor(x) + 1):
            share = (1 - np.abs(x - i)) * (1 - np.abs(y - j))
            row = np.clip(j, 0, height - 1).astype(int)
            column = np.clip(i, 0, width - 1).astype(int)
            result += share[..., None] * level[row, column]
    return result
