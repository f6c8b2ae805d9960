# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares image resizing with other libraries: time and accuracy.

Usage: scripts/run python3 bench/images/compare.py [--rounds N] [--side N] [--json FILE]

Other libraries are Pillow, OpenImageIO, libvips (pyvips) and OpenCV, as far as this Python can
import them; all have one thread, and work on floats. Times are the least of rounds in turns, where
a library implements the filter of that name: some have another box, or enlarge by another filter.
"""

import argparse
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from bench.peers.resizers import Resize, found
from bench.report import Report, add_json_option

# Channels, and the new side by the old one.
WORK = ((1, 1 / 4), (4, 1 / 4), (4, 2 / 3), (4, 3 / 2))
TIMED = ("box", "tent", "mitchell", "lanczos3", "radial3")
CLOSED_FORMS = ("box", "tent", "mitchell", "lanczos3")
SAME = 0.01  # Largest difference from the definition for a library's time to count.
EDGE = 12  # New pixels, whose filters reach over the edge: libraries differ there.
OURS_ONLY = ("least-squares",)


def main() -> None:
    """Runs everything."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--side", type=int, default=2048)
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    libraries = found()
    time_all(report, libraries, options.side, options.rounds)
    accuracy(report, libraries)
    report.finish(options.json)


def time_all(
    report: Report, libraries: dict[str, tuple[Resize, frozenset[str]]], side: int, rounds: int
) -> None:
    """Measures every library with every filter that it has."""
    random = np.random.default_rng(0)
    rows, ratios = [], {}
    for channels, factor in WORK:
        image = random.random((side, side, channels), np.float32)
        target = round(side * factor)
        work: dict[tuple[str, str], Callable[[], Any]] = {
            (filter, name): partial(resize, image, target, target, filter)
            for filter in (*TIMED, *OURS_ONLY)
            for name, (resize, filters) in libraries.items()
            if filter in filters and does_it(resize, filter, factor)
        }
        least = fastest(work, rounds)
        for filter in (*TIMED, *OURS_ONLY):
            own = least[filter, "prefilter"]
            cells = []
            for name in libraries:
                seconds = least.get((filter, name))
                cells.append("" if seconds is None else f"{1000 * seconds:.1f}")
                if seconds is not None and name != "prefilter":
                    ratios[channels, factor, filter, name] = own / seconds
            rows.append((f"{channels} x {side}^2 to {target}^2, {filter}", *cells))
    report.table("Least milliseconds of one thread", ("work", *libraries), rows, "times")
    for name in libraries:
        shares = [ratio for key, ratio in ratios.items() if key[3] == name]
        if shares:
            report.note(
                f"Of {name}'s time: {min(shares):.2f} to {max(shares):.2f}, "
                f"{np.exp(np.mean(np.log(shares))):.2f} on geometric average"
            )


def does_it(resize: Resize, filter: str, factor: float) -> bool:
    """Tells whether a library implements the named filter, and not something quicker."""
    if filter not in CLOSED_FORMS:
        return True
    return definition_error(resize, filter, 192, round(192 * factor)) < SAME


def fastest(work: dict[Any, Callable[[], Any]], rounds: int) -> dict[Any, float]:
    """Returns the least times of work that is done in turns."""
    least = dict.fromkeys(work, np.inf)
    for number in range(rounds):
        for key, do in work.items():
            began = time.perf_counter()
            do()
            least[key] = min(least[key], time.perf_counter() - began)
        print(f"round {number + 1} of {rounds}", file=sys.stderr, flush=True)
    return least


def accuracy(report: Report, libraries: dict[str, tuple[Resize, frozenset[str]]]) -> None:
    """Compares with float64 sums of the filters' closed forms, away from the edges."""
    rows = []
    for target in (48, 128, 288):
        for filter in CLOSED_FORMS:
            errors = [
                f"{definition_error(resize, filter, 192, target):.0e}" if filter in filters else ""
                for resize, filters in libraries.values()
            ]
            rows.append((f"192^2 to {target}^2, {filter}", *errors))
    report.table(
        "Largest difference from the filter's definition, away from the edges",
        ("work", *libraries),
        rows,
        "differences",
    )


def definition_error(resize: Resize, filter: str, size: int, target: int) -> float:
    """Returns the largest difference from float64 sums of the closed form, for random values."""
    image = np.random.default_rng(1).random((size, size, 1), np.float32)
    weights = dense(filter, size, target)
    exact = weights @ image[..., 0].astype(float) @ weights.T
    inner = np.s_[EDGE:-EDGE, EDGE:-EDGE]
    return float(abs(resize(image, target, target, filter)[..., 0] - exact)[inner].max())


def dense(filter: str, size: int, target: int) -> NDArray[np.float64]:
    """The weights of all pixels for each new one, by closed forms."""
    ratio = size / target
    pixel = np.arange(size)
    center = (np.arange(target)[:, None] + 0.5) * ratio
    if filter == "box":
        low = np.maximum(pixel, center - ratio / 2)
        weights = np.maximum(0.0, np.minimum(pixel + 1, center + ratio / 2) - low)
    else:
        x = abs(pixel + 0.5 - center) / max(1.0, ratio)
        cubic = np.where(
            x < 1,
            (7 * x**3 - 12 * x**2 + 16 / 3) / 6,
            np.where(x < 2, (-7 / 3 * x**3 + 12 * x**2 - 20 * x + 32 / 3) / 6, 0.0),
        )
        windowed = np.where(x < 3, np.sinc(x) * np.sinc(x / 3), 0.0)
        tent = np.maximum(0.0, 1 - x)
        weights = {"tent": tent, "mitchell": cubic, "lanczos3": windowed}[filter]
    return weights / weights.sum(axis=1, keepdims=True)


if __name__ == "__main__":
    main()
