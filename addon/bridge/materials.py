"""Where a material samples an image: which UV map, moved how, extended how."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import bpy
from mathutils import Euler, Matrix

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
_FACTORS = frozenset({"Fac", "Factor"})

Groups = tuple[bpy.types.Node, ...]


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
    if not material.use_nodes or material.node_tree is None:
        return uses, warnings
    for node, groups in _image_nodes(material.node_tree, ()):
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


def images_of(
    owner: bpy.types.Material | bpy.types.World | bpy.types.Light, kind: str = "TEX_IMAGE"
) -> list[bpy.types.Image]:
    """Returns the images of a material's Image Texture nodes, each once.

    Args:
        owner: The material, or something else with shader nodes.
        kind: The type of the nodes; "TEX_ENVIRONMENT" for Environment Texture nodes.
    """
    if not owner.use_nodes or owner.node_tree is None:
        return []
    nodes = _image_nodes(owner.node_tree, (), kind)
    return list(dict.fromkeys(node.image for node, _ in nodes))


def feeds_normal_map(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Tells whether a Normal Map node of a material gets its color from an image.

    Reroutes, groups and nodes that change colors, such as those that turn green over, are followed.
    """
    if not material.use_nodes or material.node_tree is None:
        return False
    return any(
        _comes_from(node.inputs["Color"], groups, image, set())
        for node, groups in _nodes_of_type(material.node_tree, (), "NORMAL_MAP")
    )


