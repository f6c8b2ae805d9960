# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares samples by tables with exact filters, and with trilinear interpolation.

Usage: scripts/run python3 -m bench.sampling.figures [--json FILE]

The figures are in docs/sampling.md; the other images are the base colors of models in
../shared/data/textured, without which it does with figure 6.1's. Every number but the steps is a
PSNR to the exact filter in dB: 10 times the logarithm of 1 over the mean square difference of
values in linear light, over all channels. Ends with status 1 where a criterion does not hold.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray

from bench.report import Report, add_json_option
from bench.texture_files import textures

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs" / "pictures"))
import sampling as figures  # noqa: E402
from resize import drawn  # noqa: E402

Array = NDArray[np.floating]

LEAST_GAIN = 6.0  # dB of 8 texels, over trilinear interpolation
TEXELS = (8, 6, 4)
SCALES = 2 ** np.linspace(0, 5, 21)[1:]
PLACES = 64  # along each side of the grids that are rotated
SPACING = 1e-3  # cells between samples of a pan, and levels between those of a zoom
WALKS = 60
SMALL = 512
RISE = 0.7, 0.3


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    of_figures(report)
    of_images(report)
    of_scales(report)
    steps(report)
    report.finish(options.json)


def of_figures(report: Report) -> None:
    """Figures 6.1, 6.9, 6.11 and 6.12."""
    image = drawn(figures.SIDE)
    made = {
        "6.1: 1024^2 to 89^2, lanczos2": figures.downsampled(image, 89),
        "6.9: zone plate, 1024^2 to 300^2, lanczos2": figures.downsampled(
            figures.zone_plate(figures.SIDE), 300
        ),
        "6.11: checkerboard to the horizon, tent": figures.checkerboard(),
        "6.12: Feline against EWA, gaussian": figures.probes(image),
    }
    names = ("trilinear", *(f"{texels} texels" for texels in TEXELS))
    rows = [(title, *(f"{one.psnr(name):.1f}" for name in names)) for title, one in made.items()]
    report.table("Figures", ("figure", *names), rows)
    for title, one in made.items():
        gain = one.psnr("8 texels") - one.psnr("trilinear")
        claim = f"figure {title}: 8 texels are {gain:.1f} dB above trilinear interpolation"
        if "lanczos2" in title:
            report.verdict(gain >= LEAST_GAIN, f"{claim}, at least {LEAST_GAIN:.0f}")
        else:
            report.note(claim)


def images() -> Iterator[tuple[str, Array]]:
    """Yields the available images, in linear light, three channels."""
    yield "figure 6.1", drawn(figures.SIDE)
    yield from textures()


def of_images(report: Report) -> None:
    """Images made smaller as in figure 6.1; and what levels change that others make."""
    names = ("box levels, trilinear", "trilinear", "8 texels", "6 texels", "4 texels")
    clipped = "8 texels, clipped levels"
    rows = []
    gains = {}
    for title, image in images():
        figure = figures.downsampled(image, round(image.shape[1] * 89 / 1024))
        side = figure.exact.shape[0]
        places = (np.indices((side, side))[::-1].reshape(2, -1).T + 0.5) / side
        scale = image.shape[1] / side
        box = prefilter.sampling_levels(image, "box")
        figure.approximate["box levels, trilinear"] = prefilter.sample(
            box, "trilinear", places, scale
        ).reshape(figure.exact.shape)
        limited = [level.clip(0, 1) for level in prefilter.sampling_levels(image)]
        table = prefilter.SamplingTable.standard("lanczos2")
        figure.approximate[clipped] = prefilter.sample(limited, table, places, scale).reshape(
            figure.exact.shape
        )
        gains[title] = figure.psnr("8 texels") - figure.psnr("trilinear")
        rows.append((title, *(f"{figure.psnr(name):.1f}" for name in (*names, clipped))))
    title = "Images made smaller to 89/1024, lanczos2"
    report.table(title, ("image", *names, clipped), rows, "images")
    least = min(gains, key=gains.__getitem__)
    report.verdict(
        gains[least] >= LEAST_GAIN,
        f"images made smaller: 8 texels are at least {gains[least]:.1f} dB ({least}) above"
        f" trilinear interpolation, at least {LEAST_GAIN:.0f}",
    )


def rotated_grid(angle: float, corner: Array) -> Array:
    """Places all over a repeated image."""
    x, y = np.meshgrid(np.arange(PLACES) / PLACES, np.arange(PLACES) / PLACES)
    turned = [x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle)]
    return np.stack(turned, axis=-1).reshape(-1, 2) + corner


