# SPDX-License-Identifier: GPL-3.0-or-later

"""`feDiffuseLighting` and `feSpecularLighting`: light on a surface as high as alpha.

Images have the top row first, and places are in pixels, with y downwards.
"""

import numpy as np
import numpy.typing as npt

from .... import _native

Values = npt.NDArray[np.float64]
FloatArray = npt.NDArray[np.float32]

# Where the edge of a spot's cone is soft, in cosines.
_SOFT = 0.016
_AT_ONCE = 1 << 16


def lit(alpha: Values, kind: str, light: str, numbers: tuple[float, ...]) -> FloatArray:
    """The light that pixels send to the eye.

    Args:
        alpha: (height, width).
        kind: "feDiffuseLighting" or "feSpecularLighting".
        light: "feDistantLight", "fePointLight" or "feSpotLight".
        numbers: The height of what is opaque, the strength, the shininess, three of the color, and
            of a distant light the direction to it; of others their place and what they point at,
            in pixels, the exponent and the cosine of the cone.

    Returns:
        (height, width, 4): colors multiplied by alpha.
    """
    slopes = _smoothed(_differences(alpha, 1), 0), _smoothed(_differences(alpha, 0), 1)
    found = np.empty((*alpha.shape, 4), np.float32)
    # Some rows at a time, as vectors take much memory.
    count = max(_AT_ONCE // max(alpha.shape[1], 1), 1)
    for begin in range(0, alpha.shape[0], count):
        rows = slice(begin, begin + count)
        normals = _normals(slopes[0][rows], slopes[1][rows], numbers[0])
        surface = numbers[0] * alpha[rows]
        directions, share = _directions(surface, begin, light, numbers[6:])
        found[rows] = _sent(normals, directions, share, kind, numbers[1:6])
    return found


def _sent(
    normals: Values, directions: Values, share: Values, kind: str, numbers: tuple[float, ...]
) -> Values:
    """The light that is sent on, by its strength, shininess and color."""
    strength, shininess, color = numbers[0], numbers[1], np.array(numbers[2:5])
    found = np.ones((*share.shape, 4))
    if kind == "feDiffuseLighting":
        amount = strength * (normals * directions).sum(-1) * share
        found[..., :3] = (amount[..., None] * color).clip(0.0, 1.0)
        return found
    halves = directions + np.array([0.0, 0.0, 1.0])
    lengths = np.sqrt((halves * halves).sum(-1))
    cosines = np.zeros_like(lengths)
    np.divide((normals * halves).sum(-1), lengths, out=cosines, where=lengths > 0.0)
    amount = strength * _native.powers(cosines.clip(0.0, None), shininess) * share
    found[..., :3] = (amount[..., None] * color).clip(0.0, 1.0)
    found[..., 3] = found[..., :3].max(-1)
    return found


def _normals(across: Values, along: Values, height: float) -> Values:
    """Of length 1, of slopes as Filter Effects has them: the differences of pixels two apart."""
    x, y = -height * across, -height * along
    lengths = np.sqrt(x * x + y * y + 1.0)
    return np.stack([x, y, np.ones_like(x)], -1) / lengths[..., None]


def _differences(values: Values, axis: int) -> Values:
    """Of the pixels to both sides: twice the slope."""
    if values.shape[axis] < 2:
        return np.zeros_like(values)
    values = np.moveaxis(values, axis, 0)
    found = np.empty_like(values)
    found[1:-1] = values[2:] - values[:-2]
    found[0] = 2.0 * (values[1] - values[0])
    found[-1] = 2.0 * (values[-1] - values[-2])
    return np.moveaxis(found, 0, axis)


def _smoothed(values: Values, axis: int) -> Values:
    """The mean of three pixels, the middle one twice."""
    if values.shape[axis] < 2:
        return values
    values = np.moveaxis(values, axis, 0)
    found = np.empty_like(values)
    found[1:-1] = 0.25 * (values[2:] + 2.0 * values[1:-1] + values[:-2])
    found[0] = (2.0 * values[0] + values[1]) / 3.0
    found[-1] = (2.0 * values[-1] + values[-2]) / 3.0
    return np.moveaxis(found, 0, axis)


def _directions(
    surface: Values, top: int, light: str, about: tuple[float, ...]
) -> tuple[Values, Values]:
    """From each pixel to the light, of length 1, and how much light comes along that.

    `surface` is how high rows from `top` on are.
    """
    rows, columns = surface.shape
    if light == "feDistantLight":
        shape = (rows, columns, 3)
        return np.broadcast_to(np.array(about), shape), np.ones((rows, columns))
    x, y = np.meshgrid(np.arange(columns), top + np.arange(rows))
    to_light = np.stack([about[0] - x, about[1] - y, about[2] - surface], -1)
    lengths = np.sqrt((to_light * to_light).sum(-1, keepdims=True))
    directions = np.zeros_like(to_light)
    np.divide(to_light, lengths, out=directions, where=lengths > 0.0)
    if light == "fePointLight":
        return directions, np.ones((rows, columns))
    axis = np.array(about[3:6]) - np.array(about[:3])
    length = np.sqrt((axis * axis).sum())
    axis = axis / length if length > 0.0 else axis
    cosines = -(directions * axis).sum(-1)
    share = _native.powers(cosines.clip(0.0, None), about[6])
    share *= ((cosines - about[7]) / _SOFT).clip(0.0, 1.0) if about[7] > -1.0 else 1.0
    return directions, np.where(cosines > 0.0, share, 0.0)
