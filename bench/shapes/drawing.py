# SPDX-License-Identifier: GPL-3.0-or-later

"""Times a drawing as a large image, in turns by one thread and by more.

Usage: scripts/run python3 bench/shapes/drawing.py [DRAWING.svg] [--size N] [--filter NAME]
    [--rounds N]

Without a drawing it takes the tiger gathered in ../shared beside the checkout. The criterion: with
Mitchell's filter at 4096 x 4096 pixels it takes less than a second on two threads.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path

import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option

TIGER = Path(__file__).resolve().parents[3] / "shared" / "data" / "svg" / "Ghostscript_Tiger.svg"
BAR = 1.0
THREADS = (1, 2)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("drawing", nargs="?", type=Path, default=TIGER)
    parser.add_argument("--size", type=int, default=4096, help="pixels (default: %(default)s)")
    parser.add_argument("--filter", default="mitchell", help="(default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="how often (default: %(default)s)")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    began = time.perf_counter()
    shapes = prefilter.read_svg(options.drawing).shapes_for(options.size, options.size)
    report.note(f"{len(shapes)} shapes, read in {time.perf_counter() - began:.3f} s")
    found: dict[int, list[float]] = {threads: [] for threads in THREADS}
    for _ in range(options.rounds):
        for threads, seconds in found.items():
            began = time.perf_counter()
            prefilter.rasterize(
                shapes, options.size, options.size,
                filter=options.filter, overlap="cover", threads=threads,
            )  # fmt: skip
            seconds.append(time.perf_counter() - began)
    rows = [
        (str(threads), f"{min(seconds):.3f}", f"{statistics.median(seconds):.3f}")
        for threads, seconds in found.items()
    ]
    title = f"{options.drawing.name}, {options.size} x {options.size}, {options.filter}"
    report.table(title, ("threads", "shortest s", "median s"), rows, "times")
    shortest = min(found[max(THREADS)])
    report.verdict(shortest < BAR, f"{shortest:.2f} s on {max(THREADS)} threads, less than {BAR}")
    report.finish(options.json)


if __name__ == "__main__":
    main()
