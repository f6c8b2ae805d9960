# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the error of means of one-texel samples against the exact filter.

Usage: scripts/run python3 bench/sampling/one_texel.py [--pixels N] [--json FILE]

Each pixel is a mean of samples at its center, under Lanczos 2 of one scale, with stratified random
numbers. Pictures are base colors of models in ../shared/data/textured, and figure 1.8 as in the
documentation. Fails where texels of tables are not closer than those of trilinear interpolation: 4
with 16 samples, 8 with 64.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs" / "pictures"))
from resize import drawn

from bench.report import Report, add_json_option
from bench.texture_files import textures

ROOT = Path(__file__).resolve().parents[2]
Array = NDArray[np.float32]

FILTER = "lanczos2"
SCALE = 1024 / 89  # As in figure 6.1.
COUNTS = (1, 4, 16, 64)
# Samples levels minus the picture's mean, and adds the mean back.
ABOUT_MEAN = "8 texels, about the mean"
# Without ramps and for white images it reads fewer texels of finer levels, which differ more.
FOUR_WHITE = "4 texels, white, no ramps"
# Sample counts at which they must be closer than trilinear interpolation.
BARS = {FOUR_WHITE: 16, "8 texels": 64, ABOUT_MEAN: 64}
TABLES: dict[str, prefilter.SamplingTable | str] = {
    "8 texels": prefilter.SamplingTable.standard(FILTER, 8),
    ABOUT_MEAN: prefilter.SamplingTable.standard(FILTER, 8),
    "4 texels": prefilter.SamplingTable.standard(FILTER, 4),
    FOUR_WHITE: prefilter.SamplingTable.build(FILTER, texels=4, spectrum="white", ramp_weight=0.0),
    "trilinear": "trilinear",
    "bilinear": "bilinear",
}


def main() -> None:
    """Runs everything."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--pixels", type=int, default=20_000)
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    pictures = {"figure 1.8": drawn()} | dict(textures())
    rows = []
    ratios: dict[str, list[float]] = {table: [] for table in BARS}
    for name, picture in pictures.items():
        errors = {table: measured(picture, table, options.pixels) for table in TABLES}
        rows += [(name, table, *map("{:.4f}".format, found)) for table, found in errors.items()]
        for table, count in BARS.items():
            at = COUNTS.index(count)
            ratios[table].append(errors[table][at] / errors["trilinear"][at])
    head = ("picture", "texels of", *(f"{n} a pixel" for n in COUNTS), "all of them")
    report.table(f"RMSE to the exact {FILTER}, scale {SCALE:.1f}", head, rows, "errors")
    for table, count in BARS.items():
        claim = (
            f"{table}, {count} samples a pixel: {min(ratios[table]):.2f} to "
            f"{max(ratios[table]):.2f} of the error of trilinear interpolation"
        )
        report.verdict(max(ratios[table]) < 1, claim)
    for table in TABLES:
        if table != ABOUT_MEAN:
            report.note(f"{table}: weights have a magnitude of {magnitude(table):.2f} on average")
    report.finish(options.json)


def measured(picture: Array, name: str, pixels: int) -> list[float]:
    """The error for each number of samples, and the error of the weighted sum itself."""
    random = np.random.default_rng(0)
    if name == ABOUT_MEAN:
        picture = picture - picture.mean(axis=(0, 1))
    levels = prefilter.sampling_levels(picture, FILTER)
    places = random.random((pixels, 2))
    exact = prefilter.sample_exact(picture, places, SCALE, filter=FILTER)
    table = TABLES[name]
    errors = []
    for count in COUNTS:
        strata = (np.arange(count) + random.random((pixels, count))) / count
        found = prefilter.sample_stochastic(
            levels, table, np.repeat(places, count, axis=0), SCALE, strata.ravel()
        )
        mean = found.reshape(pixels, count, -1).mean(axis=1)
        errors.append(rmse(mean, exact))
    if table == "bilinear":
        level = round(np.log2(SCALE))
        whole = prefilter.sample(levels[level : level + 1], "trilinear", places, 1.0)
    else:
        whole = prefilter.sample(levels, table, places, SCALE)
    return [*errors, rmse(whole, exact)]


def magnitude(name: str) -> float:
    """The mean absolute weight of the picked texels: 1 if none is negative."""
    random = np.random.default_rng(1)
    levels = prefilter.sampling_levels(np.zeros((1024, 1024, 1)), FILTER)
    places, numbers = random.random((20_000, 2)), random.random(20_000)
    scales = np.exp2(random.uniform(2, 8, 20_000))
    picked = prefilter.pick_texels(levels, TABLES[name], places, scales, numbers)
    return float(np.abs(picked.weights).mean())


def rmse(found: Array, exact: Array) -> float:
    """Over samples and channels."""
    return float(np.sqrt(np.mean((found - exact) ** 2, dtype=np.float64)))


if __name__ == "__main__":
    main()
