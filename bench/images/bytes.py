# SPDX-License-Identifier: GPL-3.0-or-later

"""Times reductions of bytes to a quarter by Lanczos 3, in turns with other libraries.

Usage: scripts/run python3 bench/images/bytes.py [--rounds N] [--side N] [--json FILE]

The others are libvips (pyvips), as far as this Python can import it, and fast_image_resize and
pic-scale, if PREFILTER_RUST_RESIZERS names the library that `cargo build --release` makes
of bench/peers/rust_resizers. Times are processor seconds, medians over the rounds; all have one
thread. The second table has the differences from rounded float64 sums, in steps of bytes.
Fails where a criterion does not hold.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from bench.images.compare import EDGE, dense
from bench.peers.byte_resizers import Resize, found
from bench.report import Report, add_json_option

SHRINK = 4
SMALL = 256
# Name, channels, and whether in linear light.
WORK = (("RGB", 3, False), ("RGBA", 4, False), ("RGB, linear light", 3, True))
MOST = {"RGB": 1.5, "RGBA": 1.5, "RGB, linear light": 0.25}
"""Greatest processor time, as a share of libvips's."""
FILTERS = ("lanczos3", "radial3")
MOST_RADIAL = 2.0


def main() -> None:
    """Runs everything."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--side", type=int, default=4096)
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    libraries = found()
    time_all(report, libraries, options.side, options.rounds)
    time_radial(report, options.side // 2, options.rounds)
    accuracy(report, libraries)
    report.finish(options.json)


def noise(side: int, channels: int) -> NDArray[np.uint8]:
    """Random bytes; alpha is never near 0, where colors are mostly rounding."""
    image = np.random.default_rng(0).integers(0, 256, (side, side, channels), np.uint8)
    if channels == 4:
        image[..., 3] |= 64
    return image


def time_all(report: Report, libraries: dict[str, Resize], side: int, rounds: int) -> None:
    """Measures every library."""
    target = side // SHRINK
    rows = []
    for title, channels, srgb in WORK:
        image = noise(side, channels)
        seconds: dict[str, list[float]] = {name: [] for name in libraries}
        for number in range(rounds):
            for name, resize in libraries.items():
                began = time.process_time()
                resize(image, target, target, srgb)
                seconds[name].append(time.process_time() - began)
            print(f"{title}: round {number + 1} of {rounds}", file=sys.stderr, flush=True)
        medians = {name: statistics.median(found) for name, found in seconds.items()}
        rows.append((title, *(f"{1000 * one:.0f}" for one in medians.values())))
        if "libvips" in medians:
            share = medians["prefilter"] / medians["libvips"]
            report.verdict(
                share <= MOST[title],
                f"{title}: {share:.2f} of libvips's time; {MOST[title]} are allowed",
            )
    title = f"Milliseconds of one thread, {side}^2 to {target}^2 by Lanczos 3"
    report.table(title, ("work", *libraries), rows, "times")


def time_radial(report: Report, side: int, rounds: int) -> None:
    """Compares our filters with each other, on floats."""
    rows = []
    for channels, factor in ((1, 1 / 4), (4, 1 / 4), (4, 2 / 3), (4, 3 / 2)):
        image = np.random.default_rng(0).random((side, side, channels), np.float32)
        target = round(side * factor)
        seconds: dict[str, list[float]] = {filter: [] for filter in FILTERS}
        for _ in range(rounds):
            for filter in FILTERS:
                began = time.process_time()
                prefilter.resize(image, target, target, filter=filter, threads=1)
                seconds[filter].append(time.process_time() - began)
        medians = [statistics.median(seconds[filter]) for filter in FILTERS]
        title = f"{channels} x {side}^2 to {target}^2"
        share = medians[1] / medians[0]
        rows.append((title, *(f"{1000 * one:.0f}" for one in medians), f"{share:.1f}"))
        report.verdict(
            share <= MOST_RADIAL,
            f"{title}: radial3 takes {share:.1f} times as long as lanczos3; {MOST_RADIAL} are "
            "allowed",
        )
    report.table("Milliseconds of one thread, floats", ("work", *FILTERS, "ratio"), rows, "radial")


def accuracy(report: Report, libraries: dict[str, Resize]) -> None:
    """Compares with float64 sums of the filter's closed form, away from the edges."""
    target = SMALL // SHRINK
    weights = dense("lanczos3", SMALL, target)
    inner = np.s_[EDGE:-EDGE, EDGE:-EDGE]
    rows = []
    for title, channels, srgb in WORK:
        image = noise(SMALL, channels)
        exact = np.einsum("jy,ix,yxc->jic", weights, weights, as_light(image, srgb), optimize=True)
        exact = as_bytes(exact, srgb)
        cells = []
        for resize in libraries.values():
            off = abs(resize(image, target, target, srgb) - exact)[inner]
            cells.append(f"{np.mean(off):.2f}, {off.max():.1f}")
        rows.append((title, *cells))
    title = "Mean and largest difference from what bytes ought to be before they are rounded"
    report.table(title, ("work", *libraries), rows, "differences")


def as_light(image: NDArray[np.uint8], srgb: bool) -> NDArray[Any]:
    """Returns the filter's input: linear light, or values from 0 to 1."""
    light = image / 255
    if srgb:
        light = np.where(light <= 0.04045, light / 12.92, ((light + 0.055) / 1.055) ** 2.4)
    if image.shape[2] == 4:
        light[..., :3] *= light[..., 3:]
    return light


def as_bytes(light: NDArray[Any], srgb: bool) -> NDArray[Any]:
    """Encodes light in steps of bytes, without rounding."""
    if light.shape[2] == 4:
        light[..., :3] /= light[..., 3:]
    light = light.clip(0, 1)
    if srgb:
        light = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return 255 * light


if __name__ == "__main__":
    main()
