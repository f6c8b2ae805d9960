# SPDX-License-Identifier: GPL-3.0-or-later

"""Conversions between the color spaces of CSS Color 4, section 10."""

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .... import _native

Values: TypeAlias = npt.NDArray[np.float64]
POLAR = {"hsl": 0, "hwb": 0, "lch": 2, "oklch": 2}
"""Index of the hue among the components of a polar space."""
_WHITE = {
    "d65": (0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290),
    "d50": (0.3457 / 0.3585, 1.0, (1.0 - 0.3457 - 0.3585) / 0.3585),
}
# Chromaticities of red, green and blue, white point, transfer function.
RGB_SPACES = {
    "srgb": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), "d65", "srgb"),
    "srgb-linear": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), "d65", "linear"),
    "display-p3": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), "d65", "srgb"),
    "a98-rgb": ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06), "d65", "a98"),
    "prophoto-rgb": (
        (0.734699, 0.265301),
        (0.159597, 0.840403),
        (0.036598, 0.000105),
        "d50",
        "prophoto",
    ),
    "rec2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), "d65", "rec2020"),
}
_BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
_XYZ_TO_LMS = np.array(
    [
        [0.8190224379967030, 0.3619062600528904, -0.1288737815209879],
        [0.0329836539323885, 0.9292868615863434, 0.0361446663506424],
        [0.0481771893596242, 0.2642395317527308, 0.6335478284694309],
    ]
)
_LMS_TO_OKLAB = np.array(
    [
        [0.2104542683093140, 0.7936177747023054, -0.0040720430116193],
        [1.9779985324311684, -2.4285922420485799, 0.4505937096174110],
        [0.0259040424655478, 0.7827717124575296, -0.8086757549230774],
    ]
)
# Constants of the transfer function of ITU-R BT.2020, as browsers use it.
_ALPHA, _BETA = 1.09929682680944, 0.018053968510807
_KAPPA, _EPSILON = 24389.0 / 27.0, 216.0 / 24389.0


def convert_color(values: Sequence[float], space: str, target: str) -> Values:
    """Converts a color to another space, without gamut mapping."""
    components = np.array(values, np.float64)
    if space == target:
        return components
    if space in ("hsl", "hwb") or target in ("hsl", "hwb"):
        if space in ("hsl", "hwb"):
            components = _hsl_to_rgb(components) if space == "hsl" else _hwb_to_rgb(components)
            return convert_color(list(components), "srgb", target)
        components = convert_color(list(components), space, "srgb")
        return _rgb_to_hsl(components) if target == "hsl" else _rgb_to_hwb(components)
    return _from_xyz(_to_xyz(components, space), target)


def _apply(matrix: Values, values: Values) -> Values:
    # Multiplies term by term: matrix products of numpy round differently across processors.
    applied: Values = matrix[:, 0] * values[0] + matrix[:, 1] * values[1] + matrix[:, 2] * values[2]
    return applied


def _invert(matrix: Values) -> Values:
    """Inverts a matrix in exact fractions, so that the result is the same on every machine."""
    m = [[Fraction(float(value)) for value in row] for row in matrix]
    inverse = np.zeros((3, 3))
    first = [
        m[1][(k + 1) % 3] * m[2][(k + 2) % 3] - m[1][(k + 2) % 3] * m[2][(k + 1) % 3]
        for k in range(3)
    ]
    determinant = sum((m[0][k] * first[k] for k in range(3)), Fraction(0))
    for i in range(3):
        for j in range(3):
            rows, columns = ((j + 1) % 3, (j + 2) % 3), ((i + 1) % 3, (i + 2) % 3)
            minor = (
                m[rows[0]][columns[0]] * m[rows[1]][columns[1]]
                - m[rows[0]][columns[1]] * m[rows[1]][columns[0]]
            )
            inverse[i, j] = float(minor / determinant)
    return inverse


def _rgb_to_xyz_matrix(space: str) -> Values:
    *primaries, white, _ = RGB_SPACES[space]
    columns = np.array([[x / y, 1.0, (1.0 - x - y) / y] for x, y in primaries]).T
    shares = _apply(_invert(columns), np.array(_WHITE[white]))
    return columns * shares[None, :]


def _adaptation_matrix(white: str, target: str) -> Values:
    """Returns Bradford's chromatic adaptation matrix between two white points."""
    there = _apply(_BRADFORD, np.array(_WHITE[white]))
    here = _apply(_BRADFORD, np.array(_WHITE[target]))
    scaled = _BRADFORD * (here / there)[:, None]
    back = _invert(_BRADFORD)
    return np.stack([_apply(back, scaled[:, k]) for k in range(3)], axis=1)


_MATRICES = {space: _rgb_to_xyz_matrix(space) for space in RGB_SPACES}
_INVERSES = {space: _invert(matrix) for space, matrix in _MATRICES.items()}
_TO_D65, _TO_D50 = _adaptation_matrix("d50", "d65"), _adaptation_matrix("d65", "d50")
_LMS_TO_XYZ, _OKLAB_TO_LMS = _invert(_XYZ_TO_LMS), _invert(_LMS_TO_OKLAB)


def _to_xyz(values: Values, space: str) -> Values:
    """Converts to XYZ with the D65 white point."""
    if space in RGB_SPACES:
        *_, white, curve = RGB_SPACES[space]
        xyz = _apply(_MATRICES[space], _decode(values, curve))
        return _apply(_TO_D65, xyz) if white == "d50" else xyz
    if space in ("lch", "oklch"):
        values, space = _polar_to_rectangular(values), space.replace("lch", "lab")
    if space == "oklab":
        lms = _apply(_OKLAB_TO_LMS, values)
        return _apply(_LMS_TO_XYZ, lms * lms * lms)
    if space == "lab":
        values = _lab_to_xyz(values)
    return values if space == "xyz-d65" else _apply(_TO_D65, values)


