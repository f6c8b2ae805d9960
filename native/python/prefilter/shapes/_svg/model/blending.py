# SPDX-License-Identifier: GPL-3.0-or-later

"""Blending of layers: W3C, Compositing and Blending Level 1. Colors are premultiplied by alpha."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float32]
Mix = Callable[[FloatArray, FloatArray], FloatArray]

_HALF, _ONE, _TWO = np.float32(0.5), np.float32(1.0), np.float32(2.0)
# Luminosity weights of red, green and blue in the recommendation.
_LUMA = np.array([0.3, 0.59, 0.11], np.float32)


def blend_over(below: FloatArray, above: FloatArray) -> None:
    """Composites a layer over another one of the same size, in place."""
    below *= _ONE - above[..., 3:]
    below += above


def blend(below: FloatArray, above: FloatArray, mode: str) -> FloatArray:
    """Blends a layer with the one below, which may be overwritten, by a `mix-blend-mode`."""
    if mode == "normal":
        blend_over(below, above)
        return below
    mix = _MODES[mode]
    alpha_below, alpha_above = below[..., 3:], above[..., 3:]
    mixed = mix(straight_colors(below), straight_colors(above))
    result = np.empty_like(below)
    result[..., :3] = (
        (_ONE - alpha_below) * above[..., :3]
        + (_ONE - alpha_above) * below[..., :3]
        + alpha_below * alpha_above * mixed
    )
    result[..., 3:] = alpha_below + alpha_above - alpha_below * alpha_above
    return result


def straight_colors(colors: FloatArray) -> FloatArray:
    """Returns colors divided by alpha and clamped to [0, 1]; 0 where alpha is 0."""
    alpha = colors[..., 3:]
    straight = np.zeros_like(colors[..., :3])
    np.divide(colors[..., :3], alpha, out=straight, where=alpha > 0.0)
    return straight.clip(0.0, 1.0, out=straight)


def _quotient(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Divides as the recommendation says: at most 1, and 0 for 0 / 0."""
    quotients = np.where(numerator > 0.0, _ONE, np.float32(0.0)).astype(np.float32)
    np.divide(numerator, denominator, out=quotients, where=denominator > 0.0)
    return np.minimum(quotients, _ONE, out=quotients)


def _screen(b: FloatArray, s: FloatArray) -> FloatArray:
    return b + s - b * s


def _hard_light(b: FloatArray, s: FloatArray) -> FloatArray:
    mixed: FloatArray = np.where(s <= _HALF, b * _TWO * s, _screen(b, _TWO * s - _ONE))
    return mixed


def _soft_light(b: FloatArray, s: FloatArray) -> FloatArray:
    lighter = np.where(b <= 0.25, ((16 * b - 12) * b + 4) * b, np.sqrt(b))
    darkened = b - (_ONE - _TWO * s) * b * (_ONE - b)
    mixed: FloatArray = np.where(s <= _HALF, darkened, b + (_TWO * s - _ONE) * (lighter - b))
    return mixed


def _luminosity(color: FloatArray) -> FloatArray:
    # Sums term by term: matrix products of numpy round differently across processors.
    red, green, blue = (color[..., k : k + 1] * _LUMA[k] for k in range(3))
    luminosity: FloatArray = red + green + blue
    return luminosity


def _saturation(color: FloatArray) -> FloatArray:
    saturation: FloatArray = color.max(-1, keepdims=True) - color.min(-1, keepdims=True)
    return saturation


def _with_luminosity(color: FloatArray, luminosity: FloatArray) -> FloatArray:
    color = color + (luminosity - _luminosity(color))
    # Colors outside [0, 1] move towards gray.
    gray = _luminosity(color)
    low, high = color.min(-1, keepdims=True), color.max(-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        color = np.where(low < 0.0, gray + (color - gray) * gray / (gray - low), color)
        color = np.where(high > 1.0, gray + (color - gray) * (_ONE - gray) / (high - gray), color)
    return color


def _with_saturation(color: FloatArray, saturation: FloatArray) -> FloatArray:
    low = color.min(-1, keepdims=True)
    extent = color.max(-1, keepdims=True) - low
    scaled = np.zeros_like(color)
    np.divide((color - low) * saturation, extent, out=scaled, where=extent > 0.0)
    return scaled


_MODES: dict[str, Mix] = {
    "multiply": lambda b, s: b * s,
    "screen": _screen,
    "overlay": lambda b, s: _hard_light(s, b),
    "darken": np.minimum,
    "lighten": np.maximum,
    "color-dodge": lambda b, s: _quotient(b, _ONE - s),
    "color-burn": lambda b, s: _ONE - _quotient(_ONE - b, s),
    "hard-light": _hard_light,
    "soft-light": _soft_light,
    "difference": lambda b, s: np.abs(b - s),
    "exclusion": lambda b, s: b + s - _TWO * b * s,
    "hue": lambda b, s: _with_luminosity(_with_saturation(s, _saturation(b)), _luminosity(b)),
    "saturation": lambda b, s: _with_luminosity(
        _with_saturation(b, _saturation(s)), _luminosity(b)
    ),
    "color": lambda b, s: _with_luminosity(s, _luminosity(b)),
    "luminosity": lambda b, s: _with_luminosity(b, _luminosity(s)),
}
BLEND_MODES = ("normal", *_MODES)
