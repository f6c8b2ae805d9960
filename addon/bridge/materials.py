# SPDX-License-Identifier: GPL-3.0-or-later

"""Where a material samples an image: which UV map, moved how, extended how."""

from collections.abc import Iterator
from dataclasses import dataclass

import bpy
from mathutils import Euler, Matrix

from . import nodes
from .nodes import Groups

WRAP_OF_EXTENSION = {
    "REPEAT": "repeat",
    "EXTEND": "clamp",
    "CLIP": "border",
    # A mirrored image goes on with its edge, as far as a lookup inside of it can see.
    "MIRROR": "clamp",
}
"""The library's wrap mode for what an Image Texture node does outside of its image."""

WHITE = (1.0, 1.0, 1.0, 1.0)
"""The color of what has no material."""

_ONE_COLOR = frozenset({"BSDF_DIFFUSE", "EMISSION"})


@dataclass(frozen=True)
class ImageUse:
    """One way in which a material samples an image.

    Attributes:
        uv_map: The name of the UV map; empty for the active render UV map.
        transform: The rows of the 2 x 3 matrix that takes (u, v, 1) to texture coordinates.
        extension: What the Image Texture node does outside of the image.
    """

    uv_map: str
    transform: tuple[tuple[float, float, float], tuple[float, float, float]]
    extension: str


class _NotUvError(Exception):
    """The coordinates come from something else than a UV map; the message says from what."""


def image_uses(
    material: bpy.types.Material, image: bpy.types.Image
) -> tuple[list[ImageUse], list[str]]:
    """Finds the Image Texture nodes of a material that show an image.

    Node groups, reroutes, muted nodes and Mapping nodes are followed. A node needs no connection to
    the output: a texture that is yet to be used counts.

    Returns:
        The different uses, and a warning for each node whose coordinates are no UV map.
    """
    uses: list[ImageUse] = []
    warnings: list[str] = []
    for node, groups in _image_nodes(material):
        if node.image != image:
            continue
        try:
            if node.projection != "FLAT":
                raise _NotUvError(f"has the projection {node.projection}")
            use = _use(node, groups)
        except _NotUvError as reason:
            warnings.append(f"material '{material.name}': node '{node.name}' skipped, it {reason}")
        else:
            if use not in uses:
                uses.append(use)
    return uses, warnings


def images_of(owner: nodes.Owner, kind: str = "TEX_IMAGE") -> list[bpy.types.Image]:
    """Returns the images of a material's Image Texture nodes, each once.

    Args:
        owner: The material, or something else with shader nodes.
        kind: The type of the nodes; "TEX_ENVIRONMENT" for Environment Texture nodes.
    """
    return list(dict.fromkeys(node.image for node, _ in _image_nodes(owner, kind)))


def base_color(material: bpy.types.Material | None) -> tuple[float, float, float, float]:
    """Returns the color that a material gives a surface that is the same everywhere.

    That is the base color and the alpha of the shader that the output shows, or of an RGB node that
    leads there; without such a shader the color of the viewport.

    Returns:
        Scene-linear red, green and blue, and alpha.
    """
    if material is None:
        return WHITE
    shader = shown_shader(material)
    if shader is None:
        red, green, blue, alpha = material.diffuse_color
        return red, green, blue, alpha
    socket = shader.inputs[color_input(shader)]
    link = nodes.link_into(socket)
    while link is not None and link.from_node.type == "REROUTE":
        link = nodes.link_into(link.from_node.inputs[0])
    if link is not None and link.from_node.type == "RGB":
        socket = link.from_socket
    red, green, blue = socket.default_value[:3]
    coverage = shader.inputs.get("Alpha")
    alpha = 1.0 if coverage is None or coverage.is_linked else coverage.default_value
    return red, green, blue, alpha