def _from_xyz(xyz: Values, space: str) -> Values:
    if space in RGB_SPACES:
        *_, white, curve = RGB_SPACES[space]
        xyz = _apply(_TO_D50, xyz) if white == "d50" else xyz
        return _encode(_apply(_INVERSES[space], xyz), curve)
    if space in ("oklab", "oklch"):
        components = _apply(_LMS_TO_OKLAB, _signed_power(_apply(_XYZ_TO_LMS, xyz), 1.0 / 3.0))
    elif space in ("lab", "lch"):
        components = _xyz_to_lab(_apply(_TO_D50, xyz))
    else:
        return xyz if space == "xyz-d65" else _apply(_TO_D50, xyz)
    return _rectangular_to_polar(components) if space in ("lch", "oklch") else components


def _signed_power(values: Values, exponent: float) -> Values:
    """Raises absolute values to a power and restores the signs."""
    powers: Values = np.sign(values) * _native.powers(np.abs(values), exponent)
    return powers


def _decode(values: Values, curve: str) -> Values:
    size = np.abs(values)
    match curve:
        case "srgb":
            high = _signed_power(np.sign(values) * (size + 0.055) / 1.055, 2.4)
            return np.where(size <= 0.04045, values / 12.92, high)
        case "a98":
            return _signed_power(values, 563.0 / 256.0)
        case "prophoto":
            return np.where(size <= 16.0 / 512.0, values / 16.0, _signed_power(values, 1.8))
        case "rec2020":
            high = _signed_power(np.sign(values) * (size + _ALPHA - 1.0) / _ALPHA, 1.0 / 0.45)
            return np.where(size < 4.5 * _BETA, values / 4.5, high)
    return values


def _encode(values: Values, curve: str) -> Values:
    size = np.abs(values)
    match curve:
        case "srgb":
            high = np.sign(values) * (1.055 * _native.powers(size, 1.0 / 2.4) - 0.055)
            return np.where(size <= 0.0031308, 12.92 * values, high)
        case "a98":
            return _signed_power(values, 256.0 / 563.0)
        case "prophoto":
            return np.where(size < 1.0 / 512.0, 16.0 * values, _signed_power(values, 1.0 / 1.8))
        case "rec2020":
            high = np.sign(values) * (_ALPHA * _native.powers(size, 0.45) - (_ALPHA - 1.0))
            return np.where(size < _BETA, 4.5 * values, high)
    return values


def _polar_to_rectangular(values: Values) -> Values:
    angle = np.radians(values[2])
    return np.array(
        [
            values[0],
            values[1] * _native.cos(float(angle)),
            values[1] * _native.sin(float(angle)),
        ]
    )


def _rectangular_to_polar(values: Values) -> Values:
    chroma = _native.hypot(float(values[1]), float(values[2]))
    hue = np.degrees(_native.atan2(float(values[2]), float(values[1]))) % 360.0
    return np.array([values[0], chroma, hue])


def _lab_to_xyz(lab: Values) -> Values:
    middle = (lab[0] + 16.0) / 116.0
    parts = np.array([middle + lab[1] / 500.0, middle, middle - lab[2] / 200.0])
    cubes = parts * parts * parts
    relative = np.where(cubes > _EPSILON, cubes, (116.0 * parts - 16.0) / _KAPPA)
    if lab[0] <= _KAPPA * _EPSILON:
        relative[1] = lab[0] / _KAPPA
    xyz: Values = relative * np.array(_WHITE["d50"])
    return xyz


def _xyz_to_lab(xyz: Values) -> Values:
    shares = xyz / np.array(_WHITE["d50"])
    f = np.where(
        shares > _EPSILON, _signed_power(shares, 1.0 / 3.0), (_KAPPA * shares + 16.0) / 116.0
    )
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


def _hsl_to_rgb(hsl: Values) -> Values:
    hue, saturation, light = hsl[0] % 360.0, hsl[1] / 100.0, hsl[2] / 100.0
    k = (np.array([0.0, 8.0, 4.0]) + hue / 30.0) % 12.0
    spread = saturation * min(light, 1.0 - light)
    rgb: Values = light - spread * np.clip(np.minimum(k - 3.0, 9.0 - k), -1.0, 1.0)
    return rgb


def _hwb_to_rgb(hwb: Values) -> Values:
    white, black = hwb[1] / 100.0, hwb[2] / 100.0
    if white + black >= 1.0:
        return np.full(3, white / (white + black))
    rgb: Values = _hsl_to_rgb(np.array([hwb[0], 100.0, 50.0])) * (1.0 - white - black) + white
    return rgb


def _hue(rgb: Values) -> float:
    red, green, blue = map(float, rgb)
    high, low = max(red, green, blue), min(red, green, blue)
    width = high - low
    if width == 0.0:
        return 0.0
    if high == red:
        return 60.0 * (((green - blue) / width) % 6.0)
    return 60.0 * ((blue - red) / width + 2.0 if high == green else (red - green) / width + 4.0)


def _rgb_to_hsl(rgb: Values) -> Values:
    high, low = float(rgb.max()), float(rgb.min())
    light = 0.5 * (high + low)
    room = min(light, 1.0 - light)
    saturation = (high - light) / room if high > low and room != 0.0 else 0.0
    return np.array([_hue(rgb), 100.0 * saturation, 100.0 * light])


def _rgb_to_hwb(rgb: Values) -> Values:
    return np.array([_hue(rgb), 100.0 * float(rgb.min()), 100.0 * (1.0 - float(rgb.max()))])
