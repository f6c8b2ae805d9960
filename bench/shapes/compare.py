# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares rasterizers in time, memory and error, and Prefilter's filters with each other.

Usage: python3 -m bench.shapes.compare [PATTERN...] [--rounds N] [--json FILE]

Runs build/bench/shapes_bench, which docs/benchmarks/shapes.md says how to build. The criteria are
of the box filter's shortest times: shares of AGG's, and less than any other rasterizer takes at the
tolerance where its error is 1/255; of the other filters and the wavelets: multiples of the box.
Ends with status 1 where one does not hold.
"""

import argparse
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.report import Report, add_json_option

PROGRAM = Path(__file__).resolve().parents[2] / "build" / "bench" / "shapes_bench"
OURS, AGG = "Prefilter", "AGG"
AGG_BARS = {
    "fan": 0.15, "star": 0.25, "rings": 0.8, "glyphs": 0.5, "circle": 0.5, "disc": 0.15,
}  # fmt: skip
FILTER_BARS = {
    "tent": 1.5, "bspline2": 2.5, "mitchell": 4, "lanczos2": 4, "lanczos3": 7, "radial2": 4,
    "radial3": 8,
}  # fmt: skip
FILTER_PATTERN = "fan"
WAVELET_BAR = 3


@dataclass(frozen=True)
class Run:
    """A line of shapes_bench; times in microseconds."""

    pattern: str
    rasterizer: str
    fineness: float
    shortest: float
    median: float
    with_path: float
    peak_mib: float
    largest_error: float
    rms_error: float

    @property
    def is_default(self) -> bool:
        """Whether its tolerance of curves is the rasterizer's own."""
        return self.fineness == 1


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("patterns", nargs="*", metavar="PATTERN", help=", ".join(AGG_BARS))
    parser.add_argument("--rounds", type=int, default=200, help="how often (default: %(default)s)")
    add_json_option(parser)
    options = parser.parse_args()
    names = options.patterns or list(AGG_BARS)
    report = Report()
    for name in names:
        compare(report, name, measured([name], options.rounds))
    if not options.patterns or FILTER_PATTERN in names:
        compare_filters(report, measured(["--filters", FILTER_PATTERN], options.rounds))
    words = ["--filters", "--rasterizers", "box;wavelet", *names]
    compare_wavelets(report, measured(words, options.rounds))
    compare_seams(report)
    report.finish(options.json)


def printed(words: Sequence[str]) -> list[list[str]]:
    """Returns the cells of what shapes_bench prints."""
    found = subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, text=True, check=True)
    return [line.split("\t") for line in found.stdout.splitlines()]


def measured(words: Sequence[str], rounds: int) -> list[Run]:
    """Runs shapes_bench."""
    lines = printed([*words, "--rounds", str(rounds)])
    return [Run(*cells[:2], *map(float, cells[2:])) for cells in lines]


def compare(report: Report, pattern: str, runs: Sequence[Run]) -> None:
    """Ours beside the others on a pattern."""
    ours = next(run for run in runs if run.rasterizer == OURS)
    agg = next((run for run in runs if run.rasterizer == AGG and run.is_default), None)
    head = (
        "rasterizer", "tolerance", "shortest us", "median us", "with path us", "ours / it",
        "peak MiB", "largest error", "RMS error",
    )  # fmt: skip
    rows = [
        (
            run.rasterizer,
            "" if run.is_default else f"default / {run.fineness:.3g}",
            f"{run.shortest:.1f}",
            f"{run.median:.1f}",
            f"{run.with_path:.1f}",
            "" if run is ours else f"{ours.shortest / run.shortest:.2f}",
            f"{run.peak_mib:.1f}",
            f"{run.largest_error:.1e}",
            f"{run.rms_error:.1e}",
        )
        for run in runs
    ]
    report.table(pattern, head, rows)
    if agg is not None:
        share, bar = ours.shortest / agg.shortest, AGG_BARS[pattern]
        report.verdict(share <= bar, f"{pattern}: {share:.3f} of AGG's time, at most {bar}")
    others = [run for run in runs if not run.rasterizer.startswith(OURS)]
    for kind, group in (
        ("at its default tolerance", [run for run in others if run.is_default]),
        ("at the tolerance where its error is 1/255", near_exact(others)),
    ):
        if not group:
            continue
        fastest = min(group, key=lambda run: run.shortest)
        share = ours.shortest / fastest.shortest
        claim = f"{pattern}: {share:.3f} of the time of {fastest.rasterizer}, the fastest {kind}"
        if kind.startswith("at the tolerance"):
            report.verdict(share < 1, claim)
        else:
            report.note(claim)


def near_exact(runs: Sequence[Run]) -> list[Run]:
    """Runs at the finer tolerance where there are any, else all: lines need no tolerance."""
    finer = [run for run in runs if not run.is_default]
    return finer or list(runs)


def compare_filters(report: Report, runs: Sequence[Run]) -> None:
    """Our filters beside our box."""
    box = next(run for run in runs if run.rasterizer == "box")
    agg = next((run for run in runs if run.rasterizer == AGG), None)
    rows = [
        (run.rasterizer, f"{run.shortest:.1f}", f"{run.median:.1f}", multiple(run, box),
         multiple(run, agg) if agg is not None else "", f"{run.peak_mib:.1f}")
        for run in runs
        if run.rasterizer != "wavelet"
    ]  # fmt: skip
    head = ("filter", "shortest us", "median us", "box", AGG, "peak MiB")
    report.table(f"filters on {box.pattern}", head, rows, "filters")
    for run in runs:
        bar = FILTER_BARS.get(run.rasterizer)
        if bar is not None:
            claim = f"{run.rasterizer}: {multiple(run, box)} times box, at most {bar}"
            report.verdict(run.shortest <= bar * box.shortest, claim)


def compare_wavelets(report: Report, runs: Sequence[Run]) -> None:
    """The wavelets beside our box."""
    boxes = {run.pattern: run for run in runs if run.rasterizer == "box"}
    waves = [run for run in runs if run.rasterizer == "wavelet"]
    if not waves:
        return
    rows = [
        (run.pattern, f"{boxes[run.pattern].shortest:.1f}", f"{run.shortest:.1f}",
         multiple(run, boxes[run.pattern]), f"{run.largest_error:.1e}")
        for run in waves
    ]  # fmt: skip
    head = ("pattern", "box us", "wavelet us", "box", "largest error")
    report.table("wavelets", head, rows)
    for run in waves:
        claim = f"{run.pattern}: wavelets take {multiple(run, boxes[run.pattern])} times box"
        limit = WAVELET_BAR * boxes[run.pattern].shortest
        report.verdict(run.shortest <= limit, f"{claim}, at most {WAVELET_BAR}")


def multiple(run: Run, other: Run) -> str:
    """Returns the ratio of shortest times."""
    return f"{run.shortest / other.shortest:.2f}"


def compare_seams(report: Report) -> None:
    """The lowest value of abutting quads."""
    found = printed(["--seams"])
    report.table("64 abutting quads", ("rasterizer", "lowest of 255"), found, "abutting")
    report.verdict(float(dict(found)[OURS]) == 255, "no seam of abutting quads is seen")


if __name__ == "__main__":
    main()
