# SPDX-License-Identifier: GPL-3.0-or-later

"""Shader nodes' calculations on arrays, as Cycles does them per texel."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float32]


class UnknownOperationError(Exception):
    """An operation that is not implemented here."""


def as_factor(values: Values) -> Values:
    """Adds an axis, so that the values are factors of colors."""
    return values[..., None]


def mix(factor: Values, first: Values, second: Values) -> Values:
    """Interpolates between two values."""
    return first + factor * (second - first)


def _quotient(a: Any, b: Any) -> Any:
    a, b = np.broadcast_arrays(a, b)
    return np.divide(a, b, out=np.zeros(a.shape, np.float32), where=b != 0)


def _power(a: Any, b: Any) -> Any:
    is_real = (a >= 0) | (b == np.round(b))
    return np.where(is_real, np.power(np.where(is_real, a, 1), b), 0)


def _truncated_modulo(a: Any, b: Any) -> Any:
    return np.where(b != 0, np.fmod(a, np.where(b != 0, b, 1)), 0)


def _floored_modulo(a: Any, b: Any) -> Any:
    return np.where(b != 0, a - np.floor(_quotient(a, b)) * b, 0)


def _wrapped(a: Any, high: Any, low: Any) -> Any:
    span = high - low
    return np.where(span != 0, a - span * np.floor(_quotient(a - low, span)), low)


def _fraction(a: Any) -> Any:
    return a - np.floor(a)


def _pingpong(a: Any, b: Any) -> Any:
    return np.where(b != 0, np.abs(_fraction(_quotient(a - b, 2 * b)) * b * 2 - b), 0)


def _snapped(a: Any, b: Any) -> Any:
    return np.floor(_quotient(a, b)) * b


def _smooth_minimum(a: Any, b: Any, c: Any) -> Any:
    share = np.maximum(_quotient(c - np.abs(a - b), c), 0)
    return np.where(c != 0, np.minimum(a, b) - share**3 * c / 6, np.minimum(a, b))


def _logarithm(a: Any, b: Any) -> Any:
    is_real = (a > 0) & (b > 0)
    a, b = np.where(is_real, a, 1), np.where(is_real, b, 2)
    return np.where(is_real, _quotient(np.log(a), np.log(b)), 0)


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "ADD": lambda a, b, c: a + b,
    "SUBTRACT": lambda a, b, c: a - b,
    "MULTIPLY": lambda a, b, c: a * b,
    "DIVIDE": lambda a, b, c: _quotient(a, b),
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": lambda a, b, c: _power(a, b),
    "LOGARITHM": lambda a, b, c: _logarithm(a, b),
    "SQRT": lambda a, b, c: np.sqrt(np.maximum(a, 0)),
    "INVERSE_SQRT": lambda a, b, c: np.where(a > 0, _quotient(1.0, np.sqrt(np.maximum(a, 0))), 0),
    "ABSOLUTE": lambda a, b, c: np.abs(a),
    "EXPONENT": lambda a, b, c: np.exp(a),
    "MINIMUM": lambda a, b, c: np.minimum(a, b),
    "MAXIMUM": lambda a, b, c: np.maximum(a, b),
    "LESS_THAN": lambda a, b, c: (a < b).astype(np.float32),
    "GREATER_THAN": lambda a, b, c: (a > b).astype(np.float32),
    "SIGN": lambda a, b, c: np.sign(a),
    "COMPARE": lambda a, b, c: (np.abs(a - b) <= np.maximum(c, 1e-5)).astype(np.float32),
    "SMOOTH_MIN": _smooth_minimum,
    "SMOOTH_MAX": lambda a, b, c: -_smooth_minimum(-a, -b, c),
    "ROUND": lambda a, b, c: np.floor(a + np.float32(0.5)),
    "FLOOR": lambda a, b, c: np.floor(a),
    "CEIL": lambda a, b, c: np.ceil(a),
    "TRUNC": lambda a, b, c: np.trunc(a),
    "FRACT": lambda a, b, c: _fraction(a),
    "MODULO": lambda a, b, c: _truncated_modulo(a, b),
    "FLOORED_MODULO": lambda a, b, c: _floored_modulo(a, b),
    "WRAP": _wrapped,
    "SNAP": lambda a, b, c: _snapped(a, b),
    "PINGPONG": lambda a, b, c: _pingpong(a, b),
    "SINE": lambda a, b, c: np.sin(a),
    "COSINE": lambda a, b, c: np.cos(a),
    "TANGENT": lambda a, b, c: np.tan(a),
    "ARCSINE": lambda a, b, c: np.where(np.abs(a) <= 1, np.arcsin(np.clip(a, -1, 1)), 0),
    "ARCCOSINE": lambda a, b, c: np.where(np.abs(a) <= 1, np.arccos(np.clip(a, -1, 1)), 0),
    "ARCTANGENT": lambda a, b, c: np.arctan(a),
    "ARCTAN2": lambda a, b, c: np.arctan2(a, b),
    "SINH": lambda a, b, c: np.sinh(a),
    "COSH": lambda a, b, c: np.cosh(a),
    "TANH": lambda a, b, c: np.tanh(a),
    "RADIANS": lambda a, b, c: np.deg2rad(a),
    "DEGREES": lambda a, b, c: np.rad2deg(a),
}
_ELEMENTWISE = frozenset(
    {
        *("ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "ABSOLUTE", "MINIMUM"),
        *("MAXIMUM", "FLOOR", "CEIL", "MODULO", "WRAP", "SNAP", "SINE", "COSINE", "TANGENT"),
        *("POWER", "SIGN", "ROUND"),
    }
)
"""Vector operations that apply an operation of numbers to each axis."""


def evaluate_math(operation: str, inputs: Sequence[Values]) -> Values:
    """Evaluates a Math node."""
    evaluate = _OPERATIONS.get(operation)
    if evaluate is None:
        raise UnknownOperationError
    return np.asarray(evaluate(*[*inputs, 0.0, 0.0, 0.0][:3]), np.float32)


def evaluate_vector_math(operation: str, vectors: Sequence[Values], scale: Values) -> Values:
    """Evaluates a Vector Math node; returns a vector or a number."""
    a, b, c = vectors
    if operation in _ELEMENTWISE:
        return evaluate_math(operation, vectors)
    if operation == "FRACTION":
        return np.asarray(_fraction(a), np.float32)
    if operation == "SCALE":
        return a * scale[..., None]
    if operation == "DOT_PRODUCT":
        return (a * b).sum(axis=-1)
    if operation == "CROSS_PRODUCT":
        first, second = np.broadcast_arrays(a, b)
        return np.cross(first, second).astype(np.float32)
    if operation == "LENGTH":
        return np.sqrt((a * a).sum(axis=-1))
    if operation == "DISTANCE":
        return np.sqrt(((a - b) ** 2).sum(axis=-1))
    if operation == "NORMALIZE":
        length = np.sqrt((a * a).sum(axis=-1, keepdims=True))
        return np.asarray(_quotient(a, length), np.float32)
    if operation == "REFLECT":
        normal = evaluate_vector_math("NORMALIZE", (b, b, c), scale)
        return a - 2 * normal * (normal * a).sum(axis=-1, keepdims=True)
    raise UnknownOperationError


def _divided(t: Any, a: Any, b: Any) -> Any:
    return np.where(b != 0, (1 - t) * a + t * _quotient(a, b), a)


def _overlaid(t: Any, a: Any, b: Any) -> Any:
    dark = a * (1 - t + 2 * t * b)
    return np.where(a < 0.5, dark, 1 - (1 - t + 2 * t * (1 - b)) * (1 - a))


def _dodged(t: Any, a: Any, b: Any) -> Any:
    left = 1 - t * b
    bright = np.where(left <= 0, 1, np.minimum(_quotient(a, left), 1))
    return np.where(a != 0, bright, a)


def _burned(t: Any, a: Any, b: Any) -> Any:
    left = 1 - t + t * b
    return np.where(left <= 0, 0, np.clip(1 - _quotient(1 - a, left), 0, 1))


def _soft(t: Any, a: Any, b: Any) -> Any:
    screen = 1 - (1 - b) * (1 - a)
    return (1 - t) * a + t * ((1 - a) * b * a + a * screen)


_BLENDS: dict[str, Callable[[Any, Any, Any], Any]] = {
    "MIX": lambda t, a, b: a + t * (b - a),
    "DARKEN": lambda t, a, b: a + t * (np.minimum(a, b) - a),
    "MULTIPLY": lambda t, a, b: a * (1 - t + t * b),
    "BURN": _burned,
    "LIGHTEN": lambda t, a, b: a + t * (np.maximum(a, b) - a),
    "SCREEN": lambda t, a, b: 1 - (1 - t + t * (1 - b)) * (1 - a),
    "DODGE": _dodged,
    "ADD": lambda t, a, b: a + t * b,
    "OVERLAY": _overlaid,
    "SOFT_LIGHT": _soft,
    "LINEAR_LIGHT": lambda t, a, b: a + t * (2 * b - 1),
    "DIFFERENCE": lambda t, a, b: a + t * (np.abs(a - b) - a),
    "EXCLUSION": lambda t, a, b: np.maximum(a + t * (a + b - 2 * a * b - a), 0),
    "SUBTRACT": lambda t, a, b: a - t * b,
    "DIVIDE": _divided,
}


def blend_colors(blend: str, factor: Values, first: Values, second: Values) -> Values:
    """Evaluates a Mix node for colors; the last axis of `factor` has length 1 or 3."""
    if blend not in _BLENDS:
        raise UnknownOperationError
    return np.asarray(_BLENDS[blend](factor, first, second), np.float32)


def map_range(
    kind: str, value: Values, ends: Sequence[Values], steps: Values | None, *, is_clamped: bool
) -> Values:
    """Evaluates a Map Range node for numbers.

    Args:
        kind: Its interpolation.
        value: Its value.
        ends: From Min, From Max, To Min and To Max.
        steps: Number of steps, for "STEPPED".
        is_clamped: Whether the result is clamped to the target range.
    """
    low, high, to_low, to_high = ends
    share = _quotient(value - low, high - low)
    if kind == "STEPPED" and steps is not None:
        share = np.where(steps > 0, _quotient(np.floor(share * (steps + 1)), steps), 0)
    elif kind == "SMOOTHSTEP":
        share = np.clip(share, 0, 1)
        share = share * share * (3 - 2 * share)
    elif kind == "SMOOTHERSTEP":
        share = np.clip(share, 0, 1)
        share = share**3 * (share * (share * 6 - 15) + 10)
    result = to_low + share * (to_high - to_low)
    if is_clamped and kind in ("LINEAR", "STEPPED"):
        result = np.clip(result, np.minimum(to_low, to_high), np.maximum(to_low, to_high))
    return np.asarray(np.where(high != low, result, 0), np.float32)


def to_mode(mode: str, colors: Values) -> Values:
    """Converts RGB colors to a mode of Separate Color: "RGB", "HSV" or "HSL"."""
    if mode == "RGB":
        return colors
    high, low = colors.max(axis=-1), colors.min(axis=-1)
    span = high - low
    red, green, blue = np.moveaxis(colors, -1, 0)
    sectors = [
        _quotient(green - blue, span) % 6,
        _quotient(blue - red, span) + 2,
        _quotient(red - green, span) + 4,
    ]
    hue = np.select([high == red, high == green], sectors[:2], sectors[2]) / 6
    if mode == "HSV":
        parts = (hue, _quotient(span, high), high)
    elif mode == "HSL":
        light = (high + low) / 2
        parts = (hue, _quotient(span, 1 - np.abs(2 * light - 1)), light)
    else:
        raise UnknownOperationError
    return np.stack([np.asarray(part, np.float32) for part in parts], axis=-1)


def from_mode(mode: str, parts: Values) -> Values:
    """Converts the inputs of Combine Color in a mode to RGB colors."""
    if mode == "RGB":
        return parts
    hue, saturation, third = np.moveaxis(parts, -1, 0)
    if mode == "HSV":
        span = third * saturation
        low = third - span
    elif mode == "HSL":
        span = (1 - np.abs(2 * third - 1)) * saturation
        low = third - span / 2
    else:
        raise UnknownOperationError
    shares = [np.clip(np.abs((hue * 6 + k) % 6 - 3) - 1, 0, 1) for k in (0, 4, 2)]
    return np.stack([low + span * share for share in shares], axis=-1).astype(np.float32)
