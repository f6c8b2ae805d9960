# SPDX-License-Identifier: GPL-3.0-or-later

"""What images are to a material: colors, normals, roughness, a channel of something, coverage."""

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
_OF_OTHER_NODES = {
    "NORMAL_MAP": ("Color", "Normal Map", "normal"),
    "BUMP": ("Height", "Bump", "data"),
    "DISPLACEMENT": ("Height", "Displacement", "data"),
    "VECTOR_DISPLACEMENT": ("Vector", "Vector Displacement", "data"),
}
"""Inputs of nodes that stand before shaders, with a label and a use."""


@dataclass(frozen=True)
class Role:
    """What an input of a shader takes of an image.

    Attributes:
        image: The image.
        label: The input, such as "Base Color" or "Normal Map".
        use: "color", "data", "normal", or "coverage" for what says how much of the surface shows.
        channel: "all", "red", "green" or "blue" of the color, or "alpha".
        threshold: The value of the channel at which a test turns the input on or off; None
            without one.
        is_factor: Whether it only mixes what the input gets, as a mask.
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
        channel: As in `Role`.
        normal_maps: The images that its normals come from, through Normal Map nodes.
    """

    image: bpy.types.Image
    channel: str
    normal_maps: tuple[bpy.types.Image, ...]


@dataclass(frozen=True)
class _Request:
    """What is asked of a socket on the way from an input to images."""

    channel: str = "all"
    threshold: float | None = None
    is_factor: bool = False


def roles(material: bpy.types.Material) -> list[Role]:
    """Returns what images are to the shaders of a material, each role once.

    Groups, reroutes and nodes that change values are followed, muted nodes passed by. A shader
    needs no connection to the output.
    """
    found: dict[Role, None] = {}
    for socket, groups, label, use in _inputs(material):
        for image, request in _sources(socket, groups):
            threshold = request.threshold if use == "coverage" else None
            role = Role(image, label, use, request.channel, threshold, request.is_factor)
            found[role] = None
    return list(found)


def inputs_of(
    material: bpy.types.Material, image: bpy.types.Image
) -> Iterator[tuple[Role, bpy.types.NodeSocket, Groups]]:
    """Yields the inputs that get values from an image, each once for what it takes; no masks."""
    for socket, groups, label, use in _inputs(material):
        for found, request in dict.fromkeys(_sources(socket, groups)):
            if found == image and not request.is_factor:
                yield Role(image, label, use, request.channel), socket, groups


def roughness(material: bpy.types.Material) -> list[Roughness]:
    """Returns the shaders of a material whose roughness comes from images."""
    found: dict[Roughness, None] = {}
    for node, groups in nodes.walk(nodes.tree_of(material)):
        if not _is_shader(node) or "Roughness" not in node.inputs:
            continue
        normals: dict[bpy.types.Image, None] = {}
        if "Normal" in node.inputs:
            normals.update((image, None) for image in _normal_maps(node.inputs["Normal"], groups))
        for image, request in _sources(node.inputs["Roughness"], groups):
            if not request.is_factor:
                found[Roughness(image, request.channel, tuple(normals))] = None
    return list(found)


