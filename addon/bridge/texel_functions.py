# SPDX-License-Identifier: GPL-3.0-or-later

"""Evaluation of shader nodes between one image and an input of a shader, per texel."""

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
"""Number of samples of curves and ramps between 0 and 1, including all byte values."""
_PASSING = frozenset({"NORMAL_MAP", "SEPARATE_COLOR", "SEPRGB", "SEPXYZ"})
"""Nodes that engines' formats express themselves: normal maps, and the channel of a texture."""


class OtherNodeError(Exception):
    """A node whose result does not depend on the texel alone.

    Attributes:
        node: The node.
    """

    def __init__(self, node: bpy.types.Node) -> None:
        """Keeps the node."""
        super().__init__(node.name)
        self.node = node


@dataclass
class TexelFunction:
    """Evaluates inputs of shaders as functions of an image's texels.

    Attributes:
        color_of: Returns the texels of an image.
        image: The image; None before `values` has found one.
        changing: Nodes between image and input that change values.
    """

    color_of: Callable[[bpy.types.Image], NDArray[np.float32]]
    image: bpy.types.Image | None = None
    changing: dict[bpy.types.Node, None] = field(default_factory=dict)

    def values(self, socket: bpy.types.NodeSocket, groups: Groups) -> NDArray[np.float32]:
        """Returns the values of an input, in the shape of its type.

        Raises:
            OtherNodeError: The values depend on anything but one image.
        """
        source, node, around = nodes.origin(socket, groups)
        if node is None:
            return _as_type(_constant(source), socket.type)
        return _as_type(self._output(node, source, around), socket.type)

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
    """Returns the input whose values an exported texture should have.

    A multiplication by a constant directly before the shader is exported as a factor of the
    material. For normals it is the input Color of a Normal Map node.
    """
    _, node, around = nodes.origin(socket, groups)
    if node is None:
        return socket, groups
    if node.type == "NORMAL_MAP":
        return node.inputs["Color"], around
    operands: list[bpy.types.NodeSocket] = []
    if socket.type == "RGBA" and node.type == "MIX" and node.data_type == "RGBA":
        names = ("A_Color", "B_Color") if node.blend_type == "MULTIPLY" else ()
        operands = [operand for operand in node.inputs if operand.identifier in names]
    elif socket.type == "VALUE" and node.type == "MATH" and node.operation == "MULTIPLY":
        operands = list(node.inputs[:2])
    varying = [operand for operand in operands if not _is_constant(operand, around)]
    if len(operands) == 2 and len(varying) == 1:
        return varying[0], around
    return socket, groups


def partial_factor(socket: bpy.types.NodeSocket, groups: Groups) -> bpy.types.Node | None:
    """Returns the multiplication that `before_factor` skips if its mix factor is not 1."""
    _, node, _around = nodes.origin(socket, groups)
    if node is None or node.type != "MIX" or before_factor(socket, groups) == (socket, groups):
        return None
    strength = next(each for each in node.inputs if each.identifier == "Factor_Float")
    is_full = nodes.link_into(strength) is None and strength.default_value == 1.0
    return None if is_full else node


def _is_constant(socket: bpy.types.NodeSocket, groups: Groups) -> bool:
    _, node, _ = nodes.origin(socket, groups)
    return node is None or node.type in ("RGB", "VALUE")


def _constant(socket: bpy.types.NodeSocket) -> NDArray[np.float32]:
    """Value of an unlinked socket, as an image of one texel."""
    value = np.array(getattr(socket, "default_value", 0.0), np.float32)
    return value.reshape(1, 1) if value.ndim == 0 else value[:3].reshape(1, 1, -1)


def _as_type(values: NDArray[np.float32], kind: str) -> NDArray[np.float32]:
    """Converts values to the type of a socket."""
    is_number = kind in ("VALUE", "INT", "BOOLEAN")
    if is_number and values.ndim == 3:
        return values @ np.array([0.2126729, 0.7151522, 0.0721750], np.float32)
    if not is_number and values.ndim == 2:
        return np.repeat(values[..., None], 3, axis=2)
    return values


_Get = Callable[[Any], NDArray[np.float32]]


def _sampled(values: NDArray[np.float32], table: NDArray[np.float32]) -> NDArray[np.float32]:
    """Looks up values from 0 to 1 in a table, with interpolation."""
    positions = np.linspace(0.0, 1.0, len(table))
    return np.interp(np.clip(values, 0.0, 1.0), positions, table).astype(np.float32)


def _curve(mapping: Any, number: int) -> NDArray[np.float32]:
    mapping.initialize()
    curve = mapping.curves[number]
    positions = np.linspace(0.0, 1.0, _SAMPLES).tolist()
    return np.array([mapping.evaluate(curve, position) for position in positions], np.float32)


