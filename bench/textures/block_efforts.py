# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the gain and the cost of the efforts of block compression, beside Intel's BC7 encoder.

Usage: python3 bench/textures/block_efforts.py IMAGE...

The package, OpenImageIO (2.5 or later) and PyPI's package ispc-texcomp must be importable. Images
are read as bytes without their alpha. Level 0 is the middle, 512 x 512 texels; coarse levels are
box-filtered from the whole image. The peak signal-to-noise ratio is over red, green and blue, or
over the channels of the format. Times are for level 0 on one thread: processor time, the least of
three interleaved rounds.
"""

import argparse
import io
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.textures.bptc_peers import SIDE, Pixels, decoded, intel

ROUNDS = 3
COARSE = (64, 16, 4)
EFFORTS = ("fast", "normal", "best")
FORMATS = ("bc1-rgb", "bc4", "bc5", "bc7", "etc2-rgb", "astc-4x4", "uastc")
CHANNELS = {"bc4": 1, "bc5": 2}
PROFILES = ("ultrafast", "fast", "slow")

Coded = tuple[float, Pixels]
"""Processor time, and the pixels read back from the file."""


def by_package(texture_format: str, effort: str) -> Callable[[Pixels], Coded]:
    """Returns an encoder that writes and reads back a file of the package."""

    def through(image: Pixels) -> Coded:
        file = io.BytesIO()
        began = time.process_time()
        prefilter.write_ktx2(file, [image], format=texture_format, effort=effort, threads=1)
        seconds = time.process_time() - began
        file.seek(0)
        levels, _ = prefilter.read_ktx2(file)
        return seconds, levels[0]

    return through


def by_intel(profile: str, folder: Path) -> Callable[[Pixels], Coded]:
    """Returns an encoder by the peer, which needs sides divisible by four."""
    compress = intel("bc7", profile)

    def through(image: Pixels) -> Coded:
        began = time.process_time()
        blocks = compress(image)
        seconds = time.process_time() - began
        return seconds, decoded(blocks, "bc7", image.shape, folder)

    return through


def decibels(found: Pixels, image: Pixels, channels: int) -> float:
    """The ratio of peak to noise."""
    difference = found[..., :channels].astype(float) - image[..., :channels]
    return float(10 * np.log10(255**2 / max(np.mean(difference**2), 1e-9)))


def coarse_levels(image: Pixels) -> list[Pixels]:
    """Returns the levels in COARSE of an image whose sides are powers of two."""
    levels = prefilter.mipmaps(image, filter="box")
    return [level for level in levels if level.shape[0] in COARSE]


def measure(image: Pixels, folder: Path) -> list[list[str]]:
    """A row for each format and effort, and for each profile of the peer."""
    side = image.shape[0]
    first = (side - SIDE) // 2
    middle = np.ascontiguousarray(image[first : first + SIDE, first : first + SIDE])
    encoders = {(name, effort): by_package(name, effort) for name in FORMATS for effort in EFFORTS}
    encoders |= {("bc7", f"Intel, {each}"): by_intel(each, folder) for each in PROFILES}
    least = dict.fromkeys(encoders, float("inf"))
    found: dict[tuple[str, str], Pixels] = {}
    for number in range(ROUNDS):
        for key, through in encoders.items():
            # Slow encoders run once.
            if number == 0 or least[key] < 1.0:
                seconds, found[key] = through(middle)
                least[key] = min(least[key], seconds)
    rows = []
    for (name, effort), through in encoders.items():
        channels = CHANNELS.get(name, 3)
        values = [decibels(found[name, effort], middle, channels)]
        values += [decibels(through(level)[1], level, channels) for level in coarse_levels(image)]
        speed = least[name, effort] / (SIDE * SIDE / 1e6)
        rows.append([name, effort, f"{speed:.3f}", *(f"{value:.2f}" for value in values)])
    return sorted(rows, key=lambda row: FORMATS.index(row[0]))


def main() -> None:
    """Prints a table for each image."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("images", type=Path, nargs="+", metavar="IMAGE")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    head = ["format", "effort", "s a Mtexel", f"{SIDE}", *map(str, COARSE)]
    for path in options.images:
        image = np.ascontiguousarray(oiio.ImageBuf(str(path)).get_pixels("uint8")[..., :3])
        with tempfile.TemporaryDirectory() as folder:
            rows = measure(image, Path(folder))
        report.table(f"{path.stem}: dB", head, rows, path.stem)
    report.write(options.json)


if __name__ == "__main__":
    main()
