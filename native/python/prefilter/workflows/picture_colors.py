# SPDX-License-Identifier: GPL-3.0-or-later

"""Color space and orientation of a picture file, from all its metadata."""

import struct
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from . import color_spaces, icc, space_names
from .color_spaces import Space
from .files.embedded import EmbeddedMetadata, exif_of
from .openimageio import Metadata

_CICP_PRIMARIES = {1: "rec709", 9: "rec2020", 12: "p3d65"}
_CICP_CURVES = {4: "g22", 8: "lin", 13: "srgb"}
_PNG_UNIT = 100000
_UNKNOWN = frozenset({"", "unknown"})
# Names that readers report for files without color metadata.
_TAKEN_FOR_GRANTED = {
    "openexr": frozenset({"Linear", "lin_rec709", "lin_srgb", "linear", "scene_linear"}),
    "pnm": frozenset({"Rec709"}),
    "": frozenset({"sRGB", "srgb_rec709_scene", "srgb_rec709_display"}),
}
_WAY_OUT = "--colorspace says which color space to take it for"


def orientation_of(metadata: Metadata, embedded: EmbeddedMetadata) -> int:
    """Returns the EXIF orientation, 1 to 8; 1 is upright."""
    if metadata.orientation != 1:
        return metadata.orientation
    return exif_of(embedded.exif).orientation


