# SPDX-License-Identifier: GPL-3.0-or-later

"""Materials that show an image, on its own or over their base color."""

import bpy

from ..core.wording import Sentence
from . import materials, nodes

_MARK = "prefilter_decal_of"
_GAP = 300


def material_of(image: bpy.types.Image, *, is_mask: bool, is_opaque: bool) -> bpy.types.Material:
    """Returns the material that shows an image as a decal; made if missing.

    Args:
        image: The image.
        is_mask: Whether its values are the alpha of white.
        is_opaque: Whether its own alpha is ignored.
    """
    for material in bpy.data.materials:
        if material.library is None and material.get(_MARK) == image.name_full:
            return material
    made = _new(image.name)
    made[_MARK] = image.name_full
    tree = made.node_tree
    surface = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    texture = _texture(tree, image, surface, "EXTEND")
    alpha = texture.outputs["Color" if is_mask else "Alpha"]
    if is_mask:
        surface.inputs["Base Color"].default_value = materials.WHITE
    else:
        tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    if not is_opaque:
        tree.links.new(alpha, surface.inputs["Alpha"])
        made.surface_render_method = "BLENDED"
    return made


def show_on(obj: bpy.types.Object, image: bpy.types.Image) -> bpy.types.Material:
    """Makes a material that shows only an image, by an object's UV map."""
    made = _new(obj.name)
    tree = made.node_tree
    surface = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    texture = _texture(tree, image, surface, "EXTEND")
    tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    return made


def put_over(obj: bpy.types.Object, image: bpy.types.Image, *, is_mask: bool) -> bpy.types.Material:
    """Puts an image over the base color of an object's active material, which gets one if missing.

    Args:
        obj: A mesh with a UV map.
        image: The image.
        is_mask: Whether its values are the alpha of white.

    Raises:
        ValueError: The material is linked, or shows no shader with a base color.
    """
    material = obj.active_material
    if material is None:
        material = _new(obj.name)
        obj.active_material = material
    if material.library is not None:
        raise ValueError(Sentence("material '{}' is linked; make it local first", material.name))
    shader = materials.shown_shader(material)
    if shader is None:
        raise ValueError(
            Sentence("material '{}': its output shows no shader with a base color", material.name)
        )
    tree = material.node_tree
    color = shader.inputs[materials.color_input(shader)]
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type, mix.label = "RGBA", image.name
    mix.location = (shader.location.x - _GAP / 1.5, shader.location.y)
    texture = _texture(tree, image, mix, "CLIP")
    below, above = (_socket(mix.inputs, name) for name in ("A_Color", "B_Color"))
    link = nodes.link_into(color)
    if link is not None:
        tree.links.new(link.from_socket, below)
    else:
        below.default_value = color.default_value
    above.default_value = materials.WHITE
    if not is_mask:
        tree.links.new(texture.outputs["Color"], above)
    tree.links.new(
        texture.outputs["Color" if is_mask else "Alpha"], _socket(mix.inputs, "Factor_Float")
    )
    tree.links.new(_socket(mix.outputs, "Result_Color"), color)
    return material


def _new(name: str) -> bpy.types.Material:
    made = bpy.data.materials.new(name)
    if made.node_tree is None:
        made.use_nodes = True
    return made


def _texture(
    tree: bpy.types.NodeTree, image: bpy.types.Image, before: bpy.types.Node, extension: str
) -> bpy.types.Node:
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.extension = image, extension
    texture.location = (before.location.x - _GAP, before.location.y)
    # 3D views in Solid mode show the image of the active node.
    for node in tree.nodes:
        node.select = False
    texture.select = True
    tree.nodes.active = texture
    return texture


def _socket(sockets: bpy.types.bpy_prop_collection, identifier: str) -> bpy.types.NodeSocket:
    return next(socket for socket in sockets if socket.identifier == identifier)
