# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures sampling tables: errors, sizes, proofs, steps at borders, and how long they take.

Usage: scripts/run python3 -m bench.sampling.tables [--certify] [--json FILE]

Errors follow equation 6.3 over all positions and scales, as shares of trilinear interpolation's on
the same mipmap. The program measures the standard tables; the tables for white images, as in the
dissertation, and larger ones; the curves of figure 6.6, which docs/pictures/table_errors.py draws;
and steps of samples across borders of subdomains, in the picture of docs/resize.md. With --certify
those tables are proven to be the best possible within minutes each. Fails where a criterion does
not hold.
"""

import argparse
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import prefilter
from prefilter.sampling.sampling_table import STANDARD_TARGETS

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "python"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs" / "pictures"))
import sampling_oracle as oracle
from resize import drawn
from table_errors import CURVES, TEXELS, curve

from bench.report import Report, add_json_option

FILTERS = prefilter.SAMPLING_FILTERS
MOST = {"box": 0.586, "tent": 0.237, "gaussian": 0.220, "lanczos2": 0.253}
PUBLISHED = {"box": 0.569, "tent": 0.209, "gaussian": 0.142, "lanczos2": 0.232}
NO_WORSE_WITH_FOUR = ("tent", "gaussian", "lanczos2")
LARGER = [
    ((2, 2, 1), 1), ((4, 4, 2), 1), ((8, 8, 4), 1), ((16, 16, 8), 1),
    ((2, 2, 1), 2), ((4, 4, 2), 2), ((8, 8, 4), 2), ((16, 16, 8), 2),
]  # fmt: skip
PROVEN_SOON = [("tent", 4, 0.0), ("tent", 4, 5.0), ("tent", 8, 0.0), ("tent", 8, 5.0)]
PROVEN = [
    *PROVEN_SOON,
    *((name, 4, 5.0) for name in FILTERS if name != "tent"),
    *((name, 6, 5.0) for name in ("box", "tent", "gaussian", "mitchell", "lanczos2")),
    ("box", 8, 5.0),
    *((name, 8, 0.0) for name in ("gaussian", "lanczos2")),
]
PLACES = 200_000


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--certify", action="store_true", help="prove more than the tent's")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    standard_tables(report)
    white_tables(report)
    larger_tables(report)
    figure_curves(report)
    steps_at_borders(report)
    certificates(report, everything=options.certify)
    report.finish(options.json)


def standard_tables(report: Report) -> None:
    """Reports the standard tables: their errors and build times."""
    rows = []
    began = time.process_time()  # whatever else the machine does
    kinds = [*((name, None) for name in FILTERS), *STANDARD_TARGETS]
    for name, target in kinds:
        tables = [
            prefilter.SamplingTable.build(name, texels=texels, target=target, threads=2)
            for texels in (4, 6, 8)
        ]
        rows.append(
            (
                name if target is None else f"{target}, from levels of {name}",
                *(f"{table.error_ratio:.3f}" for table in tables),
                *(f"{tables[-1].error_ratios[levels]:.3f}" for levels in (2, 1)),
            )
        )
    seconds = (time.process_time() - began) / 2
    head = ("filter", "4 texels", "6 texels", "8 texels", "8, two levels", "8, one level")
    report.table("Error of standard tables for natural images", head, rows, "natural")
    claim = f"all {3 * len(rows)} standard tables take 2 x {seconds:.1f} s of processor time"
    report.verdict(seconds <= 60, f"{claim}, at most 60 s on two threads")


def white_tables(report: Report) -> None:
    """Reports the tables for white images, as in the dissertation."""
    head = (
        "filter", "4 texels", "6 texels", "8 texels", "8, without ramps", "those weighted",
        "dissertation", "8, two levels", "8, one level",
    )  # fmt: skip
    rows = []
    tables = {
        (name, texels): prefilter.SamplingTable.build(name, texels=texels, spectrum="white")
        for name in FILTERS
        for texels in (4, 6, 8)
    }
    for name in FILTERS:
        ratios = [tables[name, texels].error_ratio for texels in (4, 6, 8)]
        eight = tables[name, 8]
        without = prefilter.SamplingTable.build(name, ramp_weight=0, spectrum="white")
        published = PUBLISHED.get(name)
        rows.append(
            (
                name,
                *(f"{ratio:.3f}" for ratio in ratios),
                f"{without.error_ratio:.3f}",
                f"{weighted_ratio(without):.3f}",
                "" if published is None else f"{published:.3f}",
                *(f"{eight.error_ratios[levels]:.3f}" for levels in (2, 1)),
            )
        )
    report.table("Error of tables for white images, as a share of trilinear's", head, rows, "white")
    for name, most in MOST.items():
        ratio = tables[name, 8].error_ratio
        report.verdict(ratio <= most, f"{name}, 8 texels: {ratio:.4f}, at most {most}")
    for name in NO_WORSE_WITH_FOUR:
        ratio = tables[name, 4].error_ratio
        report.verdict(ratio <= 1, f"{name}, 4 texels: {ratio:.4f}, at most 1 (trilinear's 8)")


def weighted_ratio(table: prefilter.SamplingTable) -> float:
    """The ratio of errors where filters have a square integral of 1 instead of an integral of 1."""
    section = table.section(3)
    grid, _, slices = table.subdomains
    panels = 4 if table.filter == "box" else 1  # The products of boxes have kinks.
    totals = np.zeros(2)
    for part, offsets, coefficients in zip(
        oracle.subdomains(grid, slices, 3), section.offsets, section.coefficients, strict=True
    ):
        for x, y, f, weight in part.nodes(panels, 4):
            weight *= 4.0 ** (f - 1)
            of_place = coefficients @ oracle.terms(table.degree, x, y, f)
            texels, weights = oracle.trilinear_texels(3, x, y, f)
            for index, (places, shares) in enumerate([(offsets, of_place), (texels, weights)]):
                fields = oracle.fields(table.filter, 3, places, x, y, f)
                totals[index] += weight * fields.error(shares)
    return float(totals[0] / totals[1])


def larger_tables(report: Report) -> None:
    """Reports the errors of finer and of quadratic tables relative to the standard ones."""
    rows = []
    for subdomains, degree in LARGER:
        began = time.perf_counter()
        tables = {
            name: prefilter.SamplingTable.build(
                name, subdomains=subdomains, degree=degree, ramp_weight=0, spectrum="white"
            )
            for name in MOST
        }
        seconds = (time.perf_counter() - began) / len(tables)
        rows.append(
            (
                " x ".join(map(str, subdomains)) + (", quadratic" if degree == 2 else ", linear"),
                *(f"{table.error_ratio:.3f}" for table in tables.values()),
                f"{size(tables['tent']):,}",
                f"{seconds:.1f}",
            )
        )
    report.table(
        "Eight texels without ramps; bytes of the section for three levels",
        ("table", *MOST, "bytes", "s to build"),
        rows,
        "larger",
    )


def size(table: prefilter.SamplingTable) -> int:
    """Bytes of the section for three levels: three a texel, and floats for coefficients."""
    section = table.section(3)
    return int(section.offsets.size + 4 * section.coefficients.size)


def figure_curves(report: Report) -> None:
    """Figure 6.6."""
    curves = [curve(subdomains, degree) for _, subdomains, degree in CURVES]
    rows = [
        (str(texels), *(f"{values[index]:.3f}" for values in curves))
        for index, texels in enumerate(TEXELS)
    ]
    head = ("texels", *(name for name, _, _ in CURVES))
    report.table("Figure 6.6: error of tables for the tent", head, rows, "figure-6.6")


def steps_at_borders(report: Report) -> None:
    """Reports the steps of samples where sets change: for the worst image, and in a picture."""
    rows = []
    picture = drawn().mean(axis=2, keepdims=True)
    for name in FILTERS:
        levels = prefilter.sampling_levels(picture, name, wrap="repeat")
        for texels in (4, 8):
            table = prefilter.SamplingTable.standard(name, texels)
            steps = np.concatenate(list(picture_steps(table, levels)))
            rows.append(
                (
                    f"{name}, {texels} texels",
                    *(f"{table.largest_jumps[count]:.2f}" for count in (3, 2, 1)),
                    f"{255 * np.sqrt(np.mean(steps**2)):.2f}",
                    f"{255 * error_in(table, levels, picture):.2f}",
                )
            )
    head = ("table", "three levels", "two levels", "one level", "RMS, 255ths", "RMS error")
    report.table("Steps across borders of subdomains", head, rows, "steps")


def picture_steps(table: prefilter.SamplingTable, levels: list[np.ndarray]) -> Iterator[np.ndarray]:
    """Yields sample steps across random borders of all kinds, with three levels available."""
    random = np.random.default_rng(0)
    count = PLACES // 4
    aside = 1e-5
    grid, _, slices = table.subdomains
    level = random.integers(2, 5, count)
    sides = np.array([len(levels[0]) / 2.0**k for k in level])
    f = random.uniform(0.01, 0.99, count)
    cell = np.floor(random.uniform(0, 1, (count, 2)) * sides[:, None])
    along = random.uniform(0, 1, count)
    line = random.integers(0, grid, count) / grid
    flipped = np.where(random.integers(0, 2, count) == 1, along, 1 - along)
    borders = [
        (np.stack([line, along], 1), np.array([aside, 0])),
        (np.stack([along, line], 1), np.array([0, aside])),
        (np.stack([along, flipped], 1), np.array([aside, 0])),
    ]
    for place, step in borders:
        yield difference(table, levels, [(cell + place + s * step, f) for s in (-1, 1)], level)
    place = random.uniform(0, 1, (count, 2))
    border = random.integers(1, slices + 1, count) / slices
    yield difference(table, levels, [(cell + place, border + s * aside) for s in (-1, 1)], level)


def difference(
    table: prefilter.SamplingTable,
    levels: list[np.ndarray],
    places: list[tuple[np.ndarray, np.ndarray]],
    level: np.ndarray,
) -> np.ndarray:
    """Differences of samples at two lists of positions, in cells of a level and fractions of it."""
    first, second = (
        prefilter.sample(
            levels,
            table,
            place * 2.0 ** level[:, None] / len(levels[0]),
            2.0 ** (level - 1 + f),
            wrap="repeat",
        )
        for place, f in places
    )
    return (second - first).ravel()


def error_in(
    table: prefilter.SamplingTable, levels: list[np.ndarray], picture: np.ndarray
) -> float:
    """The root mean square error of samples at random places, to the exact filter."""
    random = np.random.default_rng(1)
    coordinates = random.uniform(0, 1, (4000, 2))
    scales = 2.0 ** random.uniform(1, 4, len(coordinates))
    exact = prefilter.sample_exact(picture, coordinates, scales, filter=table.filter, wrap="repeat")
    found = prefilter.sample(levels, table, coordinates, scales, wrap="repeat")
    return float(np.sqrt(np.mean((found - exact) ** 2)))


def certificates(report: Report, *, everything: bool) -> None:
    """Reports how many sets are proven optimal, and bounds the distance of the others."""
    rows = []
    for name, texels, ramp_weight in PROVEN if everything else PROVEN_SOON:
        build = partial(
            prefilter.SamplingTable.build,
            name,
            texels=texels,
            ramp_weight=ramp_weight,
            spectrum="white",
        )
        plain = build()
        began = time.perf_counter()
        table = build(certify=True)
        seconds = time.perf_counter() - began
        gaps = [table.section(levels).gaps for levels in (3, 2, 1)]
        of_three, of_fewer = gaps[0], np.concatenate(gaps[1:])
        rows.append(
            (
                f"{name}, {texels} texels" + ("" if ramp_weight else ", without ramps"),
                f"{np.count_nonzero(of_three == 0)} of {len(of_three)}",
                f"{of_three.max():.3f}",
                f"{np.count_nonzero(of_fewer == 0)} of {len(of_fewer)}",
                f"{of_fewer.max():.3f}",
                f"{plain.error_ratio - table.error_ratio:.6f}",
                f"{seconds:.0f}",
            )
        )
        print("  ".join(rows[-1]), flush=True)
        if (name, texels) == ("tent", 4):
            claim = f"{rows[-1][0]}: {rows[-1][1]} subdomains are proven to have the best set"
            report.verdict(bool((of_three == 0).all()), claim)
    head = (
        "table", "proven", "largest gap", "of fewer levels", "largest gap", "without, above by",
        "s",
    )  # fmt: skip
    report.table("Sets that are proven to be the best", head, rows, "proofs")


if __name__ == "__main__":
    main()
