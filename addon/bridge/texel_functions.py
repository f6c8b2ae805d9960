# SPDX-License-Identifier: GPL-3.0-or-later

"""What shader nodes make of the texels of one image, on their way to an input of a shader."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import node_math, nodes
from .nodes import Groups

Values: Any = NDArray[np.float32]
"""(height, width) numbers, or (height, width, 3) colors or vectors; a constant has sides of 1."""

_SAMPLES = 255 * 16 + 1
"""Of curves and ramps between 0 and 1: the values of bytes are among them."""
_PASSING = frozenset({"NORMAL_MAP", "SEPARATE_COLOR", "SEPRGB", "SEPXYZ"})
"""What formats for engines say themselves: what a normal map is, and which channel is read."""


class OtherNodeError(Exception):
    """A node whose result is not known from the texel alone.

    Attributes:
        node: The node.
    """

    def __init__(self, node: bpy.types.Node) -> None:
        """Takes the node."""
        super().__init__(node.name)
        self.node = node


@dataclass
class TexelFunction:
    """The values that reach an input, from those of an image.

    Attributes:
        image: The image; None before `values` has met one.
        changing: The nodes on the way that change values.
    """

    color_of: Callable[[bpy.types.Image], NDArray[np.float32]]
    image: bpy.types.Image | None = None
    changing: dict[bpy.types.Node, None] = field(default_factory=dict)

    def values(self, socket: bpy.types.NodeSocket, groups: Groups) -> NDArray[np.float32]:
        """Returns what an input gets, in the shape of its type.

        Raises:
            OtherNodeError: Something else than one image has a part in it.
        """
        last, node, around = nodes.origin(socket, groups)
        if node is None:
            return _as_type(_constant(last), socket.type)
        found = self._output(node, last, around)
        return _as_type(found, socket.type)

    def _output(
        self, node: bpy.types.Node, output: bpy.types.NodeSocket, groups: Groups
    ) -> NDArray[np.float32]:
        if node.type == "TEX_IMAGE":
            return self._texels(node, output)
        if node.type in ("RGB", "VALUE"):
            return _constant(output)
        evaluate = _NODES.get(node.type)
        if evaluate is None:
            raise OtherNodeError(node)
        if node.type not in _PASSING:
            self.changing[node] = None

        def get(key: int | str) -> NDArray[np.float32]:
            return self.values(node.inputs[key], groups)

        try:
            return np.asarray(evaluate(node, get, output), np.float32)
        except node_math.UnknownOperationError:
            raise OtherNodeError(node) from None

    def _texels(self, node: bpy.types.Node, output: bpy.types.NodeSocket) -> NDArray[np.float32]:
        if node.image is None or self.image not in (None, node.image):
            raise OtherNodeError(node)
        self.image = node.image
        texels = self.color_of(node.image)
        if output.name != "Alpha":
            return texels[..., :3]
        return texels[..., 3] if texels.shape[2] == 4 else np.ones(texels.shape[:2], np.float32)


def before_factor(
    socket: bpy.types.NodeSocket, groups: Groups
) -> tuple[bpy.types.NodeSocket, Groups]:
    """Returns the input whose values a texture for an engine is to have.

    A multiplication with a constant just before the shader is a factor of the material there. The
    input Color of a Normal Map node is that of normals.
    """
    _, node, around = nodes.origin(socket, groups)
    if node is None:
        return socket, groups
    if node.type == "NORMAL_MAP":
        return node.inputs["Color"], around
    operands: list[bpy.types.NodeSocket] = []
    if socket.type == "RGBA" and node.type == "MIX" and node.data_type == "RGBA":
        names = ("A_Color", "B_Color") if node.blend_type == "MULTIPLY" else ()
        operands = [one for one in node.inputs if one.identifier in names]
    elif socket.type == "VALUE" and node.type == "MATH" and node.operation == "MULTIPLY":
        operands = list(node.inputs[:2])
    varying = [one for one in operands if not _is_constant(one, around)]
    if len(operands) == 2 and len(varying) == 1:
        return varying[0], around
    return socket, groups


def partial_factor(socket: bpy.types.NodeSocket, groups: Groups) -> bpy.types.Node | None:
    """Returns the multiplication that `before_factor` leaves out, if it is not of full strength."""
    _, node, _around = nodes.origin(socket, groups)
    if node is None or node.type != "MIX" or before_factor(socket, groups) == (socket, groups):
        return None
    strength = next(one for one in node.inputs if one.identifier == "Factor_Float")
    is_full = nodes.link_into(strength) is None and strength.default_value == 1.0
    return None if is_full else node


def _is_constant(socket: bpy.types.NodeSocket, groups: Groups) -> bool:
    _, node, _ = nodes.origin(socket, groups)
    return node is None or node.type in ("RGB", "VALUE")


def _constant(socket: bpy.types.NodeSocket) -> NDArray[np.float32]:
    """Returns the value that a socket without a link has, as an image of one texel."""
    value = np.array(getattr(socket, "default_value", 0.0), np.float32)
    return value.reshape(1, 1) if value.ndim == 0 else value[:3].reshape(1, 1, -1)


def _as_type(values: NDArray[np.float32], kind: str) -> NDArray[np.float32]:
    """Returns values as sockets of a type get them."""
    is_number = kind in ("VALUE", "INT", "BOOLEAN")
    if is_number and values.ndim == 3:
        return values @ np.array([0.2126729, 0.7151522, 0.0721750], np.float32)
    if not is_number and values.ndim == 2:
        return np.repeat(values[..., None], 3, axis=2)
    return values


_Get = Callable[[Any], NDArray[np.float32]]


def _sampled(values: NDArray[np.float32], table: NDArray[np.float32]) -> NDArray[np.float32]:
    """Looks values from 0 to 1 up in a table."""
    places = np.linspace(0.0, 1.0, len(table))
    return np.interp(np.clip(values, 0.0, 1.0), places, table).astype(np.float32)


def _curve(mapping: Any, number: int) -> NDArray[np.float32]:
    mapping.initialize()
    curve = mapping.curves[number]
    places = np.linspace(0.0, 1.0, _SAMPLES).tolist()
    return np.array([mapping.evaluate(curve, place) for place in places], np.float32)


def _rgb_curves(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    color, factor = get("Color"), node_math.as_factor(get(0))
    combined = _sampled(color, _curve(node.mapping, 3))
    found = [_sampled(combined[..., k], _curve(node.mapping, k)) for k in range(3)]
    return node_math.mixed(factor, color, np.stack(found, axis=-1))


def _float_curve(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    value, factor = get("Value"), get(0)
    return value + factor * (_sampled(value, _curve(node.mapping, 0)) - value)


def _ramp(node: bpy.types.Node, get: _Get, output: Any) -> NDArray[np.float32]:
    places = np.linspace(0.0, 1.0, _SAMPLES).tolist()
    table = np.array([tuple(node.color_ramp.evaluate(place)) for place in places], np.float32)
    value = get(0)
    if output.name == "Alpha":
        return _sampled(value, table[:, 3])
    return np.stack([_sampled(value, table[:, k]) for k in range(3)], axis=-1)


def _invert(_node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    color = get("Color")
    return node_math.mixed(node_math.as_factor(get(0)), color, 1 - color)


def _separate(node: bpy.types.Node, get: _Get, output: Any) -> NDArray[np.float32]:
    color = node_math.to_mode(getattr(node, "mode", "RGB"), get(0))
    return color[..., list(node.outputs).index(output)]


def _combine(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    parts = np.broadcast_arrays(get(0), get(1), get(2))
    return node_math.from_mode(getattr(node, "mode", "RGB"), np.stack(parts, axis=-1))


def _math(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    found = node_math.calculated(node.operation, [get(k) for k in range(len(node.inputs))])
    return np.clip(found, 0, 1) if node.use_clamp else found


def _vector_math(node: bpy.types.Node, get: _Get, output: Any) -> NDArray[np.float32]:
    vectors = [get(k) for k in range(3)]
    return node_math.vectors_calculated(node.operation, vectors, get(3))


def _mix(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    kinds = {"FLOAT": ("Factor_Float", "A_Float", "B_Float")}
    kinds["VECTOR"] = ("Factor_Float", "A_Vector", "B_Vector")
    kinds["RGBA"] = ("Factor_Float", "A_Color", "B_Color")
    if node.data_type not in kinds:
        raise node_math.UnknownOperationError
    is_uniform = node.data_type != "VECTOR" or node.factor_mode == "UNIFORM"
    names = kinds[node.data_type] if is_uniform else ("Factor_Vector", "A_Vector", "B_Vector")
    numbers = {one.identifier: number for number, one in enumerate(node.inputs)}
    factor, first, second = (get(numbers[name]) for name in names)
    if node.clamp_factor:
        factor = np.clip(factor, 0, 1)
    if node.data_type == "FLOAT":
        return first + factor * (second - first)
    factor = factor if factor.ndim == 3 else factor[..., None]
    if node.data_type == "VECTOR":
        return first + factor * (second - first)
    found = node_math.blended(node.blend_type, factor, first, second)
    return np.clip(found, 0, 1) if node.clamp_result else found


def _mix_rgb(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    factor = node_math.as_factor(np.clip(get(0), 0, 1))
    found = node_math.blended(node.blend_type, factor, get(1), get(2))
    return np.clip(found, 0, 1) if node.use_clamp else found


def _bright_contrast(_node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    bright, contrast = get("Bright")[..., None], get("Contrast")[..., None]
    return np.maximum((1 + contrast) * get("Color") + bright - contrast / 2, 0)


def _gamma(_node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    color, power = get("Color"), get("Gamma")[..., None]
    return np.where(color > 0, np.abs(color) ** power, color)


def _hue_saturation(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    numbers = {one.identifier: number for number, one in enumerate(node.inputs)}
    names = ("Hue", "Saturation", "Value")
    hue, saturation, value = (get(numbers[name]) for name in names)
    color = get(numbers["Color"])
    factor = node_math.as_factor(get(numbers["Fac" if "Fac" in numbers else "Factor"]))
    h, s, v = np.moveaxis(node_math.to_mode("HSV", color), -1, 0)
    changed = [(h + hue + 0.5) % 1.0, np.clip(s * saturation, 0, 1), v * value]
    found = node_math.from_mode("HSV", np.stack(np.broadcast_arrays(*changed), axis=-1))
    return np.maximum(node_math.mixed(factor, color, found), 0)


def _map_range(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    if node.data_type != "FLOAT":
        raise node_math.UnknownOperationError
    value, *ends = (get(k) for k in range(5))
    steps = get("Steps") if node.interpolation_type == "STEPPED" else None
    return node_math.mapped(node.interpolation_type, value, ends, steps, is_clamped=node.clamp)


def _clamp(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    low, high = get("Min"), get("Max")
    if node.clamp_type == "RANGE":
        low, high = np.minimum(low, high), np.maximum(low, high)
    return np.minimum(np.maximum(get("Value"), low), high)


_NODES: dict[str, Callable[[Any, _Get, Any], Any]] = {
    "NORMAL_MAP": lambda _node, get, _: get("Color"),
    "CURVE_RGB": _rgb_curves,
    "CURVE_FLOAT": _float_curve,
    "VALTORGB": _ramp,
    "INVERT": _invert,
    "SEPARATE_COLOR": _separate,
    "SEPRGB": _separate,
    "SEPXYZ": _separate,
    "COMBINE_COLOR": _combine,
    "COMBRGB": _combine,
    "COMBXYZ": _combine,
    "MATH": _math,
    "VECT_MATH": _vector_math,
    "MIX": _mix,
    "MIX_RGB": _mix_rgb,
    "GAMMA": _gamma,
    "BRIGHTCONTRAST": _bright_contrast,
    "HUE_SAT": _hue_saturation,
    "MAP_RANGE": _map_range,
    "CLAMP": _clamp,
    "RGBTOBW": lambda _node, get, _: _as_type(get(0), "VALUE"),
}
"""What nodes make of their inputs, by type: of the node, of a function that gets these, and of the
output that is asked for."""
