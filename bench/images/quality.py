# SPDX-License-Identifier: GPL-3.0-or-later

"""Shrinks pictures to a quarter and enlarges them again: remaining error, and ringing.

Usage: scripts/run python3 bench/images/quality.py [--json FILE]

The pictures are figure 1.8 as in the documentation, and the base colors of the models in
../shared/data/textured. Fails where a criterion does not hold.
"""

import argparse
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import prefilter
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs" / "pictures"))
from resize import drawn

from bench.report import Report, add_json_option
from bench.texture_files import textures

ROOT = Path(__file__).resolve().parents[2]
Array = NDArray[np.float32]

SHRINK = 4
LEAST_SQUARES = "least-squares"
RINGING = "least-squares, ringing"
QUALITY = ("box", "tent", "mitchell", "lanczos3", "radial3", RINGING, LEAST_SQUARES)
SHOWN = ("mitchell", "lanczos3", RINGING, LEAST_SQUARES)
ENLARGED_BY = ("tent", "mitchell", "lanczos3")


def main() -> None:
    """Runs everything."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    quality(report)
    report.finish(options.json)


def quality(report: Report) -> None:
    """Makes pictures smaller and enlarges them again."""
    rows, ringing_rows, beaten, rings = [], [], [], []
    for name, picture in pictures():
        errors = {}
        for filter, constrained in product(QUALITY, (False, True)):
            small = reduced(picture, filter, constrained=constrained)
            error = error_enlarged(small, picture, "tent")
            over = float(max(small.max() - picture.max(), picture.min() - small.min()))
            errors[filter, constrained] = error, over
        box = errors["box", False][0]
        cells = []
        for filter in QUALITY:
            free, bound = errors[filter, False], errors[filter, True]
            cells.append(f"{free[0] / box:.3f} / {bound[0] / box:.3f}; {max(free[1], 0.0):.2f}")
        rows.append((name, f"{box:.4f}", *cells))
        others = [f for f in QUALITY if f not in (RINGING, LEAST_SQUARES)]
        best = errors[LEAST_SQUARES, True][0]
        beaten.append(best / min(errors[f, True][0] for f in others))
        cells = []
        for filter in SHOWN:
            small = reduced(picture, filter, constrained=True)
            boxes = reduced(picture, "box", constrained=True)
            shares = [
                error_enlarged(small, picture, by) / error_enlarged(boxes, picture, by)
                for by in ENLARGED_BY
            ]
            ring = ringing(small, picture)
            rings.append(ring if filter == LEAST_SQUARES else 0.0)
            cells.append(" / ".join(f"{one:.3f}" for one in shares) + f"; {ring:.0f}")
        ringing_rows.append((name, *cells))
    report.table(
        "To a quarter and back: error of the box; that of others, as they are / in [0, 1], as a "
        "share of it; overshoot",
        ("picture", "box", *QUALITY),
        rows,
        "pictures",
    )
    report.table(
        f"In [0, 1], enlarged by {', '.join(ENLARGED_BY)}: errors as shares of the box's; ringing",
        ("picture", *SHOWN),
        ringing_rows,
        "ringing",
    )
    report.verdict(
        max(beaten) < 1.0,
        f"values in [0, 1]: least squares have the lowest error on every picture, "
        f"{min(beaten):.3f} to {max(beaten):.3f} of the next filter's",
    )
    report.verdict(max(rings) < 1.0, f"least squares ring by {max(rings):.1f} of 255 at the most")


def reduced(picture: Array, filter: str, *, constrained: bool) -> Array:
    """The picture at a quarter of its size."""
    made: Array = prefilter.resize(
        picture,
        picture.shape[1] // SHRINK,
        picture.shape[0] // SHRINK,
        filter=filter.partition(",")[0],
        constrained=constrained,
        ringing="allow" if filter == RINGING else "auto",
    )
    return made


def error_enlarged(small: Array, picture: Array, by: str) -> float:
    """The root mean square error after enlargement by a filter."""
    large = prefilter.resize(small, picture.shape[1], picture.shape[0], filter=by)
    return float(np.sqrt(np.mean((large - picture) ** 2)))


def ringing(small: Array, picture: Array) -> float:
    """Excess of pixels over the range of all pixels under their tent, encoded, in steps of bytes.

    The result is the 99.9th percentile of pixels, each by its worst channel.
    """
    padded = np.pad(picture, ((SHRINK // 2,) * 2, (SHRINK // 2,) * 2, (0, 0)), mode="edge")
    around = sliding_window_view(padded, (2 * SHRINK, 2 * SHRINK), axis=(0, 1))
    around = around[::SHRINK, ::SHRINK]
    low, high = around.min(axis=(-2, -1)), around.max(axis=(-2, -1))
    seen, low, high = (255 * prefilter.to_srgb(one.clip(0, 1)) for one in (small, low, high))
    return float(np.percentile(np.maximum(low - seen, seen - high).max(axis=2), 99.9).clip(0))


def pictures() -> Iterator[tuple[str, Array]]:
    """Yields names and scene-linear colors."""
    yield "figure 1.8", drawn()
    for name, colors in textures():
        rows, columns = (side // SHRINK * SHRINK for side in colors.shape[:2])
        yield name, colors[:rows, :columns]


if __name__ == "__main__":
    main()
