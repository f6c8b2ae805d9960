# SPDX-License-Identifier: GPL-3.0-or-later

"""Writers of texture files for engines: DDS and KTX 2, with all levels."""

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

    The file is staged beside `path` and renamed, so a failure leaves an earlier file intact.

    Args:
        path: The file, in an existing folder; or a file object open to write bytes.
        levels: (height, width, 1 to 4 channels) or (height, width) each, level 0 first, row 0 at
            v = 0, the bottom (the file has the top row first); each has half the sides of the
            previous one, rounded down. The last ones may be omitted. uint8 (divided by 255), uint16
            (divided by 65535), or scene-linear floats.
        format: How texels are stored: "r8", "rg8", "rgba8" as bytes, "rgba16f", "rgba32f" as
            floats; in blocks of 4 x 4, "bc1", "bc1-rgb", "bc3", "bc4", "bc5" and "bc7" compressed
            from bytes, and "bc6h" from half floats. "auto" keeps bytes and their channels, and
            stores other types as "rgba16f". "r8" and "bc4" take the first channel, "rg8" and "bc5"
            two, "bc1-rgb" and "bc6h" three; in the others, missing alpha is 1. If three or four
            channels are stored, a single channel is gray. "bc1" has only alpha 0 and 1: texels
            below one half become black and transparent. "bc6h" has no negative values: they become
            0.
        encoding: Encoding of colors: "linear" or "srgb". It applies to levels of uint8 and uint16,
            and to formats in bytes and blocks: levels of floats are encoded (values beyond [0, 1]
            are clipped), and formats in floats and "bc6h" get decoded, linear values. The fourth
            channel is always linear.
        alpha: Meaning of a fourth channel: "straight", "premultiplied" (colors are multiplied by
            it) or "independent" (no alpha). Values are stored unchanged, and the file declares
            this, except "independent" in KTX 2, which cannot express it. Colors that straight alpha
            hides have little weight in the blocks of "bc3".
        effort: How long to search for closer blocks: "fast" (for BC7, a thirtieth of the time of
            "normal"), "normal" or "best" (for BC7, ten times the time). Levels of up to 64 x 64
            texels get the next higher effort. File sizes are the same.
        header: "dx10", the header of Direct3D 10 and later, can express all of this. "legacy", that
            of Direct3D 9, is read by more programs. It supports all formats except "rg8", "bc6h"
            and "bc7", and declares neither sRGB nor the kind of alpha; bytes are in the order blue,
            green, red, and "r8" is luminance. "auto" uses it if nothing is lost: for linear levels
            in "rgba8", "bc1", "bc1-rgb", "bc3", "bc4" and "bc5", with straight alpha or none.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. The file does not depend on it.

    Raises:
        ValueError: An argument is out of range, a value is not finite or too large for half floats,
            or the format has no sRGB variant in such files.
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

    "r8" and "rg8" have an sRGB variant here, which some graphics cards lack; "auto" stores such
    levels as "rgba8". Otherwise it works like `write_dds`.

    Args:
        path: As for `write_dds`.
        levels: As for `write_dds`.
        format: Also the formats of mobile devices, compressed from bytes: "etc2-rgb", "etc2-rgba",
            "eac-r11" (the first channel) and "eac-rg11" (two) in blocks of 4 x 4;
            "astc-4x4", "astc-6x6", "astc-8x8" in blocks of that size, by astcenc. "astc-4x4-hdr"
            and "astc-6x6-hdr" are compressed from half floats; negative values become 0, and alpha
            above 1 becomes 1. "uastc" and "etc1s", by Basis Universal, are transcoded by loaders to
            a format of the device; in "etc1s" all levels share codebooks, and files are several
            times smaller than in any other format.
        encoding: As for `write_dds`.
        alpha: As for `write_dds`; it affects the blocks of ASTC like those of "bc3".
        effort: As for `write_dds`; in "etc1s" it applies to all levels alike.
        supercompression: "zstd" compresses every level again, without loss; most loaders support
            it, and decompress a level before they upload it. "none" does not; "etc1s" requires
            "none", as it is always compressed by BasisLZ.
        quality: For "etc1s" only, 1 to 255: from the smallest file to the best picture.
        metadata: More texts to store, by key; keys that begin with "KTX" are reserved by the
            format.
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
    """Returns the container's code for a format."""
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
    """Returns the levels' bytes for a file, and their sizes before supercompression."""
    texels = sum(image.shape[0] * image.shape[1] for image in images)
    payloads: list[bytes] = []
    sizes: list[int] = []
    texels_done = 0
    for image in images:
        size = image.shape[0] * image.shape[1]
        part = _part(report, texels_done / texels, size / texels)
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
        texels_done += size
    return payloads, sizes


def _part(progress: ProgressCallback | None, start: float, share: float) -> ProgressCallback | None:
    return None if progress is None else lambda fraction: progress(start + share * fraction)
