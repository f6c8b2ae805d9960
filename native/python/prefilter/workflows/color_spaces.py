# SPDX-License-Identifier: GPL-3.0-or-later

"""Color spaces of picture files: transfer functions, and matrices to linear Rec. 709."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .._native import powers
from ..images.color import to_linear, to_srgb
from . import space_names
from .matrices import inner, inverse, product

FloatArray = NDArray[np.float32]
Matrix = tuple[tuple[float, float, float], ...]

REC709 = space_names.CHROMATICITIES["rec709"]

_BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
_D50 = np.array([0.9642, 1.0, 0.8249])
"""XYZ of the white point of ICC profiles."""
_LEAST_DETERMINANT = 1e-9
_SAME_MATRIX = 1 / 2048
_SAME_CODE = 0.25
"""Largest deviation from sRGB, in 8-bit steps, of a curve that still counts as sRGB."""


class Curve(Protocol):
    """A transfer function; values beyond [0, 1] are allowed."""

    def decode(self, values: Any) -> NDArray[np.float64]:
        """Returns light."""

    def encode(self, light: Any) -> NDArray[np.float64]:
        """Returns encoded values of light."""


@dataclass(frozen=True)
class ParametricCurve:
    """(a x + b) ** g + e for x >= d, else c x + f; extended as an odd function to negative values.

    The parameters have the names of the ICC specification.
    """

    g: float = 1.0
    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0
    e: float = 0.0
    f: float = 0.0

    def decode(self, values: Any) -> NDArray[np.float64]:
        """Returns light."""
        x = np.abs(np.asarray(values, np.float64))
        power = _power(self.a * x + self.b, self.g) + self.e
        magnitude: NDArray[np.float64] = np.where(x >= self.d, power, self.c * x + self.f)
        signed: NDArray[np.float64] = np.copysign(magnitude, values)
        return signed

    def encode(self, light: Any) -> NDArray[np.float64]:
        """Returns encoded values of light."""
        y = np.abs(np.asarray(light, np.float64))
        border = _power(self.a * self.d + self.b, self.g) + self.e
        power = (_power(y - self.e, 1.0 / self.g) - self.b) / self.a
        line = (y - self.f) / self.c if self.c > 0.0 else np.zeros_like(y)
        magnitude: NDArray[np.float64] = np.where(y >= border, power, np.clip(line, 0.0, self.d))
        signed: NDArray[np.float64] = np.copysign(np.maximum(magnitude, 0.0), light)
        return signed


@dataclass(frozen=True)
class SampledCurve:
    """A nondecreasing curve, linear between samples at equal steps from 0 to 1."""

    samples: tuple[float, ...]

    def decode(self, values: Any) -> NDArray[np.float64]:
        """Returns light; values are clamped to [0, 1]."""
        at = np.linspace(0.0, 1.0, len(self.samples))
        return np.interp(np.asarray(values, np.float64), at, self.samples)

    def encode(self, light: Any) -> NDArray[np.float64]:
        """Returns encoded values of light, which is clamped to the curve's range."""
        at = np.linspace(0.0, 1.0, len(self.samples))
        return np.interp(np.asarray(light, np.float64), self.samples, at)


def _power(base: Any, exponent: float) -> NDArray[np.float64]:
    """Returns powers of numbers; 0 for negative ones."""
    positive = np.maximum(np.asarray(base, np.float64), 0.0)
    return powers(positive, exponent)


