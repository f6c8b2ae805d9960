# SPDX-License-Identifier: GPL-3.0-or-later

"""How materials sample images: UV maps, mappings and extensions; and their base colors."""

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
    # Within half a texel of the border, where lookups inside the image reach, both are the same.
    "MIRROR": "clamp",
}
"""The library's wrap mode for each extension of an Image Texture node."""

WHITE = (1.0, 1.0, 1.0, 1.0)
"""Color of surfaces without a material."""

_ONE_COLOR = frozenset({"BSDF_DIFFUSE", "EMISSION"})


@dataclass(frozen=True)
class ImageUse:
    """One way in which a material samples an image.

    Attributes:
        uv_map: Name of the UV map; empty for the active render UV map.
        transform: Rows of the 2 x 3 matrix from (u, v, 1) to texture coordinates.
        extension: Extension of the Image Texture node.
    """

    uv_map: str
    transform: tuple[tuple[float, float, float], tuple[float, float, float]]
    extension: str


class _NotUvError(Exception):
    """The coordinates do not come from a UV map; the message names their source."""


def image_uses(
    material: bpy.types.Material, image: bpy.types.Image
) -> tuple[list[ImageUse], list[str]]:
    """Finds the Image Texture nodes of a material that show an image.

    Links are followed through groups, reroutes, muted nodes and Mapping nodes. The nodes need not
    be connected to the output.

    Returns:
        The different uses, and a warning for each node whose coordinates are not a UV map's.
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
        owner: A material, world or light.
        kind: The type of the nodes; "TEX_ENVIRONMENT" for Environment Texture nodes.
    """
    return list(dict.fromkeys(node.image for node, _ in _image_nodes(owner, kind)))


def base_color(material: bpy.types.Material | None) -> tuple[float, float, float, float]:
    """Returns the uniform color of a material.

    This is the base color (from its RGB node, if one is linked) and the alpha of the shader that
    the output shows, or else the viewport color.

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
    """Returns the shader with a base color that is linked to a material's output; None if none."""
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
    """Returns the name of the base color input of a shader."""
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
    """Follows an input socket back to a UV map; returns its name and the combined mapping."""
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
            bypass = nodes.bypassed(node, source)
            if bypass is None:
                raise _NotUvError(f"gets its coordinates from the muted node '{node.name}'")
            socket = bypass
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
    linear = Euler(values["Rotation"], "XYZ").to_matrix().to_4x4() @ Matrix.Diagonal(
        (*values["Scale"], 1.0)
    )
    affine = Matrix.Translation(values["Location"]) @ linear
    if node.vector_type == "POINT":
        return affine
    if node.vector_type == "VECTOR":
        return linear
    if node.vector_type == "TEXTURE" and affine.determinant() != 0.0:
        return affine.inverted()
    problem = "of scale 0" if node.vector_type == "TEXTURE" else f"of type {node.vector_type}"
    raise _NotUvError(f"has a '{node.name}' node {problem}")
