# SPDX-License-Identifier: GPL-3.0-or-later

"""Roles of images in a material: color, normals, data, coverage, and the channels used."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import bpy

from . import nodes
from .nodes import Groups

_VALUES = frozenset({"VALUE", "RGBA", "VECTOR"})
_FACTORS = frozenset({"Fac", "Factor"})
_ONE_COLOR = {"BSDF_DIFFUSE": "Base Color", "EMISSION": "Emission"}
_SEPARATED = {"Red": "red", "Green": "green", "Blue": "blue", "R": "red", "G": "green", "B": "blue"}
_SEPARATED |= {"X": "red", "Y": "green", "Z": "blue"}
_SEPARATING = frozenset({"SEPARATE_COLOR", "SEPRGB", "SEPXYZ"})
_COMBINING = frozenset({"COMBINE_COLOR", "COMBRGB", "COMBXYZ"})
_MIXING = frozenset({"MIX", "MIX_RGB"})
_ORDER = ("red", "green", "blue")
_NODE_INPUTS = {
    "NORMAL_MAP": ("Color", "Normal Map", "normal"),
    "BUMP": ("Height", "Bump", "data"),
    "DISPLACEMENT": ("Height", "Displacement", "data"),
    "VECTOR_DISPLACEMENT": ("Vector", "Vector Displacement", "data"),
}
"""Image inputs of nodes before shaders, with a label and a use."""


@dataclass(frozen=True)
class Role:
    """Use of an image by an input of a shader.

    Attributes:
        image: The image.
        label: Name of the input, such as "Base Color" or "Normal Map".
        use: "color", "data", "normal", or "coverage" for the visible share of the surface.
        channel: "all", "red", "green" or "blue" of the color, or "alpha".
        threshold: Value of the channel at which a test turns the input on or off; None without a
            test.
        is_factor: Whether the image is only a mask: the factor by which other values are mixed.
    """

    image: bpy.types.Image
    label: str
    use: str
    channel: str
    threshold: float | None = None
    is_factor: bool = False


@dataclass(frozen=True)
class Roughness:
    """A shader whose roughness comes from an image.

    Attributes:
        image: The image.
        channel: Channel, as for `Role`.
        normal_maps: Images of the Normal Map nodes of its normals.
    """

    image: bpy.types.Image
    channel: str
    normal_maps: tuple[bpy.types.Image, ...]


@dataclass(frozen=True)
class _Request:
    """Channel, threshold and masking, while following links from an input back to images."""

    channel: str = "all"
    threshold: float | None = None
    is_factor: bool = False


def roles(material: bpy.types.Material) -> list[Role]:
    """Returns the roles of images in the shaders of a material, each once.

    Links are followed through groups, reroutes and nodes that change values; muted nodes are
    bypassed. Shaders need not be connected to the output.
    """
    distinct: dict[Role, None] = {}
    for socket, groups, label, use in _inputs(material):
        for image, request in _sources(socket, groups):
            threshold = request.threshold if use == "coverage" else None
            role = Role(image, label, use, request.channel, threshold, request.is_factor)
            distinct[role] = None
    return list(distinct)


def inputs_of(
    material: bpy.types.Material, image: bpy.types.Image
) -> Iterator[tuple[Role, bpy.types.NodeSocket, Groups]]:
    """Yields the inputs that get values from an image, once per channel, except through masks."""
    for socket, groups, label, use in _inputs(material):
        for source, request in dict.fromkeys(_sources(socket, groups)):
            if source == image and not request.is_factor:
                yield Role(image, label, use, request.channel), socket, groups


def roughness(material: bpy.types.Material) -> list[Roughness]:
    """Returns the roughness images of the shaders of a material."""
    shaders: dict[Roughness, None] = {}
    for node, groups in nodes.walk(nodes.tree_of(material)):
        if not _is_shader(node) or "Roughness" not in node.inputs:
            continue
        normals: dict[bpy.types.Image, None] = {}
        if "Normal" in node.inputs:
            normals.update((image, None) for image in _normal_maps(node.inputs["Normal"], groups))
        for image, request in _sources(node.inputs["Roughness"], groups):
            if not request.is_factor:
                shaders[Roughness(image, request.channel, tuple(normals))] = None
    return list(shaders)


def has_base_color_of(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Whether a shader of a material gets its base color from an image.

    The base color is the input Base Color, or the color of a Diffuse BSDF or an Emission.
    """
    labels = {"Base Color", *_ONE_COLOR.values()}
    return any(
        role.label in labels and role.channel != "alpha" and not role.is_factor
        for role in _of(material, image)
    )


