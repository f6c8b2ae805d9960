# SPDX-License-Identifier: GPL-3.0-or-later

"""The demonstrations' scenes: added to the user's file, and removed with everything in them."""

import time
from collections.abc import Callable, Sequence
from functools import partial

import bpy
import numpy as np

from ..bridge import kept_sources, level_images
from ..bridge.layers import COLOR, NewLayer
from ..bridge.new_points import Cloud, new_points
from ..core.translations import tr
from . import models, viewport
from .choices import HOME, is_demonstration

_LEVEL = 4
_SECONDS_BETWEEN_LOOKS = 0.1
_MOST_SECONDS = 120.0
_WIDTHS = {"mipmaps": 8.0, "solid": 6.4, "surface": 5.8}


def begin(context: bpy.types.Context, kind: str) -> None:
    """Creates and shows the scene of a demonstration.

    Args:
        context: The context.
        kind: A key of `choices.DEMONSTRATIONS`.
    """
    if is_demonstration(context.scene):
        end(context)
    home = context.scene
    scene = bpy.data.scenes.new("Prefilter Demonstration")
    scene[HOME] = home.name
    context.window.scene = scene
    _BUILDERS[kind](context, scene)
    viewport.frame(context, scene, _WIDTHS[kind], textured=kind == "mipmaps")


def end(context: bpy.types.Context) -> None:
    """Removes the scene of a demonstration with its own data, and shows the user's scene."""
    scene = context.scene
    home = bpy.data.scenes.get(scene[HOME])
    if home is None:
        home = next(other for other in bpy.data.scenes if other != scene)
    viewport.restore(context, scene)
    objects = [obj for obj in scene.collection.all_objects if set(obj.users_scene) == {scene}]
    objects += [obj for obj in kept_sources.copies_of(objects) if obj not in objects]
    context.window.scene = home
    used = [*objects, *(obj.data for obj in objects if obj.data is not None)]
    materials = {slot.material for obj in objects for slot in obj.material_slots} - {None}
    images = {
        node.image
        for material in materials
        for node in (material.node_tree.nodes if material.node_tree else ())
        if node.type == "TEX_IMAGE" and node.image is not None
    }
    images |= {level_images.source_of_level(image) for image in images} - {None}
    images |= {level for image in images for level in level_images.levels_of(image)}
    bpy.data.scenes.remove(scene)
    bpy.data.batch_remove(used[: len(objects)])
    for blocks in (used[len(objects) :], materials):
        bpy.data.batch_remove([block for block in blocks if block.users == 0])
    bpy.data.batch_remove([image for image in images if image.users - image.use_fake_user == 0])


def _mipmaps(context: bpy.types.Context, scene: bpy.types.Scene) -> None:
    """Shows a stone with its texture, and with a level of the texture by two filters."""
    model, pixels = models.stone(), models.paint()
    named = (
        ("Stone", tr("Full texture"), ""),
        ("Stone Box", tr("Box, level {}").format(_LEVEL), "box"),
        ("Stone Prefilter", tr("Prefilter, level {}").format(_LEVEL), "pam-bilinear"),
    )
    baked: dict[str, str] = {}
    for i, (name, text, kind) in enumerate(named):
        image = bpy.data.images.new(name, *pixels.shape[1::-1])
        image.pixels.foreach_set(pixels.ravel())
        image.pack()
        obj = _add(scene, _mesh(name, model), 2.6 * (i - 1))
        _show(obj, image)
        _label(scene, text, obj)
        if kind:
            baked[image.name] = kind
    _select(context, [obj])
    for name, kind in baked.items():
        # The second bake waits in the queue.
        bpy.ops.prefilter.bake_mipmaps(
            "INVOKE_DEFAULT", image=name, filter=kind, result="images", objects="all"
        )
    show = partial(_show_levels, scene.name, list(baked), time.monotonic() + _MOST_SECONDS)
    if show() is not None:
        bpy.app.timers.register(show, first_interval=_SECONDS_BETWEEN_LOOKS)