def has_base_color_of(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Tells whether a shader of a material gets its base color from an image.

    That is the input Base Color, or the only color of a Diffuse BSDF and an Emission.
    """
    labels = {"Base Color", *_ONE_COLOR.values()}
    return any(
        role.label in labels and role.channel != "alpha" and not role.is_factor
        for role in _of(material, image)
    )


def has_alpha_of(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Tells whether a material shows as much of the surface as the alpha of an image says.

    So it does where the Alpha output of an Image Texture node leads to the input Alpha of a shader,
    or to the factor of a Mix Shader that has a Transparent BSDF on one side. An image whose alpha
    mode is None has no alpha to a shader.
    """
    return image.alpha_mode != "NONE" and any(
        role.use == "coverage" and role.channel == "alpha" and not role.is_factor
        for role in _of(material, image)
    )


def shows_as_color(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    """Tells whether a shader of a material has an image as a color, and no other image there.

    It may be multiplied by what is no image; what a ramp or other nodes make of its values is
    another color.
    """
    for socket, groups, _, use in _inputs(material):
        if use == "color" and image in _unchanged(socket, groups):
            sources = _sources(socket, groups)
            if {found for found, asked in sources if not asked.is_factor} == {image}:
                return True
    return False


def _unchanged(socket: bpy.types.NodeSocket, groups: Groups) -> Iterator[bpy.types.Image]:
    """Yields the images whose colors lead to a socket as they are, or are mixed there."""
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
    """Yields the inputs where roles are told apart, with a label and a use."""
    tree = nodes.tree_of(material)
    for node, groups in nodes.walk(tree):
        if node.type in _OF_OTHER_NODES:
            name, label, use = _OF_OTHER_NODES[node.type]
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
        # Groups without outputs are where the glTF importer keeps what Blender has no input for.
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
    """Yields the images of the Normal Map nodes that a Normal input gets its value from."""
    pending, seen = [(socket, groups)], set()
    while pending:
        place = pending.pop()
        if place in seen:
            continue
        seen.add(place)
        for node, _, around in _before(*place):
            if node.type == "NORMAL_MAP":
                yield from (image for image, _ in _sources(node.inputs["Color"], around))
            elif node.type == "BUMP":
                pending.append((node.inputs["Normal"], around))
            elif not node.type.startswith("TEX_"):
                pending += [(input_, around) for input_ in node.inputs if input_.enabled]


def _before(
    socket: bpy.types.NodeSocket, groups: Groups
) -> Iterator[tuple[bpy.types.Node, bpy.types.NodeSocket, Groups]]:
    """Yields the node and its output that a socket gets its value from, however far it is led."""
    source, node, around = nodes.origin(socket, groups)
    if node is not None:
        yield node, source, around


def _sources(
    socket: bpy.types.NodeSocket, groups: Groups
) -> Iterator[tuple[bpy.types.Image, _Request]]:
    """Yields the images that a socket gets its value from, and what it takes of them."""
    pending: list[tuple[bpy.types.NodeSocket, Groups, _Request]] = [(socket, groups, _Request())]
    seen: set[Any] = set()
    while pending:
        place = pending.pop(0)
        if place in seen:
            continue
        seen.add(place)
        asked = place[2]
        for node, source, around in _before(place[0], place[1]):
            if node.type == "TEX_IMAGE":
                if node.image is not None:
                    is_alpha = source.name == "Alpha"
                    yield node.image, replace(asked, channel="alpha") if is_alpha else asked
            else:
                pending += [
                    (input_, around, request)
                    for input_, request in _asked_of(node, source, asked)
                    if input_.enabled
                ]


def _asked_of(
    node: bpy.types.Node, source: bpy.types.NodeSocket, asked: _Request
) -> list[tuple[bpy.types.NodeSocket, _Request]]:
    """Returns the inputs of a node that matter to an output of it, and what they are asked for."""
    inputs = list(node.inputs)
    if node.type in _SEPARATING:
        is_rgb = getattr(node, "mode", "RGB") == "RGB"
        channel = _SEPARATED.get(source.name, "all") if is_rgb else "all"
        return [(inputs[0], replace(asked, channel=channel))]
    if node.type in _COMBINING:
        is_rgb = getattr(node, "mode", "RGB") == "RGB"
        if is_rgb and asked.channel in _ORDER:
            inputs = inputs[_ORDER.index(asked.channel) :][:1]
        return [(input_, replace(asked, channel="all")) for input_ in inputs]
    if node.type == "MATH":
        return [(input_, _before_math(node, i, asked)) for i, input_ in enumerate(inputs)]
    if node.type == "VALTORGB":
        return [(inputs[0], _before_ramp(node, asked))]
    if node.type in _OF_OTHER_NODES or node.type.startswith("TEX_"):
        # These have their own roles, and other textures make their colors themselves.
        return []
    return [
        (input_, replace(asked, channel="all", threshold=None, is_factor=True))
        if input_.name in _FACTORS
        else (input_, asked)
        for input_ in inputs
    ]


def _before_math(node: bpy.types.Node, index: int, asked: _Request) -> _Request:
    """Returns what the input of a Math node is asked for: a test, or a threshold carried over."""
    others = [other for i, other in enumerate(node.inputs) if i != index and other.enabled]
    if any(nodes.link_into(other) is not None for other in others):
        return asked
    constants = [other.default_value for other in others]
    threshold = _threshold(node.operation, index, constants, asked.threshold)
    return replace(asked, threshold=threshold)


def _threshold(
    operation: str, index: int, others: list[float], threshold: float | None
) -> float | None:
    """Returns at which value of an operand a test changes, given that of the result.

    Args:
        operation: Of a Math node.
        index: Of the operand.
        others: The other operands, constants.
        threshold: Of the result; None if it is not tested.
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


def _before_ramp(node: bpy.types.Node, asked: _Request) -> _Request:
    """Returns what the input of a Color Ramp is asked for: a test if it has two flat colors."""
    stops = node.color_ramp.elements
    if node.color_ramp.interpolation == "CONSTANT" and len(stops) == 2:
        return _Request("all", stops[1].position, asked.is_factor)
    return _Request("all", None, asked.is_factor)
