# SPDX-License-Identifier: GPL-3.0-or-later

"""Color spaces from ICC profiles: those with a matrix and curves, or with a gray curve."""

import struct
import zlib

import numpy as np

from .color_spaces import LINE, Curve, ParametricCurve, SampledCurve, Space, from_d50, is_regular

_HEADER = 128
_MOST_TAGS = 1000
_COLORANTS = (b"rXYZ", b"gXYZ", b"bXYZ")
_CURVES = (b"rTRC", b"gTRC", b"bTRC")
_PARAMETERS = {0: "g", 1: "gab", 2: "gabc", 3: "gabcd", 4: "gabcdef"}
_KINDS = {b"CMYK": "CMYK", b"Lab ": "Lab", b"XYZ ": "XYZ", b"GRAY": "gray", b"RGB ": "RGB"}


def space_of(profile: bytes) -> Space:
    """Returns the color space of a profile; PNG files can embed the profile itself.

    Raises:
        ValueError: The profile is damaged, or has lookup tables instead of a matrix and curves.
    """
    try:
        return _space_of(profile)
    except (struct.error, IndexError) as error:
        raise ValueError("an ICC profile that is damaged") from error


def _space_of(profile: bytes) -> Space:
    if len(profile) < _HEADER + 4 or profile[36:40] != b"acsp":
        raise ValueError("an ICC profile that is damaged")
    tags = _tags(profile)
    name = _text(tags.get(b"desc", b"")) or "without a name"
    what = f"the ICC profile '{name}'"
    kind = profile[16:20]
    chunk = b"ICC\0\0" + zlib.compress(profile)
    if kind == b"GRAY" and b"kTRC" in tags and profile[20:24] == b"XYZ ":
        return Space(what, (_curve(tags[b"kTRC"]),), chunks=((b"iCCP", chunk),), is_for_gray=True)
    if kind != b"RGB ":
        kind_name = _KINDS.get(kind, repr(kind.decode("latin-1")))
        raise ValueError(f"{what}, which is for {kind_name} values")
    tables = any(tag[:3] in {b"A2B", b"D2B"} for tag in tags)
    if tables or any(one not in tags for one in (*_COLORANTS, *_CURVES)):
        raise ValueError(f"{what}, which has tables and not only a matrix and curves")
    matrix = np.array([_xyz(tags[one]) for one in _COLORANTS]).T
    curves: tuple[Curve, ...] = tuple(_curve(tags[one]) for one in _CURVES)
    if curves[0] == curves[1] == curves[2]:
        curves = curves[:1]
    if not is_regular(matrix):
        raise ValueError(f"{what}, whose colors all lie in a plane")
    return Space(what, curves, from_d50(matrix), ((b"iCCP", chunk),))


def _tags(profile: bytes) -> dict[bytes, bytes]:
    (count,) = struct.unpack_from(">I", profile, _HEADER)
    if count > _MOST_TAGS:
        raise ValueError("an ICC profile that is damaged")
    tags = {}
    for number in range(count):
        tag, start, size = struct.unpack_from(">4sII", profile, _HEADER + 4 + 12 * number)
        if start + size > len(profile):
            raise ValueError("an ICC profile that is cut off")
        tags[tag] = profile[start : start + size]
    return tags


def _text(data: bytes) -> str:
    if data[:4] == b"desc":
        (count,) = struct.unpack_from(">I", data, 8)
        return data[12 : 12 + count].split(b"\0")[0].decode("latin-1")
    if data[:4] == b"mluc" and len(data) >= 28:
        size, start = struct.unpack_from(">II", data, 20)
        return data[start : start + size].decode("utf-16-be", "replace").rstrip("\0")
    return ""


def _xyz(data: bytes) -> tuple[float, ...]:
    return tuple(value / 65536 for value in struct.unpack_from(">3i", data, 8))


def _curve(data: bytes) -> Curve:
    if data[:4] == b"para":
        (kind,) = struct.unpack_from(">H", data, 8)
        if kind not in _PARAMETERS:
            raise ValueError(f"an ICC profile whose curve is of the unknown kind {kind}")
        names = _PARAMETERS[kind]
        values = struct.unpack_from(f">{len(names)}i", data, 12)
        return _parametric(kind, dict(zip(names, (value / 65536 for value in values), strict=True)))
    (count,) = struct.unpack_from(">I", data, 8)
    if data[:4] != b"curv":
        raise ValueError("an ICC profile whose curve is of an unknown type")
    if count == 0:
        return LINE
    if count == 1:
        (gamma,) = struct.unpack_from(">H", data, 12)
        return _parametric(0, {"g": gamma / 256})
    if len(data) < 12 + 2 * count:
        raise ValueError("an ICC profile that is damaged")
    samples = np.frombuffer(data, ">u2", count, 12) / 65535.0
    if np.any(np.diff(samples) < 0.0) or samples[0] == samples[-1]:
        raise ValueError("an ICC profile whose curve falls")
    return SampledCurve(tuple(samples.tolist()))


def _parametric(kind: int, parameters: dict[str, float]) -> Curve:
    if parameters["g"] <= 0.0 or parameters.get("a", 1.0) <= 0.0:
        raise ValueError("an ICC profile whose curve does not rise")
    if kind in {1, 2}:
        constant = parameters.pop("c", 0.0)
        parameters |= {
            "d": max(-parameters["b"] / parameters["a"], 0.0),
            "e": constant,
            "f": constant,
        }
    return ParametricCurve(**parameters)
