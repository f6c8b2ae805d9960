# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawings that could hang a rasterizer: the time and memory of each, and how both grow.

Usage: scripts/run python3 -m bench.vectors.hang [PATTERN...] [--limit SECONDS] [--json FILE]

Each drawing is made in a process of its own at several counts, each twice the one before, up to the
count in its name, and is stopped after --limit seconds of processor time. The exponent compares the
processor times of the last two counts that ended. The time is of rasterize alone; making the
shapes in Python has a column of its own. Memory counts beyond a process that draws a single
triangle. Ends with status 1 where a criterion does not hold.
"""

import argparse
import json
import math
import resource
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import prefilter
from numpy.typing import NDArray

from bench.report import Report, add_json_option

SIDE = 1024
MOST_SECONDS = 2.0
MOST_MIB = 200.0
MOST_EXPONENT = 1.25  # allows for n log n, and for the timer's error
Floats = NDArray[np.float64]
Shapes = list[prefilter.Shape]


@dataclass(frozen=True)
class Case:
    """A kind of drawing, with the counts of elements to draw."""

    make: Callable[[int, np.random.Generator], Shapes]
    counts: tuple[int, ...]
    filter: str = "box"


def shape(contours: list[Floats], rule: str = "nonzero", color: object = (1.0,)) -> prefilter.Shape:
    """Returns polygons as a shape."""
    made = prefilter.Shape(rule, color)
    for points in contours:
        made.add_polygon(points)
    return made


def blob(random: np.random.Generator, radius: float, jitter: float) -> Floats:
    """Returns the points of a closed chain of quadratic curves, all near a circle."""
    turns = np.arange(48) / 48 * 2 * np.pi
    radii = radius + random.normal(0.0, jitter, 48)
    return SIDE / 2 + radii[:, None] * np.stack([np.cos(turns), np.sin(turns)], 1)


def curved(points: Floats, color: tuple[float, ...]) -> prefilter.Shape:
    """Returns a closed chain of quadratic curves through every other point's neighbors."""
    made = prefilter.Shape(color=color)
    made.move_to(*points[0])
    count = len(points)
    for i in range(1, count, 2):
        made.curve_to(points[i], points[(i + 1) % count])
    made.close()
    return made


def blobs(count: int, random: np.random.Generator) -> Shapes:
    """Near-equal outlines over each other, of an alpha of 0.1."""
    colors = 0.1 * random.random((count, 3))
    return [curved(blob(random, 0.4 * SIDE, 2.0), (*color, 0.1)) for color in colors]


def far_blobs(count: int, random: np.random.Generator) -> Shapes:
    """Blobs as far from each other as they are large."""
    colors = 0.1 * random.random((count, 3))
    return [
        curved(blob(random, r, 8.0), (*color, 0.1))
        for color, r in zip(colors, random.uniform(0.05, 0.5, count) * SIDE, strict=True)
    ]


def opaque(count: int, random: np.random.Generator) -> Shapes:
    """Large opaque polygons over each other."""
    return [
        shape([random.random((5, 2)) * SIDE], "evenodd", (*random.random(3), 1.0))
        for _ in range(count)
    ]


def cubics(count: int, random: np.random.Generator) -> Shapes:
    """One contour of random cubic curves."""
    made = prefilter.Shape()
    made.move_to(*(random.random(2) * SIDE))
    for points in random.random((count, 6)) * SIDE:
        made.curve_to(*points.reshape(3, 2))
    made.close()
    return [made]


def discs(count: int, random: np.random.Generator) -> Shapes:
    """Discs in one shape."""
    made = prefilter.Shape()
    for x, y, r in random.random((count, 3)) * (SIDE, SIDE, 80):
        made.move_to(x + r, y)
        for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
            end = (x, y + b * r) if a == b else (x + a * r, y)
            made.conic_to(x + a * r, y + b * r, math.sqrt(0.5), *end)
    return [made]


def rectangles(count: int, random: np.random.Generator) -> Shapes:
    """Rectangles in one shape."""
    boxes = np.concatenate([random.random((count, 2)) * SIDE, random.random((count, 2)) * 200], 1)
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    return [shape([b[:2] + corners * b[2:] for b in boxes])]


def line_quads(count: int, random: np.random.Generator) -> list[Floats]:
    """Random lines, a pixel wide."""
    quads = []
    for a, b in random.random((count, 2, 2)) * SIDE:
        along = (b - a) / max(np.hypot(*(b - a)), 1e-9)
        across = 0.5 * np.array([-along[1], along[0]])
        quads.append(np.array([a - across, b - across, b + across, a + across]))
    return quads


def lines(count: int, random: np.random.Generator) -> Shapes:
    """Lines in one shape."""
    return [shape(line_quads(count, random))]


def line_shapes(count: int, random: np.random.Generator) -> Shapes:
    """Lines, a shape each, opaque and of many colors."""
    return [shape([quad], color=(*random.random(3), 1.0)) for quad in line_quads(count, random)]


