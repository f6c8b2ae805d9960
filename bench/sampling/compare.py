# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares samples by tables with trilinear ones in throughput, on one thread.

Usage: python3 -m bench.sampling.compare [--rounds N] [--samples N] [--json FILE]

Runs build/bench/sampling_bench, which docs/benchmarks/sampling.md says how to build. The criteria
are of the medians at 8 texels: at least 3 times OpenImageIO's throughput, and half of what
trilinear interpolation reaches that is written by hand. Ends with status 1 where one does not hold.
"""

import argparse
import subprocess
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from bench.report import Report, add_json_option

PROGRAM = Path(__file__).resolve().parents[2] / "build" / "bench" / "sampling_bench"
OURS, WRITTEN, OPENIMAGEIO = "8 texels", "trilinear, by hand", "OpenImageIO"
BARS = {OPENIMAGEIO: 3.0, WRITTEN: 0.5}


@dataclass(frozen=True)
class Run:
    """A line of sampling_bench; rates in Msamples/s."""

    texels: str
    places: str
    sampler: str
    median: float
    least: float
    most: float
    peak_mib: float
    difference: float


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=31, help="how often (default: %(default)s)")
    parser.add_argument(
        "--samples", type=int, default=2**18, help="of a round (default: %(default)s)"
    )
    add_json_option(parser)
    options = parser.parse_args()
    words = [PROGRAM, "--rounds", str(options.rounds), "--samples", str(options.samples)]
    found = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True).stdout
    cells = [line.split("\t") for line in found.splitlines()]
    runs = [Run(*line[:3], *map(float, line[3:])) for line in cells]
    report = Report()
    for (texels, places), group in groupby(runs, key=lambda run: (run.texels, run.places)):
        compare(report, f"{texels}, {places}", list(group))
    if not any(run.sampler == OPENIMAGEIO for run in runs):
        report.note("OpenImageIO is not measured: its library was not found")
    report.finish(options.json)


def compare(report: Report, title: str, runs: list[Run]) -> None:
    """One kind of texels and places."""
    of_peers = {run.sampler: run for run in runs if run.sampler in BARS}
    head = (
        "sampler", "median Msamples/s", "least - most", *(f"/ {name}" for name in of_peers),
        "peak MiB", "RMS from by hand",
    )  # fmt: skip
    rows = [
        (
            run.sampler,
            f"{run.median:.1f}",
            f"{run.least:.1f} - {run.most:.1f}",
            *(f"{run.median / peer.median:.2f}" for peer in of_peers.values()),
            f"{run.peak_mib:.1f}",
            f"{run.difference:.1e}",
        )
        for run in runs
    ]
    report.table(title, head, rows)
    ours = next(run for run in runs if run.sampler == OURS)
    for name, peer in of_peers.items():
        ratio, bar = ours.median / peer.median, BARS[name]
        claim = f"{title}: {ratio:.2f} times the throughput of {name}, at least {bar}"
        report.verdict(ratio >= bar, claim)


if __name__ == "__main__":
    main()
