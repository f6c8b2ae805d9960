# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares sampling tables with trilinear interpolation that reads finer levels, as in games.

Usage: scripts/run python3 -m bench.sampling.biases [--json FILE] [--pictures FOLDER]

The images come from bench/sampling/figures.py, or from a folder. Trilinear interpolation has
its best bias for each image, and where the mean over a pixel is the truth also the best of all
filters of levels. Numbers are PSNRs in dB over ten scales, of values in linear light over all
channels. Ends with status 1 where a criterion does not hold.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray
from PIL import Image

from bench.report import Report, add_json_option
from bench.sampling.figures import SCALES, TEXELS, images, rotated_grid

Array = NDArray[np.floating]

BIASES = (0.0, -0.25, -0.5, -0.75, -1.0, -1.25)  # levels
MEANS = ("box", "tent")  # Levels of tables for the mean over a pixel.
SIDE = 1024  # Largest side of pictures.
NAMES = [f"{texels} texels" for texels in TEXELS]


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_json_option(parser)
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="files that Pillow reads")
    options = parser.parse_args()
    sources = images() if options.pictures is None else pictures(options.pictures)
    report = Report()
    itself, means = [], []
    for title, image in sources:
        found = Comparison(image)
        itself += [(f"{name}, {title}", *one) for name, one in found.itself.items()]
        means.append((title, *found.best_for_mean(), [found.means[name] for name in MEANS]))
        print(title, flush=True)
    against_filters(report, itself)
    against_mean(report, means)
    report.finish(options.json)


def pictures(folder: Path) -> Iterator[tuple[str, Array]]:
    """Squares from the corners of all, in linear light, three channels."""
    for path in sorted(folder.iterdir()):
        pixels = np.asarray(Image.open(path).convert("RGB"))[::-1].astype(np.float32) / 255
        side = 2 ** int(np.log2(min(*pixels.shape[:2], SIDE)))
        yield path.stem, prefilter.to_linear(pixels[:side, :side])


class Comparison:
    """Errors of samples of an image.

    Attributes:
        itself: By filters of levels and tables, against that filter: trilinear interpolation at its
            best bias, that bias, and the standard tables.
        trilinear: By filters of levels, against the mean over a pixel: the same without tables.
        means: By MEANS, against that: the tables whose target it is.
    """

    def __init__(self, image: Array) -> None:
        """Takes all samples."""
        random = np.random.default_rng(0)
        self.places = [
            (rotated_grid(0.7 * number, random.random(2)), scale)
            for number, scale in enumerate(SCALES[::2])
        ]
        self.itself: dict[str, tuple[float, float, list[float]]] = {}
        self.trilinear: dict[str, tuple[float, float]] = {}
        self.means: dict[str, list[float]] = {}
        mean = self._exact(image, "box")
        for filter in prefilter.SAMPLING_FILTERS:
            truth = self._exact(image, filter)
            levels = prefilter.sampling_levels(image, filter, wrap="repeat")
            biased = [self._samples(levels, "trilinear", 2**bias) for bias in BIASES]
            best = [
                max((psnr(found, exact), bias) for found, bias in zip(biased, BIASES, strict=True))
                for exact in (truth, mean)
            ]
            self.itself[filter] = (*best[0], self._tables(levels, filter, filter, truth))
            self.trilinear[filter] = best[1]
            if filter in MEANS:
                self.means[filter] = self._tables(levels, filter, "box", mean)

    def best_for_mean(self) -> tuple[str, float, float]:
        """The best level filter for trilinear interpolation, its PSNR, and its bias."""
        filter = max(self.trilinear, key=self.trilinear.__getitem__)
        return filter, *self.trilinear[filter]

    def _tables(
        self, levels: Sequence[Array], filter: str, target: str, truth: list[Array]
    ) -> list[float]:
        tables = [
            prefilter.SamplingTable.standard(filter, texels, target=target) for texels in TEXELS
        ]
        return [psnr(self._samples(levels, table), truth) for table in tables]

    def _exact(self, image: Array, filter: str) -> list[Array]:
        return [
            prefilter.sample_exact(image, places, scale, filter=filter, wrap="repeat")
            for places, scale in self.places
        ]

    def _samples(
        self, levels: Sequence[Array], table: prefilter.SamplingTable | str, factor: float = 1.0
    ) -> list[Array]:
        return [
            prefilter.sample(levels, table, places, scale * factor, wrap="repeat")
            for places, scale in self.places
        ]


def psnr(found: list[Array], exact: list[Array]) -> float:
    """The peak signal-to-noise ratio, from the mean square error over all scales."""
    squares = [np.mean((a.astype(float) - b) ** 2) for a, b in zip(found, exact, strict=True)]
    return float(-10 * np.log10(np.mean(squares)))


def against_filters(report: Report, rows: list[tuple[str, float, float, list[float]]]) -> None:
    """The truth is the exact filter of the levels."""
    report.table(
        "Against the exact filter",
        ("levels, image", "trilinear at its best bias", *NAMES),
        [
            (title, f"{own:.1f} at {bias:g}", *(f"{one:.1f}" for one in tables))
            for title, own, bias, tables in rows
        ],
        "filters",
    )
    leads = {title: [one - own for one in tables] for title, own, _, tables in rows}
    least = min(leads, key=lambda title: leads[title][0])
    report.verdict(
        leads[least][0] > 0.0,
        f"8 texels lead by {leads[least][0]:.1f} dB ({least}) to"
        f" {max(lead[0] for lead in leads.values()):.1f}",
    )
    of_four(report, [lead[-1] for lead in leads.values()])


def against_mean(
    report: Report, rows: list[tuple[str, str, float, float, list[list[float]]]]
) -> None:
    """The truth is the mean over a pixel."""
    report.table(
        "Against the mean over a pixel",
        (
            "image",
            "trilinear, the best levels and bias",
            *(f"{name} levels, {title}" for name in MEANS for title in NAMES),
        ),
        [
            (
                title,
                f"{own:.1f}: {filter} at {bias:g}",
                *(f"{one:.1f}" for tables in means for one in tables),
            )
            for title, filter, own, bias, means in rows
        ],
        "means",
    )
    for index, name in enumerate(MEANS):
        leads = {title: means[index][0] - own for title, _, own, _, means in rows}
        least = min(leads, key=leads.__getitem__)
        report.verdict(
            leads[least] > 0.0,
            f"the mean from {name} levels: 8 texels lead by {leads[least]:.1f} dB ({least}) to"
            f" {max(leads.values()):.1f}",
        )
        of_four(report, [means[index][-1] - own for _, _, own, _, means in rows])


def of_four(report: Report, leads: list[float]) -> None:
    """Four texels, which are half as many, are no criterion."""
    ahead = sum(lead > 0.0 for lead in leads)
    report.note(
        f"4 texels are ahead on {ahead} of {len(leads)} rows: {min(leads):.1f} to"
        f" {max(leads):.1f} dB, {np.mean(leads):.1f} on average"
    )


if __name__ == "__main__":
    main()