def has_alpha_of(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Whether the alpha of an image is the coverage of a material.

    It is where the Alpha output of an Image Texture node leads to the input Alpha of a shader, or
    to the factor of a Mix Shader with a Transparent BSDF on one side. An image with the alpha mode
    None has no alpha for shaders.
    """
    return image.alpha_mode != "NONE" and any(
        role.use == "coverage" and role.channel == "alpha" and not role.is_factor
        for role in _of(material, image)
    )


def shows_as_color(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Whether an image, and no other one, is a color of a shader of a material.

    The image may be mixed with constants, but not changed by a ramp or other nodes.
    """
    for socket, groups, _, use in _inputs(material):
        if use == "color" and image in _unchanged(socket, groups):
            sources = _sources(socket, groups)
            if {source for source, request in sources if not request.is_factor} == {image}:
                return True
    return False


def _unchanged(socket: bpy.types.NodeSocket, groups: Groups) -> Iterator[bpy.types.Image]:
    """Yields the images whose colors reach a socket unchanged, or mixed."""
    for node, source, around in _before(socket, groups):
        if node.type == "TEX_IMAGE" and node.image is not None and source.name == "Color":
            yield node.image
        elif node.type in _MIXING:
            for input_ in node.inputs:
                if input_.enabled and input_.name not in _FACTORS:
                    yield from _unchanged(input_, around)


def _of(material: bpy.types.Material, image: bpy.types.Image) -> Iterator[Role]:
    return (role for role in roles(material) if role.image == image)


def _inputs(
    material: bpy.types.Material,
) -> Iterator[tuple[bpy.types.NodeSocket, Groups, str, str]]:
    """Yields the inputs that define roles, with a label and a use."""
    tree = nodes.tree_of(material)
    for node, groups in nodes.walk(tree):
        if node.type in _NODE_INPUTS:
            name, label, use = _NODE_INPUTS[node.type]
            yield node.inputs[name], groups, label, use
        elif node.type == "MIX_SHADER":
            factor, *shaders = node.inputs
            is_coverage = any(_is_transparent(shader) for shader in shaders)
            label, use = ("Alpha", "coverage") if is_coverage else ("Mix Shader", "data")
            yield factor, groups, label, use
        elif _is_shader(node):
            for socket in node.inputs:
                if socket.is_linked and socket.type in _VALUES:
                    yield socket, groups, _label(node, socket), _use(socket)
    for node in tree.nodes if tree is not None else ():
        # The glTF importer keeps values without an input in Blender in groups without outputs.
        if node.type == "GROUP" and not node.mute and not node.outputs:
            for socket in node.inputs:
                yield socket, (), socket.name, "color" if socket.type == "RGBA" else "data"


def _is_shader(node: bpy.types.Node) -> bool:
    return any(output.type == "SHADER" for output in node.outputs)


def _label(node: bpy.types.Node, socket: bpy.types.NodeSocket) -> str:
    return _ONE_COLOR.get(node.type, socket.name) if socket.name == "Color" else socket.name


def _use(socket: bpy.types.NodeSocket) -> str:
    if socket.name == "Alpha":
        return "coverage"
    return "color" if socket.type == "RGBA" else "data"


def _is_transparent(shader: bpy.types.NodeSocket) -> bool:
    link = nodes.link_into(shader)
    while link is not None and link.from_node.type == "REROUTE":
        link = nodes.link_into(link.from_node.inputs[0])
    return link is not None and link.from_node.type == "BSDF_TRANSPARENT"


def _normal_maps(socket: bpy.types.NodeSocket, groups: Groups) -> Iterator[bpy.types.Image]:
    """Yields the images of the Normal Map nodes before a Normal input."""
    pending, seen = [(socket, groups)], set()
    while pending:
        position = pending.pop()
        if position in seen:
            continue
        seen.add(position)
        for node, _, around in _before(*position):
            if node.type == "NORMAL_MAP":
                yield from (image for image, _ in _sources(node.inputs["Color"], around))
            elif node.type == "BUMP":
                pending.append((node.inputs["Normal"], around))
            elif not node.type.startswith("TEX_"):
                pending += [(input_, around) for input_ in node.inputs if input_.enabled]


def _before(
    socket: bpy.types.NodeSocket, groups: Groups
) -> Iterator[tuple[bpy.types.Node, bpy.types.NodeSocket, Groups]]:
    """Yields the node and output that a socket gets its value from, through reroutes and groups."""
    source, node, around = nodes.origin(socket, groups)
    if node is not None:
        yield node, source, around


def _sources(
    socket: bpy.types.NodeSocket, groups: Groups
) -> Iterator[tuple[bpy.types.Image, _Request]]:
    """Yields the images that a socket gets its value from, and the channels that it uses."""
    pending: list[tuple[bpy.types.NodeSocket, Groups, _Request]] = [(socket, groups, _Request())]
    seen: set[Any] = set()
    while pending:
        position = pending.pop(0)
        if position in seen:
            continue
        seen.add(position)
        request = position[2]
        for node, source, around in _before(position[0], position[1]):
            if node.type == "TEX_IMAGE":
                if node.image is not None:
                    is_alpha = source.name == "Alpha"
                    yield node.image, replace(request, channel="alpha") if is_alpha else request
            else:
                pending += [
                    (input_, around, before)
                    for input_, before in _input_requests(node, source, request)
                    if input_.enabled
                ]


def _input_requests(
    node: bpy.types.Node, source: bpy.types.NodeSocket, request: _Request
) -> list[tuple[bpy.types.NodeSocket, _Request]]:
    """Converts a request at an output of a node to requests at the inputs that affect it."""
    inputs = list(node.inputs)
    if node.type in _SEPARATING:
        is_rgb = getattr(node, "mode", "RGB") == "RGB"
        channel = _SEPARATED.get(source.name, "all") if is_rgb else "all"
        return [(inputs[0], replace(request, channel=channel))]
    if node.type in _COMBINING:
        is_rgb = getattr(node, "mode", "RGB") == "RGB"
        if is_rgb and request.channel in _ORDER:
            inputs = inputs[_ORDER.index(request.channel) :][:1]
        return [(input_, replace(request, channel="all")) for input_ in inputs]
    if node.type == "MATH":
        return [(input_, _before_math(node, i, request)) for i, input_ in enumerate(inputs)]
    if node.type == "VALTORGB":
        return [(inputs[0], _before_ramp(node, request))]
    if node.type in _NODE_INPUTS or node.type.startswith("TEX_"):
        # These nodes define roles themselves, and other textures generate their colors.
        return []
    return [
        (input_, replace(request, channel="all", threshold=None, is_factor=True))
        if input_.name in _FACTORS
        else (input_, request)
        for input_ in inputs
    ]


def _before_math(node: bpy.types.Node, index: int, request: _Request) -> _Request:
    """Request at an input of a Math node, with the threshold of a test converted to the input."""
    others = [other for i, other in enumerate(node.inputs) if i != index and other.enabled]
    if any(nodes.link_into(other) is not None for other in others):
        return request
    constants = [other.default_value for other in others]
    threshold = _threshold(node.operation, index, constants, request.threshold)
    return replace(request, threshold=threshold)


def _threshold(
    operation: str, index: int, others: list[float], threshold: float | None
) -> float | None:
    """Converts the threshold of a result to that of an operand.

    Args:
        operation: Operation of a Math node.
        index: Index of the operand.
        others: Constants of the other operands.
        threshold: Threshold of the result; None if it is not tested.
    """
    if operation in {"LESS_THAN", "GREATER_THAN"}:
        return others[0]
    if operation in {"ROUND", "CEIL", "FLOOR"}:
        return {"ROUND": 0.5, "CEIL": 0.0, "FLOOR": 1.0}[operation]
    if operation == "COMPARE" and index < 2:
        value, epsilon = others
        return value - epsilon if value - epsilon > 0.0 else value + epsilon
    if threshold is None:
        return None
    if operation == "MULTIPLY" and others[0] != 0.0:
        return threshold / others[0]
    if operation == "DIVIDE" and index == 0:
        return threshold * others[0]
    if operation == "ADD":
        return threshold - others[0]
    if operation == "SUBTRACT":
        return threshold + others[0] if index == 0 else others[0] - threshold
    if operation == "MULTIPLY_ADD" and index < 2 and others[0] != 0.0:
        return (threshold - others[1]) / others[0]
    return threshold


def _before_ramp(node: bpy.types.Node, request: _Request) -> _Request:
    """Request at the input of a Color Ramp, which is a test if it has two constant colors."""
    stops = node.color_ramp.elements
    if node.color_ramp.interpolation == "CONSTANT" and len(stops) == 2:
        return _Request("all", stops[1].position, request.is_factor)
    return _Request("all", None, request.is_factor)
