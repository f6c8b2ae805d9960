# SPDX-License-Identifier: GPL-3.0-or-later

"""How layers are mixed: W3C, Compositing and Blending Level 1. Colors are multiplied by alpha."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float32]
Mix = Callable[[FloatArray, FloatArray], FloatArray]

_HALF, _ONE, _TWO = np.float32(0.5), np.float32(1.0), np.float32(2.0)
# Of red, green and blue, as the recommendation has it.
_LUMA = np.array([0.3, 0.59, 0.11], np.float32)


def over(below: FloatArray, above: FloatArray) -> None:
    """Puts a layer over another one, (height, width, 4) each, in place."""
    below *= _ONE - above[..., 3:]
    below += above


def blended(below: FloatArray, above: FloatArray, mode: str) -> FloatArray:
    """A layer over another one, which may change, mixed by the name of a `mix-blend-mode`."""
    if mode == "normal":
        over(below, above)
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
    """Colors in [0, 1] that are not multiplied by alpha; 0 where that is 0."""
    alpha = colors[..., 3:]
    found = np.zeros_like(colors[..., :3])
    np.divide(colors[..., :3], alpha, out=found, where=alpha > 0.0)
    return found.clip(0.0, 1.0, out=found)


def _quotient(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """What divides as the recommendation says: at most 1, and 0 for 0 / 0."""
    found = np.where(numerator > 0.0, _ONE, np.float32(0.0)).astype(np.float32)
    np.divide(numerator, denominator, out=found, where=denominator > 0.0)
    return np.minimum(found, _ONE, out=found)


def _screen(b: FloatArray, s: FloatArray) -> FloatArray:
    return b + s - b * s


def _hard_light(b: FloatArray, s: FloatArray) -> FloatArray:
    found: FloatArray = np.where(s <= _HALF, b * _TWO * s, _screen(b, _TWO * s - _ONE))
    return found


def _soft_light(b: FloatArray, s: FloatArray) -> FloatArray:
    lighter = np.where(b <= 0.25, ((16 * b - 12) * b + 4) * b, np.sqrt(b))
    darkened = b - (_ONE - _TWO * s) * b * (_ONE - b)
    found: FloatArray = np.where(s <= _HALF, darkened, b + (_TWO * s - _ONE) * (lighter - b))
    return found


def _luminosity(color: FloatArray) -> FloatArray:
    # One by one: a product of matrices has other bits elsewhere.
    red, green, blue = (color[..., k : k + 1] * _LUMA[k] for k in range(3))
    found: FloatArray = red + green + blue
    return found


def _saturation(color: FloatArray) -> FloatArray:
    found: FloatArray = color.max(-1, keepdims=True) - color.min(-1, keepdims=True)
    return found


def _with_luminosity(color: FloatArray, luminosity: FloatArray) -> FloatArray:
    color = color + (luminosity - _luminosity(color))
    # What leaves [0, 1] moves towards gray.
    gray = _luminosity(color)
    low, high = color.min(-1, keepdims=True), color.max(-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        color = np.where(low < 0.0, gray + (color - gray) * gray / (gray - low), color)
        color = np.where(high > 1.0, gray + (color - gray) * (_ONE - gray) / (high - gray), color)
    return color


def _with_saturation(color: FloatArray, saturation: FloatArray) -> FloatArray:
    low = color.min(-1, keepdims=True)
    extent = color.max(-1, keepdims=True) - low
    found = np.zeros_like(color)
    np.divide((color - low) * saturation, extent, out=found, where=extent > 0.0)
    return found


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
