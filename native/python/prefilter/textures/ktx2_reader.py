# SPDX-License-Identifier: GPL-3.0-or-later

"""Reader of KTX 2.0 files, written by this package or by other tools for glTF."""

import math
import os
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from .. import _native
from .._border.arguments import ProgressCallback, as_progress, progress_part
from .._border.arrays import as_threads
from .._border.input import as_path, open_file
from .ktx2_metadata import HEADER, IDENTIFIER, RefusedError, metadata_of, part_of
from .texel_formats import TEXEL_FORMATS

_LEVEL = struct.Struct("<3Q")
_NONE, _BASIS_LZ, _ZSTD = 0, 1, 2
_SCHEMES = {_NONE: "none", _BASIS_LZ: "basislz", _ZSTD: "zstd"}
_MOST_SIDE = 1 << 16
_MOST_ETC1S_TEXELS = 1 << 28
"""1 GiB when decoded: a few bytes of ETC1S may decode to any number of texels."""
_ETC1S, _UASTC = 163, 166
_TRANSFER_SRGB = 2
_FLAG_PREMULTIPLIED = 1

_ALL = (0, 1, 2, 3)
_CHANNELS: dict[tuple[int, tuple[int, ...]], tuple[int, ...]] = {
    (_UASTC, (0,)): _ALL[:3],
    (_UASTC, (3,)): _ALL,
    (_UASTC, (4,)): (0,),
    (_UASTC, (5,)): (0, 3),
    (_UASTC, (6,)): (0, 1),
    (_ETC1S, (0,)): _ALL[:3],
    (_ETC1S, (0, 15)): _ALL,
    (_ETC1S, (3,)): (0,),
    (_ETC1S, (3, 4)): (0, 3),
}
"""The decoded channels that a texture has, by its color model and the channels it names."""


class _Stored(NamedTuple):
    """The storage of texels, from a VkFormat."""

    name: str
    is_srgb: bool
    channels: int
    dtype: Any
    """None for blocks."""


def _stored() -> dict[int, _Stored]:
    storage: dict[int, _Stored] = {}
    for texel_format in TEXEL_FORMATS.values():
        for is_srgb, code in enumerate(texel_format.vulkan):
            if code:
                dtype: Any = None if texel_format.is_block else texel_format.channel_type
                storage[code] = _Stored(
                    texel_format.name, bool(is_srgb), texel_format.channels, dtype
                )
    for first, name, dtype in ((70, "16", np.uint16), (76, "16f", np.float16)):
        for number, channels in enumerate(("r", "rg", "rgb", "rgba")):
            storage.setdefault(
                first + 7 * number, _Stored(channels + name, False, number + 1, dtype)
            )
    for number, channels in enumerate(("r", "rg", "rgb")):
        storage[100 + 3 * number] = _Stored(f"{channels}32f", False, number + 1, np.float32)
    storage[23] = _Stored("rgb8", False, 3, np.uint8)
    storage[29] = _Stored("rgb8", True, 3, np.uint8)
    return storage


_STORED = _stored()


@dataclass(frozen=True)
class Ktx2Info:
    """Properties of a KTX 2 file.

    Attributes:
        format: Storage of texels: a name of `TEXEL_FORMATS`, "etc1s", or "r16", "rgb8" and the
            like.
        encoding: Encoding of colors in bytes: "linear" or "srgb".
        alpha: Kind of alpha in the fourth channel, "straight" or "premultiplied"; None if there is
            no fourth channel.
        supercompression: Additional compression of levels: "none", "zstd" or "basislz".
        metadata: Texts stored in the file, by key, such as "KTXwriter".
    """

    format: str
    encoding: str
    alpha: str | None
    supercompression: str
    metadata: Mapping[str, str]


