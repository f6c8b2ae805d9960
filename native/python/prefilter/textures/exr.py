# SPDX-License-Identifier: GPL-3.0-or-later

"""Mip-mapped OpenEXR files, for renderers and their texture systems."""

import struct
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_one_of, as_progress, is_srgb
from .._border.arrays import as_threads
from .._border.names import Alpha, Encoding, ExrFormat
from ..files.staging import Output, as_output, write_output
from .texel_formats import ALPHAS
from .texels import halving_levels

_TILE_SIDE = _native.EXR_TILE_SIDE
_TILES_A_STEP = 512
_FORMATS = {"half": 1, "float": 2}
_CHANNELS = {1: "Y", 2: "AY", 3: "BGR", 4: "ABGR"}
_MAGIC, _VERSION, _TILED, _LONG_NAMES = 20000630, 2, 0x200, 0x400
_LONGEST_SHORT_NAME, _LONGEST_NAME = 31, 255
_ZIP = 3
_ONE_LEVEL, _MIPMAP_ROUNDED_DOWN = 0, 1
_POINTS = 8


def write_exr(
    path: Output,
    levels: Sequence[npt.ArrayLike],
    *,
    format: ExrFormat = "half",
    encoding: Encoding = "linear",
    alpha: Alpha = "straight",
    attributes: Mapping[str, str] | None = None,
    chromaticities: Sequence[float] | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> None:
    """Writes levels as a tiled, mip-mapped OpenEXR file for renderers.

    Texels are scene-linear, with associated alpha, in tiles of 64 x 64, compressed without loss
    (ZIP). The file is staged beside `path` and renamed, so a failure leaves an earlier file intact.
    Hardly any memory is needed besides the levels.

    Args:
        path: The file, in an existing folder; or a file object open to write bytes, at its start.
        levels: (height, width, 1 to 4 channels) each, level 0 first, down to 1 x 1, row 0 at v = 0,
            the bottom; each has half the sides of the previous one, rounded down. Floats are
            scene-linear. Levels may have different types, such as an image of bytes with other
            levels of floats; uint8 is divided by 255, uint16 by 65535.
        format: "half" for 16-bit floats, "float" for 32-bit ones. Values beyond the range of halves
            are clipped to it.
        encoding: Encoding of integer colors: "linear" or "srgb". Alpha is always linear.
        alpha: Meaning of the last of two or four channels: "straight" (colors will be multiplied by
            it), "premultiplied" (colors are already multiplied) or "independent" (no alpha). In
            halves alpha is clipped to [0, 1].
        attributes: Texts for the file's header, such as {"wrapmodes": "periodic,periodic"}.
        chromaticities: x and y of red, green, blue and white, for the header; None to omit them.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. The file does not depend on it.

    Raises:
        ValueError: An argument is out of range.
        OSError: The file cannot be written.
        Cancelled: The progress callback returned False.
    """
    srgb = is_srgb(encoding)
    images = _as_all_levels(levels, srgb)
    _write_images(
        path,
        images,
        format=format,
        srgb=srgb,
        alpha=alpha,
        mode=_MIPMAP_ROUNDED_DOWN,
        attributes=attributes,
        chromaticities=chromaticities,
        progress=progress,
        threads=threads,
    )


def write_exr_picture(
    path: Output,
    pixels: npt.ArrayLike,
    *,
    format: ExrFormat = "half",
    alpha: Alpha = "premultiplied",
    attributes: Mapping[str, str] | None = None,
    chromaticities: Sequence[float] | None = None,
    threads: int = 0,
) -> None:
    """Writes a picture of one level, in the same form as `write_exr`.

    Args:
        path: As for `write_exr`.
        pixels: (height, width, 1 to 4 channels) floats, scene-linear, row 0 at the bottom.
        format: As for `write_exr`.
        alpha: As for `write_exr`.
        attributes: As for `write_exr`.
        chromaticities: As for `write_exr`.
        threads: As for `write_exr`.

    Raises:
        ValueError: An argument is out of range.
        OSError: The file cannot be written.
    """
    _write_images(
        path,
        halving_levels([pixels], False),
        format=format,
        srgb=False,
        alpha=alpha,
        mode=_ONE_LEVEL,
        attributes=attributes,
        chromaticities=chromaticities,
        progress=None,
        threads=threads,
    )


def _write_images(
    path: Output,
    images: Sequence[np.ndarray],
    *,
    format: str,
    srgb: bool,
    alpha: str,
    mode: int,
    attributes: Mapping[str, str] | None,
    chromaticities: Sequence[float] | None,
    progress: ProgressCallback | None,
    threads: int,
) -> None:
    as_one_of("format", format, _FORMATS)
    has_alpha = as_one_of("alpha", alpha, ALPHAS) != "independent" and images[0].shape[2] in (2, 4)
    texts = _as_texts(attributes)
    points = _as_points(chromaticities)
    output = as_output(path)
    report = as_progress(progress)
    tiles = partial(
        _native.exr_tiles,
        srgb=srgb,
        half=format == "half",
        has_alpha=has_alpha,
        multiplies=has_alpha and alpha == "straight",
        threads=as_threads(threads),
    )
    header = _header(images[0], format, mode, {**texts, **points})
    write_output(output, lambda file: _write_parts(file, header, images, tiles, report))
    if report is not None:
        report(1.0)


def _write_parts(
    file: BinaryIO,
    header: bytes,
    images: Sequence[np.ndarray],
    tiles: Callable[..., tuple[np.ndarray, Sequence[int]]],
    report: ProgressCallback | None,
) -> None:
    """Writes the header, the table of offsets, and all tiles, a few rows of tiles at a time."""
    counts = [tuple(-(-side // _TILE_SIDE) for side in image.shape[1::-1]) for image in images]
    tile_count = sum(columns * rows for columns, rows in counts)
    file.write(header)
    file.write(bytes(8 * tile_count))
    sizes: list[int] = []
    for number, (image, (columns, rows)) in enumerate(zip(images, counts, strict=True)):
        step = max(1, _TILES_A_STEP // columns)
        for first in range(0, rows, step):
            if report is not None and report(len(sizes) / tile_count) is False:
                raise _native.Cancelled("cancelled")
            count = min(step, rows - first)
            chunks, chunk_sizes = tiles(image, number=number, first_row=first, row_count=count)
            file.write(chunks.data)
            sizes.extend(chunk_sizes)
    end_of_table = len(header) + 8 * tile_count
    offsets = end_of_table + np.cumsum([0, *sizes[:-1]], dtype=np.int64)
    file.seek(len(header))
    file.write(offsets.astype("<u8").tobytes())


def _as_all_levels(levels: Sequence[npt.ArrayLike], srgb: bool) -> list[np.ndarray]:
    """Returns the levels, each uint8 or float32; raises ValueError unless they end at 1 x 1."""
    images = halving_levels(levels, srgb)
    height, width, _ = images[-1].shape
    if (height, width) != (1, 1):
        raise ValueError(
            f"levels: the last of {len(images)} has {width} x {height} texels; all levels down to "
            f"1 x 1 are needed"
        )
    return images


def _as_points(chromaticities: Sequence[float] | None) -> "_Attributes":
    if chromaticities is None:
        return {}
    points = np.asarray(chromaticities, np.float64)
    if points.shape != (_POINTS,) or not np.isfinite(points).all():
        raise ValueError(
            f"chromaticities: found {chromaticities!r}; x and y of red, green, blue and white are "
            f"needed"
        )
    return {b"chromaticities": (b"chromaticities", points.astype("<f4").tobytes())}


def _as_texts(attributes: Mapping[str, str] | None) -> "_Attributes":
    if attributes is None:
        return {}
    if not isinstance(attributes, Mapping):
        raise ValueError(
            f"attributes: a {type(attributes).__name__}; names and texts are needed, in a dict"
        )
    texts: _Attributes = {}
    for name, text in attributes.items():
        if not isinstance(name, str) or not isinstance(text, str):
            raise ValueError(f"attributes: found {name!r}: {text!r}; a name and a text are needed")
        encoded = name.encode()
        if not 0 < len(encoded) <= _LONGEST_NAME or b"\0" in encoded:
            raise ValueError(
                f"attributes: the name {name!r}; 1 to {_LONGEST_NAME} bytes, none of them zero, "
                f"are needed"
            )
        if encoded in _REQUIRED:
            raise ValueError(f"attributes: the name {name!r} is one that OpenEXR files have anyway")
        texts[encoded] = (b"string", text.encode())
    return texts


_Attributes = dict[bytes, tuple[bytes, bytes]]
"""Types and values by name."""

_REQUIRED = frozenset(
    b"channels chromaticities compression dataWindow displayWindow lineOrder pixelAspectRatio "
    b"screenWindowCenter screenWindowWidth tiles".split()
)


def _header(image: np.ndarray, format: str, mode: int, more: "_Attributes") -> bytes:
    height, width, channels = image.shape
    names = _CHANNELS[channels].encode()
    listed = b"".join(
        struct.pack("<2siB3xii", bytes([name, 0]), _FORMATS[format], 0, 1, 1) for name in names
    )
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes: _Attributes = {
        b"channels": (b"chlist", listed + b"\0"),
        b"compression": (b"compression", bytes([_ZIP])),
        b"dataWindow": (b"box2i", window),
        b"displayWindow": (b"box2i", window),
        b"lineOrder": (b"lineOrder", b"\0"),
        b"pixelAspectRatio": (b"float", struct.pack("<f", 1.0)),
        b"screenWindowCenter": (b"v2f", struct.pack("<2f", 0.0, 0.0)),
        b"screenWindowWidth": (b"float", struct.pack("<f", 1.0)),
        b"tiles": (b"tiledesc", struct.pack("<2IB", _TILE_SIDE, _TILE_SIDE, mode)),
        **more,
    }
    is_long = any(len(name) > _LONGEST_SHORT_NAME for name in attributes)
    flags = _VERSION | _TILED | (_LONG_NAMES if is_long else 0)
    parts = [struct.pack("<2i", _MAGIC, flags)]
    for name, (kind, value) in sorted(attributes.items()):
        parts += [name, b"\0", kind, b"\0", struct.pack("<i", len(value)), value]
    return b"".join([*parts, b"\0"])
