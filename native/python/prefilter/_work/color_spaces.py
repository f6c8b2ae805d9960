# SPDX-License-Identifier: GPL-3.0-or-later

"""Color spaces of picture files: their curves, and matrices to linear Rec. 709.

Names are those of the ASWF Color Interop Forum, such as "lin_ap1_scene": curve, primaries, and
whether values are relative to a scene or to a display.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

import prefilter

FloatArray = NDArray[np.float32]
Matrix = tuple[tuple[float, float, float], ...]

AUTO = "auto"
"""The color space that a file says it has."""
DATA = "data"
"""Values that are no colors."""
REC709_LINEAR = "lin_rec709_scene"
_SRGB_NAME = "srgb_rec709_scene"

_WHITE_D65, _WHITE_D60, _WHITE_E = (0.3127, 0.3290), (0.32168, 0.33767), (1 / 3, 1 / 3)
_CHROMATICITIES: dict[str, tuple[float, ...]] = {
    "rec709": (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, *_WHITE_D65),
    "p3d65": (0.680, 0.320, 0.265, 0.690, 0.150, 0.060, *_WHITE_D65),
    "rec2020": (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, *_WHITE_D65),
    "adobergb": (0.64, 0.33, 0.21, 0.71, 0.15, 0.06, *_WHITE_D65),
    "ap1": (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, *_WHITE_D60),
    "ap0": (0.73470, 0.26530, 0.0, 1.0, 0.00010, -0.07700, *_WHITE_D60),
}
"""x and y of red, green, blue and white, by the name of the primaries."""
REC709 = _CHROMATICITIES["rec709"]

_BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
_D50 = np.array([0.9642, 1.0, 0.8249])
"""The white of ICC profiles, XYZ."""
_SAME_MATRIX = 1 / 2048
_SAME_CODE = 0.25
"""Largest difference from sRGB of a curve that counts as that of sRGB, in steps of 8 bits."""

_ALIASES = {
    "srgb": _SRGB_NAME,
    "srgb texture": _SRGB_NAME,
    "srgb - texture": _SRGB_NAME,
    "utility - srgb - texture": _SRGB_NAME,
    "srgb encoded rec.709 (srgb)": _SRGB_NAME,
    "srgb_texture": _SRGB_NAME,
    "linear": REC709_LINEAR,
    "linear rec.709": REC709_LINEAR,
    "linear rec.709 (srgb)": REC709_LINEAR,
    "utility - linear - srgb": REC709_LINEAR,
    "utility - linear - rec.709": REC709_LINEAR,
    "lin_rec709": REC709_LINEAR,
    "lin_srgb": REC709_LINEAR,
    "acescg": "lin_ap1_scene",
    "aces - acescg": "lin_ap1_scene",
    "lin_ap1": "lin_ap1_scene",
    "aces2065-1": "lin_ap0_scene",
    "aces - aces2065-1": "lin_ap0_scene",
    "lin_ap0": "lin_ap0_scene",
    "display p3": "srgb_p3d65_scene",
    "linear p3-d65": "lin_p3d65_scene",
    "linear dci-p3 d65": "lin_p3d65_scene",
    "linear rec.2020": "lin_rec2020_scene",
    "lin_rec2020": "lin_rec2020_scene",
    "lin_p3d65": "lin_p3d65_scene",
    "adobe rgb": "g22_adobergb_scene",
    "raw": DATA,
    "non-color": DATA,
    "utility - raw": DATA,
}
_GAMMA = re.compile(r"Gamma(\d+(?:\.\d+)?)")
EXAMPLES = ("sRGB", "Linear Rec.709", "ACEScg", "Display P3", "Adobe RGB", "data")
"""Names for the help of commands."""


class Curve(Protocol):
    """A transfer function; values beyond [0, 1] go through it as well."""

    def decode(self, values: Any) -> NDArray[np.float64]:
        """Returns light."""

    def encode(self, light: Any) -> NDArray[np.float64]:
        """Returns the values that stand for light."""


@dataclass(frozen=True)
class Parametric:
    """(a x + b) ** g + e from x = d on, else c x + f; odd, so that negative values have one, too.

    ICC profiles name the parameters like that.
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
        power = np.power(np.maximum(self.a * x + self.b, 0.0), self.g) + self.e
        made: NDArray[np.float64] = np.where(x >= self.d, power, self.c * x + self.f)
        signed: NDArray[np.float64] = np.copysign(made, values)
        return signed

    def encode(self, light: Any) -> NDArray[np.float64]:
        """Returns the values that stand for light."""
        y = np.abs(np.asarray(light, np.float64))
        border = np.power(max(self.a * self.d + self.b, 0.0), self.g) + self.e
        power = (np.power(np.maximum(y - self.e, 0.0), 1 / self.g) - self.b) / self.a
        line = (y - self.f) / self.c if self.c > 0.0 else np.zeros_like(y)
        made: NDArray[np.float64] = np.where(y >= border, power, np.clip(line, 0.0, self.d))
        signed: NDArray[np.float64] = np.copysign(np.maximum(made, 0.0), light)
        return signed