def shown_shader(material: bpy.types.Material) -> bpy.types.Node | None:
    """Returns the shader with a base color that the output of a material shows directly."""
    tree = nodes.tree_of(material)
    if tree is None:
        return None
    output = tree.get_output_node("ALL") or tree.get_output_node("EEVEE")
    link = nodes.link_into(output.inputs["Surface"]) if output is not None else None
    while link is not None and link.from_node.type == "REROUTE":
        link = nodes.link_into(link.from_node.inputs[0])
    if link is None:
        return None
    shader = link.from_node
    return shader if color_input(shader) in shader.inputs else None


def color_input(shader: bpy.types.Node) -> str:
    """Returns the name of the input of a shader that is the color of its surface."""
    return "Color" if shader.type in _ONE_COLOR else "Base Color"


def _image_nodes(
    owner: nodes.Owner, kind: str = "TEX_IMAGE"
) -> Iterator[tuple[bpy.types.Node, Groups]]:
    for node, groups in nodes.walk(nodes.tree_of(owner)):
        if node.type == kind and node.image is not None:
            yield node, groups


def _use(node: bpy.types.Node, groups: Groups) -> ImageUse:
    uv_map, matrix = _trace(node.inputs["Vector"], groups)
    first, second = ((row[0], row[1], row[3]) for row in matrix[:2])
    return ImageUse(uv_map, (first, second), node.extension)


def _trace(socket: bpy.types.NodeSocket, groups: Groups) -> tuple[str, Matrix]:
    """Follows an input socket back to a UV map, gathering the mappings on the way."""
    matrix = Matrix.Identity(4)
    while True:
        link = nodes.link_into(socket)
        if link is None:
            if socket.node.type == "TEX_IMAGE":
                return "", matrix
            raise _NotUvError(
                f"gets no coordinates: '{socket.node.name}' has no {socket.name} input"
            )
        node, source = link.from_node, link.from_socket
        if node.mute:
            handed_on = nodes.bypassed(node, source)
            if handed_on is None:
                raise _NotUvError(f"gets its coordinates from the muted node '{node.name}'")
            socket = handed_on
        elif node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "MAPPING":
            matrix = matrix @ _mapping_matrix(node)
            socket = node.inputs["Vector"]
        elif node.type == "GROUP" and node.node_tree is not None:
            groups = (*groups, node)
            inside = nodes.group_output(node, source.identifier)
            if inside is None:
                raise _NotUvError(
                    f"gets its coordinates from the group '{node.name}', which has no output"
                )
            socket = inside
        elif node.type == "GROUP_INPUT" and groups:
            socket = nodes.group_input(groups[-1], source.identifier)
            groups = groups[:-1]
        else:
            return _uv_map(node, source), matrix


def _uv_map(node: bpy.types.Node, source: bpy.types.NodeSocket) -> str:
    if node.type == "TEX_COORD" and source.identifier == "UV" and not node.from_instancer:
        return ""
    if node.type == "UVMAP" and not node.from_instancer:
        return node.uv_map
    if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" and node.attribute_name:
        return node.attribute_name
    raise _NotUvError(
        f"gets its coordinates from '{node.name}' ({source.name}); a UV map is needed"
    )


def _mapping_matrix(node: bpy.types.Node) -> Matrix:
    values = {}
    for name in ("Location", "Rotation", "Scale"):
        if name in node.inputs and nodes.link_into(node.inputs[name]) is not None:
            raise _NotUvError(f"has a '{node.name}' node whose {name} is not a constant")
        values[name] = node.inputs[name].default_value[:] if name in node.inputs else (0, 0, 0)
    turned = Euler(values["Rotation"], "XYZ").to_matrix().to_4x4() @ Matrix.Diagonal(
        (*values["Scale"], 1.0)
    )
    moved = Matrix.Translation(values["Location"]) @ turned
    if node.vector_type == "POINT":
        return moved
    if node.vector_type == "VECTOR":
        return turned
    if node.vector_type == "TEXTURE" and moved.determinant() != 0.0:
        return moved.inverted()
    found = "of scale 0" if node.vector_type == "TEXTURE" else f"of type {node.vector_type}"
    raise _NotUvError(f"has a '{node.name}' node {found}")