def read_ktx2(
    path: str | os.PathLike[str] | BinaryIO,
    *,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> tuple[list[np.ndarray], Ktx2Info]:
    """Reads all levels of a KTX 2.0 file, decoded.

    Supported are all formats of `write_ktx2`, with or without zstd; UASTC and ETC1S (BasisLZ) with
    any channels, as in glTF's KHR_texture_basisu; and uint8, uint16, half floats and floats with
    one to four channels.

    Args:
        path: The file, or a file object open to read bytes.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. The result does not depend on it.

    Returns:
        The levels, (height, width, channels) each, level 0 first, row 0 at v = 0, the bottom: uint8
        or uint16, to be divided by 255 and 65535, or float32; and the file's properties. A file
        with red and alpha only has two channels.

    Raises:
        ValueError: The file is no KTX 2 file, damaged, in another format, or has several images per
            level (an array, a cube map, a volume).
        OSError: The file cannot be read.
        Cancelled: The progress callback returned False.
    """
    report = as_progress(progress)
    count = as_threads(threads)
    who, data = _read(path)
    try:
        return _decoded(data, report, count)
    except RefusedError as error:
        raise ValueError(f"path: {who}: {error}") from None
    except (ValueError, struct.error) as error:
        raise ValueError(f"path: {who} is damaged: {error}") from error


def _read(path: Any) -> tuple[str, bytes]:
    if hasattr(path, "read"):
        data = path.read()
        if not isinstance(data, bytes):
            raise ValueError(f"path: {path!r}; a file that is open to read bytes is needed")
        return "the file", data
    source = as_path(path)
    with open_file(source) as file:
        return f"'{source}'", file.read()


class _File(NamedTuple):
    """The parts of a file, without supercompression."""

    stored: _Stored | None
    """None for UASTC and ETC1S, which only the descriptor identifies."""
    model: int
    channel_names: tuple[int, ...]
    width: int
    height: int
    levels: Sequence[bytes]
    global_data: bytes
    info: Ktx2Info


def _decoded(
    data: bytes, report: ProgressCallback | None, threads: int
) -> tuple[list[np.ndarray], Ktx2Info]:
    file = _parsed(data)
    sizes = [
        (max(1, file.width >> number), max(1, file.height >> number))
        for number in range(len(file.levels))
    ]
    if file.model == _ETC1S:
        levels = _of_etc1s(file, sizes, report)
    else:
        texels = [width * height for width, height in sizes]
        levels = []
        for number, (level, size) in enumerate(zip(file.levels, sizes, strict=True)):
            begin, end = (sum(texels[: number + i]) / sum(texels) for i in (0, 1))
            part = progress_part(report, begin, end)
            levels.append(_of_level(file, level, size, part, threads))
    if report is not None:
        report(1.0)
    orientation = file.info.metadata.get("KTXorientation", "rd")
    rows = slice(None) if orientation[1:2] == "u" else slice(None, None, -1)
    columns = slice(None, None, -1) if orientation[:1] == "l" else slice(None)
    return [np.ascontiguousarray(level[rows, columns]) for level in levels], file.info


def _parsed(data: bytes) -> _File:
    if not data.startswith(IDENTIFIER):
        raise RefusedError("no KTX 2 file")
    header = HEADER.unpack_from(data, len(IDENTIFIER))
    code, _, width, height, depth, layers, faces, count, scheme = header[:9]
    descriptor_at, descriptor_bytes, metadata_at, metadata_bytes, global_at, global_bytes = header[
        9:
    ]
    if depth or layers or faces != 1:
        raise RefusedError(
            f"has a depth of {depth}, {layers} layers and {faces} faces; textures of one image a "
            f"level, with a depth and layers of 0 and one face, are read"
        )
    if not (0 < width <= _MOST_SIDE and 0 < height <= _MOST_SIDE):
        raise RefusedError(
            f"is {width} x {height} texels large; sides of 1 to {_MOST_SIDE} are read"
        )
    count = max(1, count)
    if count > max(width, height).bit_length():
        raise RefusedError(f"has {count} levels, too many for {width} x {height} texels")
    if scheme not in _SCHEMES:
        raise RefusedError(
            f"has the supercompression {scheme}; 0 to 2 (none, BasisLZ, zstd) are read"
        )
    model, channel_names, is_srgb, is_premultiplied = _descriptor(
        part_of(data, descriptor_at, descriptor_bytes)
    )
    stored = _STORED.get(code)
    is_basis = code == 0 and model == (_ETC1S if scheme == _BASIS_LZ else _UASTC)
    if is_basis and (model, channel_names) not in _CHANNELS:
        raise RefusedError(f"has the channels {channel_names}, which its format does not know")
    if not is_basis and (stored is None or scheme == _BASIS_LZ):
        raise RefusedError(
            f"has the VkFormat {code} and the color model {model}, which are not read"
        )
    starts = len(IDENTIFIER) + HEADER.size
    levels = []
    for number in range(count):
        offset, size, whole = _LEVEL.unpack_from(data, starts + number * _LEVEL.size)
        level = part_of(data, offset, size)
        levels.append(_native.decompress(level, whole) if scheme == _ZSTD else level)
    if is_basis:
        channels = len(_CHANNELS[model, channel_names])
        name = "etc1s" if model == _ETC1S else "uastc"
    else:
        assert stored is not None
        channels, name, is_srgb = stored.channels, stored.name, stored.is_srgb
    alpha = None
    if channels == 4:
        alpha = "premultiplied" if is_premultiplied else "straight"
    info = Ktx2Info(
        format=name,
        encoding="srgb" if is_srgb else "linear",
        alpha=alpha,
        supercompression=_SCHEMES[scheme],
        metadata=metadata_of(part_of(data, metadata_at, metadata_bytes)),
    )
    return _File(
        None if is_basis else stored,
        model if is_basis else 0,
        channel_names,
        width,
        height,
        levels,
        part_of(data, global_at, global_bytes),
        info,
    )


def _descriptor(data: bytes) -> tuple[int, tuple[int, ...], bool, bool]:
    """Returns color model, sample channels, and whether sRGB and premultiplied."""
    model, _, transfer, flags = struct.unpack_from("<4B", data, 12)
    (size,) = struct.unpack_from("<H", data, 10)
    samples = max(0, min(size - 24, len(data) - 28)) // 16
    names = tuple(data[28 + 16 * number + 3] & 0xF for number in range(samples))
    return model, names, transfer == _TRANSFER_SRGB, bool(flags & _FLAG_PREMULTIPLIED)


def _of_level(
    file: _File,
    data: bytes,
    size: tuple[int, int],
    report: ProgressCallback | None,
    threads: int,
) -> np.ndarray:
    """Returns a level that is not in ETC1S, in the file's row order."""
    width, height = size
    stored = file.stored
    if stored is not None and stored.dtype is not None:
        dtype = np.dtype(stored.dtype).newbyteorder("<")
        needed = width * height * stored.channels * dtype.itemsize
        if len(data) != needed:
            raise RefusedError(
                f"has {len(data)} bytes for {width} x {height} texels in '{stored.name}', which "
                f"take {needed}"
            )
        texels = np.frombuffer(data, dtype).reshape(height, width, stored.channels)
        return texels.astype(np.float32 if dtype.kind == "f" else stored.dtype)
    is_srgb = file.info.encoding == "srgb"
    name = "uastc" if stored is None else stored.name
    blocks: np.ndarray = _native.decode_blocks(data, name, is_srgb, width, height, report, threads)
    if blocks.dtype == np.uint16:
        blocks = blocks.view(np.float16).astype(np.float32)
    if stored is not None:
        return blocks[..., : stored.channels]
    return blocks[..., _CHANNELS[_UASTC, file.channel_names]]


def _of_etc1s(
    file: _File, sizes: Sequence[tuple[int, int]], report: ProgressCallback | None
) -> list[np.ndarray]:
    """Returns all levels of a file in ETC1S, in the file's row order."""
    if math.prod(sizes[0]) > _MOST_ETC1S_TEXELS:
        raise RefusedError(
            f"is {file.width} x {file.height} texels large; {_MOST_ETC1S_TEXELS} texels of ETC1S "
            f"are read at most"
        )
    counts = struct.unpack_from("<2H4I", file.global_data)
    images = [
        struct.unpack_from("<5I", file.global_data, 20 + 20 * number)
        for number in range(len(file.levels))
    ]
    at = 20 + 20 * len(images)
    books = []
    for length in counts[2:5]:
        books.append(part_of(file.global_data, at, length))
        at += length
    parts = [
        (*size, part_of(level, image[1], image[2]), part_of(level, image[3], image[4]))
        for size, level, image in zip(sizes, file.levels, images, strict=True)
    ]
    endpoints, selectors, tables = books
    levels = _native.decode_etc1s(
        (counts[0], counts[1], endpoints, selectors, tables), parts, report
    )
    return [level[..., _CHANNELS[_ETC1S, file.channel_names]] for level in levels]