@dataclass(frozen=True)
class Sampled:
    """Values between which the curve is a line, at equal steps from 0 to 1; they do not fall."""

    samples: tuple[float, ...]

    def decode(self, values: Any) -> NDArray[np.float64]:
        """Returns light, of values that are cut off at 0 and 1."""
        at = np.linspace(0.0, 1.0, len(self.samples))
        return np.interp(np.asarray(values, np.float64), at, self.samples)

    def encode(self, light: Any) -> NDArray[np.float64]:
        """Returns the values that stand for light, which is cut off at what the curve has."""
        at = np.linspace(0.0, 1.0, len(self.samples))
        return np.interp(np.asarray(light, np.float64), self.samples, at)


LINE = Parametric()
SRGB_CURVE = Parametric(2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
_CURVES: dict[str, Curve] = {"lin": LINE, "srgb": SRGB_CURVE, "srgbe": SRGB_CURVE}
_IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Space:
    """A color space.

    Attributes:
        name: What users know it by.
        curves: One, or one each of red, green and blue.
        to_rec709: From linear colors of its primaries to those of Rec. 709.
        chunks: What a PNG file says to be in this space: kinds of chunks, and what they hold.
        is_for_gray: Whether `chunks` are for gray pictures, and not for those in color.
    """

    name: str
    curves: tuple[Curve, ...] = (LINE,)
    to_rec709: Matrix = _IDENTITY
    chunks: tuple[tuple[bytes, bytes], ...] = ()
    is_for_gray: bool = False

    @property
    def is_rec709(self) -> bool:
        """Whether its primaries are those of Rec. 709."""
        return bool(np.abs(np.subtract(self.to_rec709, _IDENTITY)).max() <= _SAME_MATRIX)

    @property
    def is_linear(self) -> bool:
        """Whether its values are light."""
        return self.curves == (LINE,)

    @property
    def is_srgb(self) -> bool:
        """Whether it is sRGB, as closely as 8 bits tell."""
        codes = np.arange(256) / 255.0
        same = (np.abs(SRGB_CURVE.encode(one.decode(codes)) - codes) for one in self.curves)
        return self.is_rec709 and all(float(one.max()) * 255 <= _SAME_CODE for one in same)

    def can_be_kept(self, *, is_gray: bool) -> bool:
        """Tells whether a PNG file, gray or not, can say to be in this space."""
        has_profile = any(kind == b"iCCP" for kind, _ in self.chunks)
        return bool(self.chunks) and (not has_profile or is_gray == self.is_for_gray)

    def agrees(self, other: "Space") -> bool:
        """Tells whether another space is the same but for its name."""
        codes = np.arange(256) / 255.0
        mine, others = (
            np.array([(one.curves * 3)[index].decode(codes) for index in range(3)])
            for one in (self, other)
        )
        apart = np.abs(np.subtract(self.to_rec709, other.to_rec709)).max()
        return bool(apart <= _SAME_MATRIX and np.abs(mine - others).max() <= _SAME_MATRIX)

    def decoded(self, colors: FloatArray) -> FloatArray:
        """Returns (..., 3) colors as light, of the same primaries."""
        if self.is_linear:
            return colors
        if self.curves == (SRGB_CURVE,):
            return prefilter.to_linear(colors)
        return self._through(colors, [one.decode for one in self.curves])

    def encoded(self, light: FloatArray) -> FloatArray:
        """Returns (..., 3) light as the values of colors."""
        if self.is_linear:
            return light
        if self.curves == (SRGB_CURVE,):
            return prefilter.to_srgb(light)
        return self._through(light, [one.encode for one in self.curves])

    def in_rec709(self, light: FloatArray) -> FloatArray:
        """Returns (..., 3) linear colors, of the primaries of Rec. 709 now."""
        return light if self.is_rec709 else _multiplied(light, self.to_rec709)

    def _through(self, colors: FloatArray, curves: Sequence[Any]) -> FloatArray:
        made = np.empty_like(colors)
        for channel in range(colors.shape[-1]):
            curve = curves[channel % len(curves)]
            # In rows, as these take more memory in 64 bits.
            for row, values in zip(made, colors, strict=True):
                row[..., channel] = curve(values[..., channel])
        return made


def _multiplied(colors: FloatArray, matrix: Matrix) -> FloatArray:
    """Returns colors times a matrix, added up in one order: that of a library may differ."""
    made = np.empty_like(colors)
    red, green, blue = (colors[..., channel] for channel in range(3))
    for channel, (by_red, by_green, by_blue) in enumerate(np.asarray(matrix, np.float32)):
        made[..., channel] = red * by_red + green * by_green + blue * by_blue
    return made


def named(name: str) -> Space | None:
    """Returns the space of a name; None where the name is of no known one.

    `DATA` is no space: see `is_data_name`.
    """
    known = _ALIASES.get(name.strip().lower(), name.strip())
    gamma = _GAMMA.fullmatch(known)
    if gamma is not None:
        return Space(name, (Parametric(float(gamma[1])),)) if float(gamma[1]) > 0.0 else None
    curve_name, _, rest = known.partition("_")
    primaries, _, relative = rest.partition("_")
    curve = _CURVES.get(curve_name)
    if curve is None and curve_name[:1] == "g" and curve_name[1:].isdigit():
        curve = Parametric(int(curve_name[1:]) / 10)
    if curve is None or relative not in {"scene", "display", ""}:
        return None
    if primaries not in _CHROMATICITIES:
        return None
    return Space(name, (curve,), matrix_of(_CHROMATICITIES[primaries]))


def is_data_name(name: str) -> bool:
    """Tells whether a name says that values are no colors."""
    known = name.strip().lower()
    return _ALIASES.get(known, known) == DATA


def checked_name(name: str) -> str:
    """Returns the name of a space, as a flag gives it.

    Raises:
        ValueError: It is unknown.
    """
    if name != AUTO and not is_data_name(name) and named(name) is None:
        raise ValueError(
            f"found '{name}'; {AUTO}, {', '.join(EXAMPLES)}, or a name of the Color Interop Forum "
            f"such as lin_ap1_scene or srgb_p3d65_scene is needed"
        )
    return name


def chromaticities_of(name: str) -> tuple[float, ...] | None:
    """Returns x and y of red, green, blue and white of a linear space; None where unknown."""
    known = _ALIASES.get(name.strip().lower(), name.strip())
    curve, _, rest = known.partition("_")
    return _CHROMATICITIES.get(rest.partition("_")[0]) if curve == "lin" else None


def interop_name(name: str) -> str:
    """Returns the Color Interop Forum's name of a space; empty where there is none."""
    known = _ALIASES.get(name.strip().lower(), name.strip())
    if known == DATA:
        return DATA
    return known if named(known) is not None else ""


SRGB = Space(_SRGB_NAME, (SRGB_CURVE,))
LINEAR = Space(REC709_LINEAR)


@lru_cache(maxsize=64)
def matrix_of(chromaticities: tuple[float, ...]) -> Matrix:
    """Returns the matrix from linear colors of these primaries to those of Rec. 709.

    Whites are adapted by Bradford's matrix.

    Args:
        chromaticities: x and y of red, green, blue and white.

    Raises:
        ValueError: They are those of no color space.
    """
    if chromaticities == REC709:
        return _IDENTITY
    return from_d50(_xyz_d50(chromaticities))


def from_d50(to_xyz: NDArray[np.float64]) -> Matrix:
    """Returns the matrix to Rec. 709 for one to XYZ that has D50 for its white, as ICC has."""
    made = np.linalg.solve(_xyz_d50(REC709), to_xyz)
    return tuple((float(row[0]), float(row[1]), float(row[2])) for row in made)


def _xyz_d50(chromaticities: Sequence[float]) -> NDArray[np.float64]:
    """Returns the matrix to XYZ, adapted to the white of ICC profiles."""
    points = np.asarray(chromaticities, np.float64).reshape(4, 2)
    if not np.isfinite(points).all() or np.abs(points[:, 1]).min() < 1e-9:
        raise ValueError(f"chromaticities {np.round(points, 4).tolist()} are those of no colors")
    xyz = np.column_stack([points, 1.0 - points.sum(axis=1)]).T / points[:, 1]
    try:
        to_xyz = xyz[:, :3] * np.linalg.solve(xyz[:, :3], xyz[:, 3])
    except np.linalg.LinAlgError:
        raise ValueError(
            f"chromaticities {np.round(points, 4).tolist()} are those of no colors"
        ) from None
    scales = (_BRADFORD @ _D50) / (_BRADFORD @ xyz[:, 3])
    made: NDArray[np.float64] = np.linalg.inv(_BRADFORD) @ (scales[:, None] * _BRADFORD) @ to_xyz
    return made
