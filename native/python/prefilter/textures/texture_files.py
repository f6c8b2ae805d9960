# SPDX-License-Identifier: GPL-3.0-or-later

"""Texture files that engines and viewers read: DDS and KTX 2, with all levels."""

from collections.abc import Mapping, Sequence
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_one_of, as_progress, is_srgb
from .._border.arrays import as_threads
from .._border.names import (
    Alpha,
    Auto,
    DdsFormat,
    Effort,
    Encoding,
    Header,
    Ktx2Format,
    Supercompression,
)
from ..files.staging import Output, as_output, write_output
from . import dds, etc1s
from .ktx2 import KTX2, as_metadata
from .texel_formats import ALPHAS, EFFORTS, SUPERCOMPRESSIONS, Container, TexelFormat, Texture
from .texels import as_format, as_levels, encoded

_QUALITY = 192


def write_dds(
    path: Output,
    levels: Sequence[npt.ArrayLike],
    *,
    format: DdsFormat | Auto = "auto",
    encoding: Encoding = "linear",
    alpha: Alpha = "straight",
    effort: Effort = "normal",
    header: Header = "auto",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> None:
    """Writes levels as a DDS file (DirectDraw Surface).

    The file is written beside `path` and renamed, so a failure leaves what was there.

    Args:
        path: The file; its folder must exist. Or one that is open to write bytes.
        levels: (height, width, 1 to 4 channels) or (height, width) each, level 0 first, row 0 at
            v = 0, the bottom (the file holds the top row first); each has half the sides of the one
            before, rounded down. The last ones may be left out. Either uint8 or uint16, which stand
            for a 255th and a 65535th each, or floats that are scene-linear.
        format: How texels are stored: "r8", "rg8", "rgba8" in bytes, "rgba16f", "rgba32f" in
            floats; in blocks of 4 x 4, "bc1", "bc1-rgb", "bc3", "bc4", "bc5" and "bc7" compressed
            from bytes, and "bc6h" from half floats. "auto" keeps bytes and channels of bytes, and
            stores others as "rgba16f". "r8" and "bc4" take the first channel, "rg8" and "bc5" two,
            "bc1-rgb" and "bc6h" three; in the others alpha is 1 where there is none. Where three or
            four are stored, a single channel is gray. "bc1" knows an alpha of 0 or 1 only: below
            one half, texels become black and transparent. "bc6h" has no negative values: they
            become 0.
        encoding: How bytes stand for colors: "linear" or "srgb". It holds for levels of uint8 and
            uint16 and for formats in bytes and blocks: levels of floats are encoded (values beyond
            [0, 1] are clipped), and formats in floats and "bc6h" get decoded, linear values. The
            fourth channel is linear always.
        alpha: What the fourth channel of four is: "straight", "premultiplied" (colors are
            multiplied by it) or "independent" (no alpha). Values are stored as they are; the file
            says it, but for "independent" in KTX 2, which has no word for that. Colors that
            straight alpha hides count little in the blocks of "bc3".
        effort: How long a search for closer blocks may take: "fast" (BC7 in a thirtieth of the time
            of "normal"), "normal" or "best" (BC7 in ten times the time). Levels of up to 64 x 64
            texels get the effort above. Sizes are the same.
        header: "dx10", the header of Direct3D 10 and later, says all of this. "legacy", that of
            Direct3D 9, is read by more programs. It knows all formats but "rg8", "bc6h" and "bc7",
            and says neither that colors are sRGB nor which kind alpha is of; bytes are in the order
            blue, green, red, and "r8" is luminance. "auto" takes it where nothing is lost: for
            linear levels in "rgba8", "bc1", "bc1-rgb", "bc3", "bc4" and "bc5", with straight alpha
            or none.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. The file does not depend on it.

    Raises:
        ValueError: An argument is out of range, a value is not finite or too large for half floats,
            or the format has no sRGB form in such files.
        OSError: The file cannot be written.
        Cancelled: The progress callback returned False.
    """
    container = dds.container(as_one_of("header", header, dds.HEADERS))
    _write(
        *(path, levels, format, encoding, alpha, effort, "none", _QUALITY),
        *(progress, threads, container),
    )


def write_ktx2(
    path: Output,
    levels: Sequence[npt.ArrayLike],
    *,
    format: Ktx2Format | Auto = "auto",
    encoding: Encoding = "linear",
    alpha: Alpha = "straight",
    effort: Effort = "normal",
    supercompression: Supercompression = "none",
    quality: int = _QUALITY,
    metadata: Mapping[str, str] | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> None:
    """Writes levels as a KTX 2.0 file (Khronos texture).

    "r8" and "rg8" have an sRGB form here, which some graphics cards lack; "auto" stores such levels
    as "rgba8". The rest is as for `write_dds`.

    Args:
        path: As for `write_dds`.
        levels: As for `write_dds`.
        format: Also those of mobile devices, compressed from bytes: "etc2-rgb", "etc2-rgba",
            "eac-r11" (the first channel) and "eac-rg11" (two) in blocks of 4 x 4;
            "astc-4x4", "astc-6x6", "astc-8x8" in blocks of that size, by astcenc. "astc-4x4-hdr"
            and "astc-6x6-hdr" are compressed from half floats; negative values become 0, and an
            alpha beyond 1 becomes 1. "uastc" and "etc1s", by Basis Universal, are turned into what
            a device has when they are loaded; in "etc1s" all levels share codebooks, and files are
            several times smaller than in any other format.
        encoding: As for `write_dds`.
        alpha: As for `write_dds`; it counts in the blocks of ASTC as in those of "bc3".
        effort: As for `write_dds`; "etc1s" takes it as a whole.
        supercompression: "zstd" compresses every level once more, without loss; most loaders know
            it, and undo it before they upload a level. "none" does not; "etc1s" has to have it, and
            is compressed by BasisLZ.
        quality: Of "etc1s", 1 to 255: from the smallest file to the best picture. No other format
            uses it.
        metadata: More texts that the file keeps, by keys; those that begin with "KTX" are the
            format's own.
        progress: As for `write_dds`.
        threads: As for `write_dds`. In "etc1s" the file may depend on the C++ standard library.

    Raises:
        ValueError: As for `write_dds`.
        OSError: As for `write_dds`.
        Cancelled: As for `write_dds`.
    """
    texts = as_metadata(metadata)
    _write(
        *(path, levels, format, encoding, alpha, effort, supercompression, quality),
        *(progress, threads, KTX2, texts),
    )


def _write(
    path: Output,
    levels: Sequence[npt.ArrayLike],
    format: str,
    encoding: str,
    alpha: str,
    effort: str,
    supercompression: str,
    quality: int,
    progress: ProgressCallback | None,
    threads: int,
    container: Container,
    metadata: tuple[tuple[str, str], ...] = (),
) -> None:
    srgb = is_srgb(encoding)
    images = as_levels(levels, srgb)
    texel_format = as_format(format, images[0], needs_srgb=srgb)
    srgb = srgb and not texel_format.is_float
    code = _code(container, texel_format, srgb)
    output = as_output(path)
    report = as_progress(progress)
    count = as_threads(threads)
    height, width, channels = images[0].shape
    has_alpha = channels == 4 and texel_format.channels == 4
    alpha = as_one_of("alpha", alpha, ALPHAS)
    effort = as_one_of("effort", effort, EFFORTS)
    scheme = as_one_of("supercompression", supercompression, SUPERCOMPRESSIONS)
    quality = etc1s.as_quality(quality)
    shared = b""
    if texel_format.is_shared:
        if scheme != "none":
            raise ValueError(
                f"supercompression: '{scheme}' with the format '{texel_format.name}', which has "
                "one of its own; 'none' is needed"
            )
        scheme = "basislz"
        payloads, shared = etc1s.compressed(
            images,
            encoding == "srgb",
            has_alpha=has_alpha,
            quality=quality,
            effort=effort,
            report=report,
            threads=count,
        )
        sizes = [0] * len(payloads)
    else:
        weigh = has_alpha and alpha == "straight"
        payloads, sizes = _payloads(
            images, texel_format, encoding == "srgb", weigh, effort, scheme, report, count
        )
    texture = Texture(
        texel_format=texel_format,
        code=code,
        is_srgb=srgb,
        width=width,
        height=height,
        levels=payloads,
        alpha=alpha if has_alpha else None,
        supercompression=scheme,
        level_bytes=tuple(sizes),
        shared=shared,
        metadata=metadata,
    )

    def write_parts(file: BinaryIO) -> None:
        for part in container.parts(texture):
            file.write(part)

    write_output(output, write_parts)
    if report is not None:
        report(1.0)


def _code(container: Container, texel_format: TexelFormat, srgb: bool) -> int:
    """What a container calls a format."""
    codes = container.codes(texel_format)
    if codes == (None, None):
        raise ValueError(f"format: {container.name} files have no '{texel_format.name}'")
    code = codes[srgb]
    if code is None:
        raise ValueError(
            f"encoding: 'srgb' with the format '{texel_format.name}', which has no sRGB form in "
            f"{container.name} files; 'linear' or another format is needed"
        )
    return code


def _payloads(
    images: Sequence[np.ndarray],
    texel_format: TexelFormat,
    is_encoded: bool,
    weigh_by_alpha: bool,
    effort: str,
    scheme: str,
    report: ProgressCallback | None,
    threads: int,
) -> tuple[list[bytes], list[int]]:
    """The levels as a file has them, and their sizes before they were supercompressed."""
    texels = sum(image.shape[0] * image.shape[1] for image in images)
    payloads: list[bytes] = []
    sizes: list[int] = []
    done = 0
    for image in images:
        size = image.shape[0] * image.shape[1]
        part = _part(report, done / texels, size / texels)
        if part is not None and part(0.0) is False:
            raise _native.Cancelled("cancelled")
        payload = encoded(
            image,
            texel_format,
            is_encoded,
            weigh_by_alpha=weigh_by_alpha,
            effort=effort,
            progress=part if scheme == "none" else _part(part, 0.0, 0.5),
            threads=threads,
        )
        sizes.append(len(payload))
        if scheme == "zstd":
            payload = _native.supercompress(payload, _part(part, 0.5, 0.5))
        payloads.append(payload)
        done += size
    return payloads, sizes


def _part(progress: ProgressCallback | None, start: float, share: float) -> ProgressCallback | None:
    return None if progress is None else lambda fraction: progress(start + share * fraction)