LINE = ParametricCurve()
SRGB_CURVE = ParametricCurve(2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
_CURVES: dict[str, Curve] = {"lin": LINE, "srgb": SRGB_CURVE, "srgbe": SRGB_CURVE}
_IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Space:
    """A color space.

    Attributes:
        name: The name that users know.
        curves: One transfer function, or one each for red, green and blue.
        to_rec709: The matrix from linear colors of its primaries to Rec. 709.
        chunks: The chunks, as type and content, by which a PNG file declares this space.
        is_for_gray: Whether `chunks` are for gray pictures only; otherwise for color only.
    """

    name: str
    curves: tuple[Curve, ...] = (LINE,)
    to_rec709: Matrix = _IDENTITY
    chunks: tuple[tuple[bytes, bytes], ...] = ()
    is_for_gray: bool = False

    @property
    def is_rec709(self) -> bool:
        """Whether it has the primaries of Rec. 709."""
        return bool(np.abs(np.subtract(self.to_rec709, _IDENTITY)).max() <= _SAME_MATRIX)

    @property
    def is_linear(self) -> bool:
        """Whether values are proportional to light."""
        return self.curves == (LINE,)

    @property
    def is_srgb(self) -> bool:
        """Whether it is sRGB, within 8-bit precision."""
        codes = np.arange(256) / 255.0
        same = (np.abs(SRGB_CURVE.encode(curve.decode(codes)) - codes) for curve in self.curves)
        return self.is_rec709 and all(float(curve.max()) * 255 <= _SAME_CODE for curve in same)

    def can_be_kept(self, *, is_gray: bool) -> bool:
        """Tells whether a PNG file, gray or not, can declare this space."""
        has_profile = any(kind == b"iCCP" for kind, _ in self.chunks)
        return bool(self.chunks) and (not has_profile or is_gray == self.is_for_gray)

    def agrees(self, other: "Space") -> bool:
        """Tells whether another space is the same apart from its name."""
        codes = np.arange(256) / 255.0
        mine, others = (
            np.array([(space.curves * 3)[index].decode(codes) for index in range(3)])
            for space in (self, other)
        )
        apart = np.abs(np.subtract(self.to_rec709, other.to_rec709)).max()
        return bool(apart <= _SAME_MATRIX and np.abs(mine - others).max() <= _SAME_MATRIX)

    def decoded(self, colors: FloatArray) -> FloatArray:
        """Returns (..., 3) colors as light, with the same primaries."""
        if self.is_linear:
            return colors
        if self.curves == (SRGB_CURVE,):
            return to_linear(colors)
        return self._through(colors, [curve.decode for curve in self.curves])

    def encoded(self, light: FloatArray) -> FloatArray:
        """Returns (..., 3) light as encoded colors."""
        if self.is_linear:
            return light
        if self.curves == (SRGB_CURVE,):
            return to_srgb(light)
        return self._through(light, [curve.encode for curve in self.curves])

    def in_rec709(self, light: FloatArray) -> FloatArray:
        """Returns (..., 3) linear colors converted to the primaries of Rec. 709."""
        return light if self.is_rec709 else _multiplied(light, self.to_rec709)

    def _through(self, colors: FloatArray, curves: Sequence[Any]) -> FloatArray:
        converted = np.empty_like(colors)
        for channel in range(colors.shape[-1]):
            curve = curves[channel % len(curves)]
            # Row by row, to bound the memory for 64-bit values.
            for row, values in zip(converted, colors, strict=True):
                row[..., channel] = curve(values[..., channel])
        return converted


def _multiplied(colors: FloatArray, matrix: Matrix) -> FloatArray:
    """Returns colors times a matrix, summed in a fixed order; that of a library may vary."""
    products = np.empty_like(colors)
    red, green, blue = (colors[..., channel] for channel in range(3))
    for channel, (by_red, by_green, by_blue) in enumerate(np.asarray(matrix, np.float32)):
        products[..., channel] = red * by_red + green * by_green + blue * by_blue
    return products


def named(name: str) -> Space | None:
    """Returns the color space with a name; None if the name is unknown."""
    names = space_names.parts(name)
    if names is None:
        return None
    curve_name, primaries = names
    curve = _CURVES.get(curve_name)
    if curve is None:
        number = curve_name.lstrip("Gagm")
        curve = ParametricCurve(float(number) if curve_name[0] == "G" else int(number) / 10)
    return Space(name, (curve,), matrix_of(space_names.CHROMATICITIES[primaries]))


def srgb_bytes(light: FloatArray) -> NDArray[np.uint8]:
    """Converts linear Rec. 709, with optional straight alpha, to sRGB bytes."""
    rounded: NDArray[np.uint8] = np.rint(to_srgb(light).clip(0, 1) * np.float32(255)).astype(
        np.uint8
    )
    return rounded


SRGB = Space(space_names.SRGB, (SRGB_CURVE,))
LINEAR = Space(space_names.REC709_LINEAR)


@lru_cache(maxsize=64)
def matrix_of(chromaticities: tuple[float, ...]) -> Matrix:
    """Returns the matrix from linear colors of these primaries to those of Rec. 709.

    Whites are adapted by Bradford's matrix.

    Args:
        chromaticities: x and y of red, green, blue and white.

    Raises:
        ValueError: They do not define a color space.
    """
    if chromaticities == REC709:
        return _IDENTITY
    return from_d50(_xyz_d50(chromaticities))


def from_d50(to_xyz: NDArray[np.float64]) -> Matrix:
    """Returns the matrix to Rec. 709 for a matrix to XYZ with white D50, as in ICC profiles."""
    rows = product(inverse(_xyz_d50(REC709)), to_xyz).tolist()
    return tuple((row[0], row[1], row[2]) for row in rows)


def is_regular(matrix: NDArray[np.float64]) -> bool:
    """Tells whether a (3, 3) matrix is invertible."""
    return bool(np.isfinite(matrix).all() and abs(_determinant(matrix)) > _LEAST_DETERMINANT)


def _determinant(rows: NDArray[np.float64]) -> float:
    return inner(rows[0], np.cross(rows[1], rows[2]))


def _xyz_d50(chromaticities: Sequence[float]) -> NDArray[np.float64]:
    """Returns the matrix from linear colors to XYZ, adapted to the white D50."""
    points = np.asarray(chromaticities, np.float64).reshape(4, 2)
    heights = points[:, 1]
    if np.isfinite(points).all() and np.abs(heights).min() > _LEAST_DETERMINANT:
        xyz = np.column_stack([points, 1.0 - points[:, 0] - heights]).T / heights
        if is_regular(xyz[:, :3]):
            white = xyz[:, 3:]
            to_xyz = xyz[:, :3] * product(inverse(xyz[:, :3]), white)[:, 0]
            scales = product(_BRADFORD, _D50[:, None]) / product(_BRADFORD, white)
            return product(inverse(_BRADFORD), scales * product(_BRADFORD, to_xyz))
    raise ValueError(f"chromaticities {np.round(points, 4).tolist()} are those of no colors")