def scribble(count: int, random: np.random.Generator, width: float = 3.0) -> Shapes:
    """A stroke along random points."""
    path = prefilter.Shape()
    path.move_to(*(random.random(2) * SIDE))
    for point in random.random((count, 2)) * SIDE:
        path.line_to(*point)
    return [path.stroked(width)]


def wide_scribble(count: int, random: np.random.Generator) -> Shapes:
    """The same lines with a pen as wide as the image."""
    return scribble(count, random, SIDE)


def equal_triangles(count: int, random: np.random.Generator) -> Shapes:
    """Copies of one translucent triangle."""
    points = random.random((3, 2)) * SIDE
    return [shape([points], color=(0.1, 0.0, 0.0, 0.1)) for _ in range(count)]


def tiny_triangles(count: int, random: np.random.Generator) -> Shapes:
    """Translucent triangles within one pixel."""
    points = SIDE // 2 + random.random((count, 3, 2))
    return [shape([p], color=(0.1, 0.0, 0.0, 0.1)) for p in points]


def doubled(most: int, least: int = 0) -> tuple[int, ...]:
    """Returns counts up to one, each twice the one before."""
    counts = [most]
    while counts[0] // 2 >= max(least, most // 8):
        counts.insert(0, counts[0] // 2)
    return tuple(counts)


CASES = {
    "blobs": Case(blobs, (80, *doubled(5000))),
    "blobs-mitchell": Case(blobs, doubled(5000), "mitchell"),
    "far-blobs": Case(far_blobs, doubled(5000)),
    "opaque": Case(opaque, doubled(5000)),
    "cubics": Case(cubics, doubled(1000)),
    "discs": Case(discs, doubled(2000)),
    "rectangles": Case(rectangles, doubled(3000)),
    "lines": Case(lines, doubled(10000)),
    "line-shapes": Case(line_shapes, doubled(10000)),
    "scribble": Case(scribble, doubled(5000)),
    "wide-scribble": Case(wide_scribble, doubled(1000)),
    "equal-triangles": Case(equal_triangles, doubled(4000)),
    "tiny-triangles": Case(tiny_triangles, doubled(4000)),
}


def processor_seconds() -> float:
    """Returns the processor time of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def draw(name: str, count: int) -> None:
    """Draws a case, and prints its time and memory; a count of 0 is a triangle alone."""
    before = processor_seconds()
    case = CASES[name]
    random = np.random.default_rng(31)
    if count == 0:
        made = [shape([random.random((3, 2)) * SIDE], color=(1.0, 0.0, 0.0, 1.0))]
    else:
        made = case.make(count, random)
    between = processor_seconds()
    prefilter.rasterize(made, SIDE, SIDE, filter=case.filter)
    seconds = processor_seconds() - between
    mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"making": between - before, "seconds": seconds, "mib": mib}))


def measured(name: str, count: int, limit: float) -> dict[str, float] | None:
    """Returns the cost of a drawing in its own process; None for more than the limit."""
    bound = math.ceil(limit)
    code = f"from bench.vectors import hang; hang.draw({name!r}, {count})"
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (bound, bound)),
    )
    if done.returncode > 0:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout) if done.returncode == 0 else None


def rows_of(name: str, limit: float, report: Report) -> list[list[str]]:
    """Measures a drawing at each of its counts, and judges the last."""
    alone = measured(name, 0, limit)
    least_mib = alone["mib"] if alone else 0.0
    rows, last = [], None
    counts = CASES[name].counts
    for count in counts:
        found = measured(name, count, limit)
        exponent = "-"
        if found and last:
            growth = math.log(found["seconds"] / last[1]) / math.log(count / last[0])
            exponent = f"{growth:.2f}"
        if found is None:
            rows.append([name, str(count), "-", f"over {limit:g}", "-", "-"])
            report.verdict(False, f"{name}: {count} end within {limit:g} s")
            break
        mib = found["mib"] - least_mib
        times = [f"{found['making']:.2f}", f"{found['seconds']:.2f}"]
        rows.append([name, str(count), *times, f"{mib:.0f}", exponent])
        last = (count, found["seconds"])
        if count == counts[-1]:
            report.verdict(
                found["seconds"] <= MOST_SECONDS and mib <= MOST_MIB,
                f"{name}: {count} take {found['seconds']:.2f} processor s and {mib:.0f} MiB",
            )
            if exponent != "-" and found["seconds"] > 0.5:
                report.verdict(
                    float(exponent) <= MOST_EXPONENT, f"{name}: time grows by n^{exponent}"
                )
    return rows


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("patterns", nargs="*", metavar="PATTERN", help=", ".join(CASES))
    parser.add_argument("--limit", type=float, default=12.0, help="seconds (default: %(default)s)")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    rows = []
    for name in options.patterns or CASES:
        rows += rows_of(name, options.limit, report)
    head = ["drawing", "count", "making s", "processor s", "MiB", "exponent"]
    report.table(f"{SIDE} x {SIDE}", head, rows, "hang")
    report.finish(options.json)


if __name__ == "__main__":
    main()