def _show_levels(scene_name: str, names: list[str], end: float) -> float | None:
    """Replaces images by one of their levels once they are baked.

    Args:
        scene_name: The scene of the demonstration.
        names: The images.
        end: The time at which to give up.

    Returns:
        Seconds until the next check; None to stop.
    """
    scene = bpy.data.scenes.get(scene_name)
    images = [bpy.data.images.get(name) for name in names]
    if scene is None or None in images or time.monotonic() > end:
        return None
    levels = [level_images.levels_of(image) for image in images]
    if not all(levels):
        return _SECONDS_BETWEEN_LOOKS
    shown = {image: own[_LEVEL - 1] for image, own in zip(images, levels, strict=True)}
    for obj in scene.objects:
        for slot in obj.material_slots:
            for node in slot.material.node_tree.nodes if slot.material else ():
                if node.type == "TEX_IMAGE" and node.image in shown:
                    node.image = shown[node.image]
    if not bpy.app.background:
        bpy.ops.ed.undo_push(message="Bake and Compare")
    return None


def _solid(context: bpy.types.Context, scene: bpy.types.Scene) -> None:
    """Shows a broken mesh, and a solid made of it."""
    mesh = _mesh("Broken", models.broken_stone())
    for name, text, x in (("Broken", tr("Broken"), -1.6), ("Solid", tr("Solid"), 1.6)):
        obj = _add(scene, mesh if x < 0.0 else mesh.copy(), x)
        obj.name = name
        _label(scene, text, obj)
    _select(context, [obj])
    bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=8)


def _surface(context: bpy.types.Context, scene: bpy.types.Scene) -> None:
    """Shows a scan, and a surface made of it."""
    positions, normals, colors = models.knot()
    rgba = np.c_[colors, np.ones(len(colors))].astype(np.float32)
    layers = [NewLayer(COLOR, "Color", "BYTE_COLOR", "POINT", rgba)]
    for name, text, x in (("Points", tr("Points"), -1.4), ("Surface", tr("Surface"), 1.4)):
        obj = new_points(Cloud(name, positions, normals, layers), np.zeros(3))
        obj.location.x = x
        _label(scene, text, obj)
    _select(context, [obj])
    bpy.ops.prefilter.reconstruct("INVOKE_DEFAULT", depth=7, points="hide")


_BUILDERS: dict[str, Callable[[bpy.types.Context, bpy.types.Scene], None]] = {
    "mipmaps": _mipmaps,
    "solid": _solid,
    "surface": _surface,
}


def _mesh(name: str, model: models.Model) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(model.points.tolist(), [], model.quads.tolist())
    if model.uvs is not None:
        uvs = model.uvs.astype(np.float32).ravel()
        mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uvs)
    mesh.shade_smooth()
    return mesh


def _add(scene: bpy.types.Scene, mesh: bpy.types.Mesh, x: float) -> bpy.types.Object:
    obj = bpy.data.objects.new(mesh.name, mesh)
    obj.location.x = x
    scene.collection.objects.link(obj)
    return obj


def _label(scene: bpy.types.Scene, text: str, below: bpy.types.Object) -> None:
    """Adds a line of text below an object."""
    curve = bpy.data.curves.new(text, "FONT")
    curve.body, curve.align_x, curve.size = text, "CENTER", 0.3
    obj = bpy.data.objects.new(f"{text} (label)", curve)
    obj.location = (below.location.x, 0.0, -1.65)
    obj.rotation_euler.x = np.pi / 2
    scene.collection.objects.link(obj)


def _show(obj: bpy.types.Object, image: bpy.types.Image) -> None:
    """Gives an object a material that shows an image."""
    material = bpy.data.materials.new(obj.name)
    if material.node_tree is None:
        material.use_nodes = True
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    node.location = (shader.location.x - 320, shader.location.y)
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    tree.nodes.active = node
    obj.data.materials.append(material)


def _select(context: bpy.types.Context, objects: Sequence[bpy.types.Object]) -> None:
    context.view_layer.update()
    for obj in context.view_layer.objects:
        obj.select_set(obj in objects)
    context.view_layer.objects.active = objects[0]