def has_base_color_of(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Tells whether a shader of a material gets its base color from an image.

    That is the input Base Color, or the only color of a Diffuse BSDF and an Emission.
    """
    if not material.use_nodes or material.node_tree is None:
        return False
    return any(
        _comes_from(socket, groups, image, set(), output="Color")
        for node, groups in _nodes(material.node_tree, ())
        for socket in node.inputs
        if socket.name == ("Color" if node.type in _ONE_COLOR else "Base Color")
    )


def has_alpha_of(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Tells whether a material shows as much of the surface as the alpha of an image says.

    So it does where the Alpha output of an Image Texture node leads to the input Alpha of a shader,
    or to the factor of a Mix Shader that has a Transparent BSDF on one side. An image whose alpha
    mode is None has no alpha to a shader.
    """
    if image.alpha_mode == "NONE" or not material.use_nodes or material.node_tree is None:
        return False
    return any(
        _comes_from(socket, groups, image, set(), output="Alpha")
        for socket, groups in _coverage_inputs(material.node_tree)
    )


def base_color(material: bpy.types.Material | None) -> tuple[float, float, float, float]:
    """Returns the color that a material gives a surface that is the same everywhere.

    That is the base color and the alpha of the shader that the output shows, or of an RGB node that
    leads there; without such a shader the color of the viewport.

    Returns:
        Scene-linear red, green and blue, and alpha.
    """
    if material is None:
        return WHITE
    shader = _shown_shader(material)
    if shader is None:
        red, green, blue, alpha = material.diffuse_color
        return red, green, blue, alpha
    name = "Color" if shader.type in _ONE_COLOR else "Base Color"
    socket = shader.inputs[name]
    link = _link_into(socket)
    while link is not None and link.from_node.type == "REROUTE":
        link = _link_into(link.from_node.inputs[0])
    if link is not None and link.from_node.type == "RGB":
        socket = link.from_socket
    red, green, blue = socket.default_value[:3]
    coverage = shader.inputs.get("Alpha")
    alpha = 1.0 if coverage is None or coverage.is_linked else coverage.default_value
    return red, green, blue, alpha


def _shown_shader(material: bpy.types.Material) -> bpy.types.Node | None:
    """Returns the shader with a base color that the output of a material shows directly."""
    if not material.use_nodes or material.node_tree is None:
        return None
    output = material.node_tree.get_output_node("ALL") or material.node_tree.get_output_node(
        "EEVEE"
    )
    link = _link_into(output.inputs["Surface"]) if output is not None else None
    while link is not None and link.from_node.type == "REROUTE":
        link = _link_into(link.from_node.inputs[0])
    if link is None:
        return None
    shader = link.from_node
    name = "Color" if shader.type in _ONE_COLOR else "Base Color"
    return shader if name in shader.inputs else None


def _coverage_inputs(tree: bpy.types.NodeTree) -> Iterator[tuple[bpy.types.NodeSocket, Groups]]:
    """Yields the inputs of shaders that say how much of the surface they show."""
    for node, groups in _nodes(tree, ()):
        if node.type == "MIX_SHADER":
            factor, *shaders = node.inputs
            if any(_is_transparent(shader) for shader in shaders):
                yield factor, groups
        elif any(output.type == "SHADER" for output in node.outputs):
            yield from ((socket, groups) for socket in node.inputs if socket.name == "Alpha")


def _is_transparent(shader: bpy.types.NodeSocket) -> bool:
    link = _link_into(shader)
    while link is not None and link.from_node.type == "REROUTE":
        link = _link_into(link.from_node.inputs[0])
    return link is not None and link.from_node.type == "BSDF_TRANSPARENT"


def _comes_from(
    socket: bpy.types.NodeSocket,
    groups: Groups,
    image: bpy.types.Image,
    seen: set[Any],
    output: str = "",
) -> bool:
    """Tells whether a socket gets its value from an image, or from an output of its node."""
    link = _link_into(socket)
    if link is None:
        return False
    node, source = link.from_node, link.from_socket
    place = (groups, node, source)
    if place in seen:
        return False
    seen.add(place)
    if node.type == "TEX_IMAGE":
        return node.image == image and not node.mute and output in {"", source.name}
    if node.type == "GROUP" and node.node_tree is not None and not node.mute:
        ends = [
            inner
            for inner in node.node_tree.nodes
            if inner.type == "GROUP_OUTPUT" and inner.is_active_output
        ]
        inside = (*groups, node)
        return any(
            _comes_from(_socket(end.inputs, source.identifier), inside, image, seen, output)
            for end in ends
        )
    if node.type == "GROUP_INPUT" and groups:
        outside = _socket(groups[-1].inputs, source.identifier)
        return _comes_from(outside, groups[:-1], image, seen, output)
    # What a factor holds is no normals, and other textures make their colors themselves.
    inputs = [] if node.type.startswith("TEX_") else node.inputs
    return any(
        _comes_from(input_, groups, image, seen, output)
        for input_ in inputs
        if input_.name not in _FACTORS
    )


def _nodes(tree: bpy.types.NodeTree, groups: Groups) -> Iterator[tuple[bpy.types.Node, Groups]]:
    """Yields the nodes that are not muted, those in groups too, each with the groups around it."""
    for node in tree.nodes:
        if node.mute:
            continue
        if node.type == "GROUP" and node.node_tree is not None:
            yield from _nodes(node.node_tree, (*groups, node))
        else:
            yield node, groups


def _nodes_of_type(
    tree: bpy.types.NodeTree, groups: Groups, node_type: str
) -> Iterator[tuple[bpy.types.Node, Groups]]:
    return ((node, inside) for node, inside in _nodes(tree, groups) if node.type == node_type)


def _image_nodes(
    tree: bpy.types.NodeTree, groups: Groups, kind: str = "TEX_IMAGE"
) -> Iterator[tuple[bpy.types.Node, Groups]]:
    nodes = _nodes_of_type(tree, groups, kind)
    return ((node, inside) for node, inside in nodes if node.image is not None)


def _use(node: bpy.types.Node, groups: Groups) -> ImageUse:
    uv_map, matrix = _trace(node.inputs["Vector"], groups)
    first, second = ((row[0], row[1], row[3]) for row in matrix[:2])
    return ImageUse(uv_map, (first, second), node.extension)


def _trace(socket: bpy.types.NodeSocket, groups: Groups) -> tuple[str, Matrix]:
    """Follows an input socket back to a UV map, gathering the mappings on the way."""
    matrix = Matrix.Identity(4)
    while True:
        link = _link_into(socket)
        if link is None:
            if socket.node.type == "TEX_IMAGE":
                return "", matrix
            raise _NotUvError(
                f"gets no coordinates: '{socket.node.name}' has no {socket.name} input"
            )
        node, source = link.from_node, link.from_socket
        if node.mute:
            socket = _bypassed(node, source)
        elif node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "MAPPING":
            matrix = matrix @ _mapping_matrix(node)
            socket = node.inputs["Vector"]
        elif node.type == "GROUP" and node.node_tree is not None:
            groups = (*groups, node)
            socket = _group_output(node, source.identifier)
        elif node.type == "GROUP_INPUT" and groups:
            socket = _socket(groups[-1].inputs, source.identifier)
            groups = groups[:-1]
        else:
            return _uv_map(node, source), matrix


def _link_into(socket: bpy.types.NodeSocket) -> bpy.types.NodeLink | None:
    return next((link for link in socket.links if not link.is_muted), None)


def _socket(sockets: bpy.types.bpy_prop_collection, identifier: str) -> bpy.types.NodeSocket:
    return next(socket for socket in sockets if socket.identifier == identifier)


def _bypassed(node: bpy.types.Node, output: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    for link in node.internal_links:
        if link.to_socket == output:
            return link.from_socket
    raise _NotUvError(f"gets its coordinates from the muted node '{node.name}'")


def _group_output(group: bpy.types.Node, identifier: str) -> bpy.types.NodeSocket:
    for node in group.node_tree.nodes:
        if node.type == "GROUP_OUTPUT" and node.is_active_output:
            return _socket(node.inputs, identifier)
    raise _NotUvError(f"gets its coordinates from the group '{group.name}', which has no output")


def _uv_map(node: bpy.types.Node, source: bpy.types.NodeSocket) -> str:
    if node.type == "TEX_COORD" and source.identifier == "UV" and not node.from_instancer:
        return ""
    if node.type == "UVMAP" and not node.from_instancer:
        return node.uv_map
    if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" and node.attribute_name:
        return node.attribute_name
    raise _NotUvError(
        f"gets its coordinates from '{node.name}' ({source.name}), where a UV map is needed"
    )


def _mapping_matrix(node: bpy.types.Node) -> Matrix:
    values = {}
    for name in ("Location", "Rotation", "Scale"):
        if name in node.inputs and _link_into(node.inputs[name]) is not None:
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