def of_scales(report: Report) -> None:
    """All filters over scales and rotations."""
    image = drawn(figures.SIDE)
    names = ("trilinear", *(f"{texels} texels" for texels in TEXELS))
    rows = []
    by_scale = {}
    for filter in prefilter.SAMPLING_FILTERS:
        levels = prefilter.sampling_levels(image, filter, wrap="repeat")
        squares = np.zeros((len(SCALES), len(names)))
        random = np.random.default_rng(0)
        for number, scale in enumerate(SCALES):
            places = rotated_grid(0.7 * number, random.random(2))
            exact = prefilter.sample_exact(image, places, scale, filter=filter, wrap="repeat")
            for column, table in enumerate(figures.tables(filter).values()):
                found = prefilter.sample(levels, table, places, scale, wrap="repeat")
                squares[number, column] = np.mean((found.astype(np.float64) - exact) ** 2)
        psnrs = -10 * np.log10(squares)
        by_scale[filter] = psnrs
        gains = psnrs[:, 1] - psnrs[:, 0]
        total = -10 * np.log10(squares.mean(axis=0))
        rows.append(
            (filter, *(f"{one:.1f}" for one in total), f"{gains.min():.1f} to {gains.max():.1f}")
        )
    report.table(
        f"Scales from {SCALES[0]:.2f} to {SCALES[-1]:.0f}, each at another angle",
        ("filter", *names, "gain of 8 texels, least to most"),
        rows,
        "filters",
    )
    report.table(
        "The same by scale, lanczos2",
        ("scale", *names),
        [
            (f"{scale:.2f}", *(f"{one:.1f}" for one in row))
            for scale, row in zip(SCALES, by_scale["lanczos2"], strict=True)
        ],
        "scales",
    )


def ramp(side: int) -> Array:
    """Rises evenly, from 0 in one corner to 1 in the one across, in a direction of no symmetry."""
    at = (np.arange(side, dtype=np.float32) + 0.5) / side
    return (RISE[0] * at + RISE[1] * at[:, None])[..., None]


def walks() -> Iterator[tuple[str, Array, Array]]:
    """Paths around the middle of an image SMALL texels wide: places and scales, step by step."""
    random = np.random.default_rng(2)
    along = np.arange(round(2 / SPACING)) * SPACING
    for _ in range(WALKS):
        angle, scale = random.uniform(0, 2 * np.pi), 2 ** random.uniform(-1, 4)
        cell = 2 ** np.ceil(np.log2(max(scale, 1))) / SMALL
        path = random.uniform(0.4, 0.6, 2) + cell * along[:, None] * (np.cos(angle), np.sin(angle))
        yield "pan", path, np.full(len(path), scale)
    zoom = np.arange(-1, 4, SPACING)
    for _ in range(WALKS):
        yield "zoom", np.tile(random.uniform(0.4, 0.6, 2), (len(zoom), 1)), 2**zoom


def steps(report: Report) -> None:
    """Measures steps between neighboring samples beyond the change of the exact result."""
    sources = {
        "ramp, by its slope": ramp(SMALL),
        "figure 6.1": drawn(SMALL),
        "checkerboard": figures.squares(SMALL, 10),
    }
    rows = []
    exceeded = []
    for filter in ("tent", "gaussian", "lanczos2"):
        bounds = {
            name: max(table.largest_jumps.values())
            for name, table in figures.tables(filter).items()
            if not isinstance(table, str)
        }
        for title, image in sources.items():
            found = largest_steps(image, filter, by_slope="slope" in title)
            rows.append(
                (f"{filter}, {title}", *(f"{pan:.3f} / {zoom:.3f}" for pan, zoom in found.values()))
            )
            if "slope" not in title:
                exceeded += [name for name, most in bounds.items() if max(found[name]) > most]
        rows.append((f"{filter}, most for any image", "0", *(f"{b:.3f}" for b in bounds.values())))
    report.table(
        f"Largest step of a slow pan / zoom ({SPACING:g} cells or levels a sample)",
        ("filter, image", "trilinear", *(f"{texels} texels" for texels in TEXELS)),
        rows,
        "steps",
    )
    report.verdict(not exceeded, "no step is larger than the table says (largest_jumps)")


def largest_steps(image: Array, filter: str, *, by_slope: bool) -> dict[str, tuple[float, float]]:
    """The largest steps of pans and of zooms, by sampling method."""
    levels = prefilter.sampling_levels(image, filter)
    largest: dict[str, dict[str, float]] = {}
    for kind, places, scales in walks():
        exact = prefilter.sample_exact(image, places, scales, filter=filter)
        slope = np.hypot(*RISE) * np.maximum(scales[1:, None], 1) / SMALL if by_slope else 1.0
        for name, table in figures.tables(filter).items():
            found = prefilter.sample(levels, table, places, scales)
            step = np.abs(np.diff(found.astype(np.float64) - exact, axis=0) / slope).max()
            kinds = largest.setdefault(name, {"pan": 0.0, "zoom": 0.0})
            kinds[kind] = max(kinds[kind], float(step))
    return {name: (kinds["pan"], kinds["zoom"]) for name, kinds in largest.items()}


if __name__ == "__main__":
    main()