def _rgb_curves(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    color, factor = get("Color"), node_math.as_factor(get(0))
    combined = _sampled(color, _curve(node.mapping, 3))
    channels = [_sampled(combined[..., k], _curve(node.mapping, k)) for k in range(3)]
    return node_math.mix(factor, color, np.stack(channels, axis=-1))


def _float_curve(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    value, factor = get("Value"), get(0)
    return value + factor * (_sampled(value, _curve(node.mapping, 0)) - value)


def _ramp(node: bpy.types.Node, get: _Get, output: Any) -> NDArray[np.float32]:
    positions = np.linspace(0.0, 1.0, _SAMPLES).tolist()
    table = np.array([tuple(node.color_ramp.evaluate(each)) for each in positions], np.float32)
    value = get(0)
    if output.name == "Alpha":
        return _sampled(value, table[:, 3])
    return np.stack([_sampled(value, table[:, k]) for k in range(3)], axis=-1)


def _invert(_node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    color = get("Color")
    return node_math.mix(node_math.as_factor(get(0)), color, 1 - color)


def _separate(node: bpy.types.Node, get: _Get, output: Any) -> NDArray[np.float32]:
    color = node_math.to_mode(getattr(node, "mode", "RGB"), get(0))
    return color[..., list(node.outputs).index(output)]


def _combine(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    parts = np.broadcast_arrays(get(0), get(1), get(2))
    return node_math.from_mode(getattr(node, "mode", "RGB"), np.stack(parts, axis=-1))


def _math(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    result = node_math.evaluate_math(node.operation, [get(k) for k in range(len(node.inputs))])
    return np.clip(result, 0, 1) if node.use_clamp else result


def _vector_math(node: bpy.types.Node, get: _Get, output: Any) -> NDArray[np.float32]:
    vectors = [get(k) for k in range(3)]
    return node_math.evaluate_vector_math(node.operation, vectors, get(3))


def _mix(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    kinds = {"FLOAT": ("Factor_Float", "A_Float", "B_Float")}
    kinds["VECTOR"] = ("Factor_Float", "A_Vector", "B_Vector")
    kinds["RGBA"] = ("Factor_Float", "A_Color", "B_Color")
    if node.data_type not in kinds:
        raise node_math.UnknownOperationError
    is_uniform = node.data_type != "VECTOR" or node.factor_mode == "UNIFORM"
    names = kinds[node.data_type] if is_uniform else ("Factor_Vector", "A_Vector", "B_Vector")
    indices = {socket.identifier: index for index, socket in enumerate(node.inputs)}
    factor, first, second = (get(indices[name]) for name in names)
    if node.clamp_factor:
        factor = np.clip(factor, 0, 1)
    if node.data_type == "FLOAT":
        return first + factor * (second - first)
    factor = factor if factor.ndim == 3 else factor[..., None]
    if node.data_type == "VECTOR":
        return first + factor * (second - first)
    result = node_math.blend_colors(node.blend_type, factor, first, second)
    return np.clip(result, 0, 1) if node.clamp_result else result


def _mix_rgb(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    factor = node_math.as_factor(np.clip(get(0), 0, 1))
    result = node_math.blend_colors(node.blend_type, factor, get(1), get(2))
    return np.clip(result, 0, 1) if node.use_clamp else result


def _bright_contrast(_node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    bright, contrast = get("Bright")[..., None], get("Contrast")[..., None]
    return np.maximum((1 + contrast) * get("Color") + bright - contrast / 2, 0)


def _gamma(_node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    color, power = get("Color"), get("Gamma")[..., None]
    return np.where(color > 0, np.abs(color) ** power, color)


def _hue_saturation(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    indices = {socket.identifier: index for index, socket in enumerate(node.inputs)}
    names = ("Hue", "Saturation", "Value")
    hue, saturation, value = (get(indices[name]) for name in names)
    color = get(indices["Color"])
    factor = node_math.as_factor(get(indices["Fac" if "Fac" in indices else "Factor"]))
    h, s, v = np.moveaxis(node_math.to_mode("HSV", color), -1, 0)
    changed = [(h + hue + 0.5) % 1.0, np.clip(s * saturation, 0, 1), v * value]
    result = node_math.from_mode("HSV", np.stack(np.broadcast_arrays(*changed), axis=-1))
    return np.maximum(node_math.mix(factor, color, result), 0)


def _map_range(node: bpy.types.Node, get: _Get, _: Any) -> NDArray[np.float32]:
    if node.data_type != "FLOAT":
        raise node_math.UnknownOperationError
    value, *ends = (get(k) for k in range(5))
    steps = get("Steps") if node.interpolation_type == "STEPPED" else None
    return node_math.map_range(node.interpolation_type, value, ends, steps, is_clamped=node.clamp)


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
"""Functions that evaluate nodes, by type: of the node, of a function that evaluates an input, and
of the output."""
