# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures BC7 and BC6H against Intel's encoder: error, and processor time in turns.

Usage: python3 bench/textures/bptc_peers.py IMAGE...

The package, OpenImageIO (2.5 or later) and PyPI's package ispc-texcomp must be importable. Images
of bytes are compressed to BC7, without their alpha, and to BC1; images of floats to BC6H. Only the
middle 512 x 512 of a larger image is used. OpenImageIO decodes everything. Errors: for BC7 the peak
signal-to-noise ratio over red, green and blue; for BC6H the root mean square of log2 (found /
wanted), both plus a thousandth, and the share of channels that are wrong by more than a quarter.
Times are on one thread, the least of five interleaved rounds.
"""

import argparse
import os
import struct
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ispc_texcomp
import numpy as np
import OpenImageIO as oiio
import prefilter
from numpy.typing import NDArray
from prefilter import TEXEL_FORMATS

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option

Pixels = NDArray[Any]

ROUNDS = 5
SIDE = 512
DARKEST = 1e-3
DDS_HEADER_BYTES = 148


def ours(texture_format: str, folder: Path) -> Callable[[Pixels], bytes]:
    """Blocks by the package."""
    path = folder / "ours.dds"

    def compress(image: Pixels) -> bytes:
        prefilter.write_dds(path, [image[::-1]], format=texture_format, threads=1)
        return path.read_bytes()[DDS_HEADER_BYTES:]

    return compress


def intel(texture_format: str, profile: str) -> Callable[[Pixels], bytes]:
    """Blocks by the peer."""
    compress_blocks = getattr(ispc_texcomp, f"compress_blocks_{texture_format}")
    settings_class = {
        "bc6h": ispc_texcomp.BC6HEncSettings,
        "bc7": ispc_texcomp.BC7EncSettings,
    }[texture_format]
    settings = settings_class.from_profile(profile)

    def compress(image: Pixels) -> bytes:
        height, width, _ = image.shape
        kind = np.float16 if texture_format == "bc6h" else np.uint8
        rgba = np.full((height, width, 4), 1 if texture_format == "bc6h" else 255, kind)
        rgba[..., :3] = image
        surface = ispc_texcomp.RGBASurface(rgba.tobytes(), width, height, rgba[0].nbytes)
        return bytes(compress_blocks(surface, settings))

    return compress


def decoded(blocks: bytes, texture_format: str, shape: tuple[int, ...], folder: Path) -> Pixels:
    """Returns the pixels that OpenImageIO reads, the top row first."""
    height, width = shape[:2]
    code = TEXEL_FORMATS[texture_format].dxgi[0]
    header = b"DDS " + struct.pack("<7I44x", 124, 0x81007, height, width, len(blocks), 0, 1)
    header += struct.pack("<2I4s20x", 32, 4, b"DX10") + struct.pack("<I16x", 0x1000)
    header += struct.pack("<5I", code, 3, 0, 1, 3)
    path = folder / "decoded.dds"
    path.write_bytes(header + blocks)
    file = oiio.ImageInput.open(str(path))
    kind = "float" if texture_format == "bc6h" else "uint8"
    return np.asarray(file.read_image(kind)).reshape(height, width, -1)[..., :3]


def errors(found: Pixels, image: Pixels) -> tuple[float, ...]:
    """The ratio in decibels for images of bytes; the two errors for images of floats."""
    if image.dtype == np.uint8:
        return (float(10 * np.log10(255**2 / np.mean((found.astype(float) - image) ** 2))),)
    ratio = np.log2((found + DARKEST) / (image + DARKEST))
    return float(np.sqrt(np.mean(ratio**2))), float(np.mean(np.abs(ratio) > np.log2(1.25)))


def middle(path: Path) -> Pixels:
    """At most SIDE x SIDE texels: bytes, or floats that half floats hold and that are positive."""
    buffer = oiio.ImageBuf(str(path))
    kind = "uint8" if buffer.spec().format == oiio.UINT8 else "float"
    pixels = buffer.get_pixels(kind)[..., :3]
    top, left = (max(0, (side - SIDE) // 2) for side in pixels.shape[:2])
    cut = pixels[top : top + SIDE, left : left + SIDE]
    cut = np.ascontiguousarray(cut[: len(cut) // 4 * 4, : cut.shape[1] // 4 * 4])
    if kind == "float":
        cut = np.clip(cut, 0, 65504).astype(np.float16).astype(np.float32)
    return cut


def measure(image: Pixels, folder: Path) -> list[list[str]]:
    """Returns a row for each encoder."""
    encoders: dict[str, tuple[str, Callable[[Pixels], bytes]]]
    if image.dtype == np.uint8:
        encoders = {"bc1": ("bc1", ours("bc1", folder)), "bc7": ("bc7", ours("bc7", folder))}
        profiles, target = ("fast", "basic", "slow"), "bc7"
    else:
        encoders = {"bc6h": ("bc6h", ours("bc6h", folder))}
        profiles, target = ("fast", "basic", "slow", "veryslow"), "bc6h"
    for profile in profiles:
        encoders[f"{target}, Intel, {profile}"] = (target, intel(target, profile))
    least = dict.fromkeys(encoders, float("inf"))
    blocks = {}
    for _ in range(ROUNDS):
        for name, (_, encode) in encoders.items():
            began = time.process_time()
            blocks[name] = encode(image)
            least[name] = min(least[name], time.process_time() - began)
    rows = []
    for name, (texture_format, _) in encoders.items():
        found = decoded(blocks[name], texture_format, image.shape, folder)
        speed = image.shape[0] * image.shape[1] / 1e6 / least[name]
        values = errors(found, image)
        is_bytes = len(values) == 1
        shown = [f"{values[0]:.2f}"] if is_bytes else [f"{values[0]:.4f}", f"{values[1]:.2%}"]
        rows.append([name, *shown, f"{speed:.2f}"])
    return rows


def main() -> None:
    """Prints a table for each image."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("images", type=Path, nargs="+", metavar="IMAGE")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    os.nice(5)
    for path in options.images:
        image = middle(path)
        is_bytes = image.dtype == np.uint8
        measures = ["PSNR, dB"] if is_bytes else ["log2, RMS", "off by over 1/4"]
        with tempfile.TemporaryDirectory() as folder:
            rows = measure(image, Path(folder))
        title = f"{path.name}, {image.shape[1]} x {image.shape[0]}"
        report.table(title, ("encoder", *measures, "Mtexel a CPU s"), rows, path.stem)
    report.write(options.json)


if __name__ == "__main__":
    main()
