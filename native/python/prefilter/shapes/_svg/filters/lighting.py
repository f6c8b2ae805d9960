# SPDX-License-Identifier: GPL-3.0-or-later

"""`feDiffuseLighting` and `feSpecularLighting`: lighting of a surface whose height is alpha.

Images have the top row first; positions are in pixels, y downwards.
"""

import numpy as np
import numpy.typing as npt

from .... import _native

Values = npt.NDArray[np.float64]
FloatArray = npt.NDArray[np.float32]

# Width of the soft edge of a spot's cone, in cosines.
_CONE_EDGE = 0.016
_PIXELS_PER_BATCH = 1 << 16


def light_surface(alpha: Values, kind: str, light: str, numbers: tuple[float, ...]) -> FloatArray:
    """Returns the light reflected towards the viewer.

    Args:
        numbers: Surface scale, strength, shininess, color; then the direction of a distant light,
            or the position of another one in pixels, and a spot's target, exponent, and cosine of
            the cone.

    Returns:
        (height, width, 4), colors premultiplied by alpha.
    """
    slopes = _smooth(_differences(alpha, 1), 0), _smooth(_differences(alpha, 0), 1)
    image = np.empty((*alpha.shape, 4), np.float32)
    # Some rows at a time, to limit the memory for vectors.
    count = max(_PIXELS_PER_BATCH // max(alpha.shape[1], 1), 1)
    for begin in range(0, alpha.shape[0], count):
        rows = slice(begin, begin + count)
        normals = _normals(slopes[0][rows], slopes[1][rows], numbers[0])
        surface = numbers[0] * alpha[rows]
        directions, share = _directions(surface, begin, light, numbers[6:])
        image[rows] = _reflect(normals, directions, share, kind, numbers[1:6])
    return image


def _reflect(
    normals: Values, directions: Values, share: Values, kind: str, numbers: tuple[float, ...]
) -> Values:
    """Returns reflected light by strength, shininess and color."""
    strength, shininess, color = numbers[0], numbers[1], np.array(numbers[2:5])
    reflected = np.ones((*share.shape, 4))
    if kind == "feDiffuseLighting":
        amount = strength * (normals * directions).sum(-1) * share
        reflected[..., :3] = (amount[..., None] * color).clip(0.0, 1.0)
        return reflected
    halves = directions + np.array([0.0, 0.0, 1.0])
    lengths = np.sqrt((halves * halves).sum(-1))
    cosines = np.zeros_like(lengths)
    np.divide((normals * halves).sum(-1), lengths, out=cosines, where=lengths > 0.0)
    amount = strength * _native.powers(cosines.clip(0.0, None), shininess) * share
    reflected[..., :3] = (amount[..., None] * color).clip(0.0, 1.0)
    reflected[..., 3] = reflected[..., :3].max(-1)
    return reflected


def _normals(across: Values, along: Values, height: float) -> Values:
    """Returns unit normals; slopes are differences of pixels two apart, as in Filter Effects."""
    x, y = -height * across, -height * along
    lengths = np.sqrt(x * x + y * y + 1.0)
    return np.stack([x, y, np.ones_like(x)], -1) / lengths[..., None]


def _differences(values: Values, axis: int) -> Values:
    """Returns central differences over two pixels: twice the slope."""
    if values.shape[axis] < 2:
        return np.zeros_like(values)
    values = np.moveaxis(values, axis, 0)
    differences = np.empty_like(values)
    differences[1:-1] = values[2:] - values[:-2]
    differences[0] = 2.0 * (values[1] - values[0])
    differences[-1] = 2.0 * (values[-1] - values[-2])
    return np.moveaxis(differences, 0, axis)


def _smooth(values: Values, axis: int) -> Values:
    """Averages three pixels with weights 1, 2, 1."""
    if values.shape[axis] < 2:
        return values
    values = np.moveaxis(values, axis, 0)
    smoothed = np.empty_like(values)
    smoothed[1:-1] = 0.25 * (values[2:] + 2.0 * values[1:-1] + values[:-2])
    smoothed[0] = (2.0 * values[0] + values[1]) / 3.0
    smoothed[-1] = (2.0 * values[-1] + values[-2]) / 3.0
    return np.moveaxis(smoothed, 0, axis)


def _directions(
    surface: Values, top: int, light: str, about: tuple[float, ...]
) -> tuple[Values, Values]:
    """Returns unit directions from pixels to the light, and the light's intensity.

    `surface` has the heights of rows from `top` on.
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
    share *= ((cosines - about[7]) / _CONE_EDGE).clip(0.0, 1.0) if about[7] > -1.0 else 1.0
    return directions, np.where(cosines > 0.0, share, 0.0)
