# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the error of block formats, the time of encoding, and the saving by zstd.

Usage: python3 bench/textures/texture_formats.py [--astcenc PROGRAM] IMAGE...

The package, OpenImageIO and the modules in scripts/decoders.txt must be importable; the decoders
are third-party. Images are read as bytes without their alpha; BC3, ETC2 RGBA and the other formats
with alpha get an opaque one. Only the middle 1024 x 1024 of a larger image is used. For ETC1S the
whole file counts. The error is measured at level 0, over red, green and blue. Times are on one
thread, in processor time, best of three interleaved rounds, without zstd.

A peer: Arm's program (Debian's package astcenc), at the same effort, `-medium`.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import opengl_basisu
import OpenImageIO as oiio
import prefilter
import texture2ddecoder as decoders
from numpy.typing import NDArray
from prefilter import TEXEL_FORMATS

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option

Bytes = NDArray[np.uint8]
Decoder = Callable[[bytes, int, int], bytes]

ROUNDS = 3
SIDE = 1024
CHANNELS = {"bc4": 1, "eac-r11": 1, "bc5": 2, "eac-rg11": 2}
DECODERS: dict[str, Decoder] = {
    "bc1": decoders.decode_bc1,
    "bc1-rgb": decoders.decode_bc1,
    "bc3": decoders.decode_bc3,
    "bc4": decoders.decode_bc4,
    "bc5": decoders.decode_bc5,
    "bc7": decoders.decode_bc7,
    "etc2-rgb": decoders.decode_etc2,
    "etc2-rgba": decoders.decode_etc2a8,
    "eac-r11": decoders.decode_eacr,
    "eac-rg11": decoders.decode_eacrg,
}


def astc_decoder(side: int) -> Decoder:
    """Decodes blocks of that size."""
    return lambda data, width, height: decoders.decode_astc(data, width, height, side, side)


DECODERS |= {f"astc-{side}x{side}": astc_decoder(side) for side in (4, 6, 8)}


def level_zero(path: Path) -> bytes:
    """The blocks of level 0 of a KTX 2 file without supercompression."""
    data = path.read_bytes()
    offset, length = np.frombuffer(data, "<u8", 2, 80)
    return data[offset : offset + length]


def texels(decoded: bytes, width: int, height: int) -> Bytes:
    """Returns the texels from the BGRA output of a decoder."""
    return np.frombuffer(decoded, np.uint8).reshape(height, width, 4)[..., [2, 1, 0]]


def signal_to_noise(found: Bytes, image: Bytes, channels: int) -> float:
    """The peak signal-to-noise ratio, in decibels."""
    difference = found[..., :channels].astype(float) - image[..., :channels]
    return float(10 * np.log10(255**2 / np.mean(difference**2)))


def packed_size(image: Bytes, texture_format: str, folder: Path) -> int:
    """Bytes of level 0 with zstd."""
    path = folder / "packed.ktx2"
    prefilter.write_ktx2(
        path,
        [image[::-1]],
        format=texture_format,
        encoding=encoding_of(texture_format),
        supercompression="zstd",
    )
    return int(np.frombuffer(path.read_bytes(), "<u8", 2, 80)[1])


def encoding_of(texture_format: str) -> str:
    """Returns the encoding of color images, if the format has it."""
    return "linear" if TEXEL_FORMATS[texture_format].vulkan[1] is None else "srgb"


def measured(image: Bytes, texture_format: str, folder: Path) -> tuple[float, float, int]:
    """Decibels; processor time; bytes of level 0."""
    height, width, _ = image.shape
    path = folder / "image.ktx2"
    began = time.process_time()
    prefilter.write_ktx2(
        path,
        [image[::-1]],
        format=texture_format,
        encoding=encoding_of(texture_format),
        threads=1,
    )
    seconds = time.process_time() - began
    blocks = level_zero(path)
    if TEXEL_FORMATS[texture_format].is_transcoded:
        found = opengl_basisu.open(path).transcode("rgba8").data.reshape(height, width, 4)
    else:
        found = texels(DECODERS[texture_format](blocks, width, height), width, height)
    decibels = signal_to_noise(found, image, CHANNELS.get(texture_format, 3))
    is_shared = TEXEL_FORMATS[texture_format].is_shared
    return decibels, seconds, path.stat().st_size if is_shared else len(blocks)


def peer(program: str, image: Bytes, side: int, folder: Path) -> tuple[float, float, int]:
    """Measures Arm's program: decibels; processor time; bytes of level 0."""
    height, width, _ = image.shape
    source, target = folder / "image.png", folder / "image.astc"
    output = oiio.ImageOutput.create(str(source))
    output.open(str(source), oiio.ImageSpec(width, height, 3, "uint8"))
    output.write_image(image)
    output.close()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [program, "-cs", source, target, f"{side}x{side}", "-medium", "-j", "1", "-silent"],
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    blocks = target.read_bytes()[16:]
    found = texels(astc_decoder(side)(blocks, width, height), width, height)
    return signal_to_noise(found, image, 3), seconds, len(blocks)


def main() -> None:
    """Prints a table for each image."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--astcenc", metavar="PROGRAM", help="Arm's program, as a peer")
    parser.add_argument("images", type=Path, nargs="+", metavar="IMAGE")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    os.nice(5)
    for path in options.images:
        pixels = oiio.ImageBuf(str(path)).get_pixels("uint8")
        top, left = (max(0, (side - SIDE) // 2) for side in pixels.shape[:2])
        image = np.ascontiguousarray(pixels[top : top + SIDE, left : left + SIDE, :3])
        count = image.shape[0] * image.shape[1]
        runs: dict[str, Callable[[Path], tuple[float, float, int]]] = {}
        for name in TEXEL_FORMATS:
            if name in DECODERS or TEXEL_FORMATS[name].is_transcoded:
                runs[name] = partial(measured, image, name)
        if options.astcenc:
            for side in (4, 6, 8):
                runs[f"astc-{side}x{side} by astcenc"] = partial(peer, options.astcenc, image, side)
        best: dict[str, tuple[float, float, int]] = {}
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(ROUNDS):
                for name, run in runs.items():
                    found = run(Path(folder))
                    if name not in best or found[1] < best[name][1]:
                        best[name] = found
            packed = {
                name: packed_size(image, name, Path(folder))
                for name in runs
                if name in TEXEL_FORMATS and not TEXEL_FORMATS[name].is_shared
            }
        rows = []
        for name, (decibels, seconds, size) in best.items():
            speed, kib = f"{count / 1e6 / seconds:.1f}", f"{size / 1024:.0f}"
            smaller = f"{packed[name] / 1024:.0f}" if name in packed else ""
            bits = f"{8 * size / count:.2f}"
            rows.append([name, bits, f"{decibels:.2f}", speed, kib, smaller])
        head = ("format", "bits a texel", "PSNR, dB", "Mtexel a CPU s", "KiB", "with zstd")
        title = f"{path.name}, {image.shape[1]} x {image.shape[0]}"
        report.table(title, head, rows, path.stem)
    report.write(options.json)


if __name__ == "__main__":
    main()