def upright(values: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Returns an upright picture, rows from the top, of one stored with an EXIF orientation."""
    if orientation in {5, 6, 7, 8}:
        values = values.swapaxes(0, 1)
    if orientation in {2, 3, 6, 7}:
        values = values[:, ::-1]
    if orientation in {3, 4, 7, 8}:
        values = values[::-1]
    return values


def space_of(
    metadata: Metadata,
    embedded: EmbeddedMetadata,
    *,
    is_integer: bool,
    is_gray: bool,
    colorspace: str = space_names.AUTO,
) -> Space | None:
    """Returns the color space of a picture; None if its values are not colors.

    Args:
        metadata: Metadata read by OpenImageIO.
        embedded: Metadata read by our own parsers.
        is_integer: Whether values are integers, which default to sRGB; floats default to linear
            Rec. 709.
        is_gray: Whether it has one channel for all colors.
        colorspace: The name of a space that overrides the file's metadata, or `AUTO`.

    Raises:
        ValueError: The kind of space is unknown, or the metadata contradict one another.
    """
    if metadata.model:
        raise ValueError(
            f"its colors are {metadata.model}, which cannot be converted; save it as RGB first"
        )
    if colorspace != space_names.AUTO:
        space_names.checked_name(colorspace)
        return color_spaces.named(colorspace)
    if space_names.is_data_name(metadata.interop_id):
        return None
    # The first claim counts. The name comes first, then the order of the PNG specification.
    claims = list(_claims(metadata, embedded))
    if not claims:
        if space_names.is_data_name(metadata.color_space):
            return None
        return color_spaces.SRGB if is_integer else color_spaces.LINEAR
    _check_agreement(claims)
    what, space = claims[0]
    if space.is_for_gray and not is_gray:
        raise ValueError(f"{what} is for gray values, and it has colors; {_WAY_OUT}")
    if space.is_srgb and is_integer:
        return color_spaces.SRGB
    return space


def _check_agreement(claims: list[tuple[str, Space]]) -> None:
    """Raises ValueError if the name contradicts the other metadata."""
    (first, space), *others = claims
    for other, other_space in others:
        if first.startswith("colorInteropID") and not space.agrees(other_space):
            raise ValueError(f"{first} and {other} are different color spaces; {_WAY_OUT}")


def _claims(metadata: Metadata, embedded: EmbeddedMetadata) -> Iterator[tuple[str, Space]]:
    """Yields each source of color metadata, in words, with the space that it names."""
    if metadata.interop_id not in _UNKNOWN:
        what = f"colorInteropID '{metadata.interop_id}'"
        yield what, _named(metadata.interop_id, what)
    chunks = embedded.chunks
    if b"cICP" in chunks:
        yield "its cICP chunk", _of_cicp(chunks[b"cICP"])
        return
    profile = embedded.icc or metadata.icc
    if profile:
        yield "its ICC profile", _of_icc(profile)
        return
    if b"sRGB" in chunks:
        yield "its sRGB chunk", color_spaces.SRGB
        return
    name = metadata.color_space
    named_space = None if name in _UNKNOWN else color_spaces.named(name)
    if chunks and named_space is not None and not named_space.is_rec709:
        # OpenImageIO before 3.1 stores the name in a text attribute.
        yield f"its color space '{name}'", named_space
        return
    if b"gAMA" in chunks:
        yield "its gAMA chunk", _of_gamma(chunks)
        return
    if metadata.chromaticities is not None:
        points = tuple(round(number, 6) for number in metadata.chromaticities)
        yield "its chromaticities", _of_chromaticities(points)
        return
    if metadata.is_adobe_rgb or exif_of(embedded.exif).is_adobe_rgb:
        yield "its EXIF", _named("g22_adobergb_scene", "EXIF")
        return
    granted = _TAKEN_FOR_GRANTED.get(metadata.format, _TAKEN_FOR_GRANTED[""])
    if name not in _UNKNOWN | granted and not space_names.is_data_name(name):
        if name == "GammaCorrected":
            name = f"Gamma{metadata.gamma:g}"
        if metadata.interop_id in _UNKNOWN:
            yield f"its color space '{name}'", _named(name, f"the color space '{name}'")


def _named(name: str, what: str) -> Space:
    space = color_spaces.named(name)
    if space is None:
        raise ValueError(f"{what}: is not known; {_WAY_OUT}")
    return space


def _of_icc(profile: bytes) -> Space:
    try:
        return icc.space_of(profile)
    except ValueError as error:
        raise ValueError(f"it has {error}, and cannot be converted; {_WAY_OUT}") from error


def _of_cicp(data: bytes) -> Space:
    values = tuple(data)
    if len(values) == 4 and values[2:] == (0, 1):
        primaries, curve = _CICP_PRIMARIES.get(values[0]), _CICP_CURVES.get(values[1])
        if primaries is not None and curve is not None:
            space = _named(f"{curve}_{primaries}_display", "cICP")
            return replace(space, chunks=((b"cICP", data),))
    raise ValueError(f"its cICP chunk {values} names colors that cannot be converted; {_WAY_OUT}")


def _of_gamma(chunks: Mapping[bytes, bytes]) -> Space:
    try:
        (number,) = struct.unpack(">I", chunks[b"gAMA"])
        points = struct.unpack(">8I", chunks[b"cHRM"]) if b"cHRM" in chunks else None
    except struct.error as error:
        raise ValueError(f"its gAMA or cHRM chunk is damaged; {_WAY_OUT}") from error
    if number == 0:
        raise ValueError(f"its gAMA chunk says 0, which is no exponent; {_WAY_OUT}")
    white_last = color_spaces.REC709
    if points is not None:
        white_last = tuple(value / _PNG_UNIT for value in (*points[2:], *points[:2]))
    gamma = _PNG_UNIT / number
    space = _of_chromaticities(white_last)
    return replace(
        space,
        name=f"the gamma {gamma:.3g}",
        curves=(color_spaces.ParametricCurve(gamma),),
        chunks=tuple((kind, chunks[kind]) for kind in (b"gAMA", b"cHRM") if kind in chunks),
    )


def _of_chromaticities(points: tuple[float, ...]) -> Space:
    try:
        matrix = color_spaces.matrix_of(points)
    except ValueError as error:
        raise ValueError(f"its {error}; {_WAY_OUT}") from error
    return Space(f"the chromaticities {points}", to_rec709=matrix)
