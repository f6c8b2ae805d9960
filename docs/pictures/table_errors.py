# SPDX-License-Identifier: GPL-3.0-or-later

"""Plots figure 6.6: errors of sampling tables for the tent, against the number of texels.

usage: python3 table_errors.py FOLDER        (with the package prefilter importable)

Leaves FOLDER/table_errors.png.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import prefilter
from PIL import Image, ImageDraw, ImageFont
from sheets import INK, PAPER, encoded

TEXELS = range(2, 11)
CURVES: list[tuple[str, tuple[int, int, int], int]] = [
    ("2 x 2 x 1, linear", (2, 2, 1), 1),
    ("4 x 4 x 2, linear", (4, 4, 2), 1),
    ("8 x 8 x 4, linear", (8, 8, 4), 1),
    ("2 x 2 x 1, quadratic", (2, 2, 1), 2),
    ("4 x 4 x 2, quadratic", (4, 4, 2), 2),
]
COLORS = [(0, 114, 178), (213, 94, 0), (0, 158, 115), (86, 180, 233), (230, 159, 0)]
GRID = (222, 222, 226)
WIDTH, HEIGHT = 900, 560
LEFT, RIGHT, BOTTOM, TOP = 70, 24, 60, 24  # Margins.
MOST = 2.0  # The error at the top.
DASHES = {1: (), 2: (9.0, 5.0)}  # Keyed by degree.


def main(folder: Path) -> None:
    """Makes the picture."""
    lines = [line([(x, 0), (x, MOST)], GRID, 1.0) for x in TEXELS]
    lines += [line([(TEXELS[0], y), (TEXELS[-1], y)], GRID, 1.0) for y in ticks()]
    lines.append(line([(TEXELS[0], 1.0), (TEXELS[-1], 1.0)], INK, 1.5))
    for (_, subdomains, degree), color in zip(CURVES, COLORS, strict=True):
        points = list(zip(TEXELS, curve(subdomains, degree), strict=True))
        lines.append(line(points, color, 2.5, DASHES[degree]))
    paper = (*linear(PAPER), 1.0)
    light = prefilter.rasterize(lines, WIDTH, HEIGHT, overlap="cover", background=paper)
    pixels = np.round(255 * encoded(light[::-1, :, :3])).astype(np.uint8)
    page = Image.fromarray(pixels)
    write(ImageDraw.Draw(page))
    page.save(folder / "table_errors.png")


def curve(subdomains: tuple[int, int, int], degree: int) -> list[float]:
    """The error for each number of texels, as a share of trilinear interpolation's."""
    return [
        prefilter.SamplingTable.build(
            "tent",
            texels=texels,
            subdomains=subdomains,
            degree=degree,
            ramp_weight=0,
            spectrum="white",
        ).error_ratio
        for texels in TEXELS
    ]


def ticks() -> list[float]:
    """Errors with a line across."""
    return [step / 5 for step in range(round(5 * MOST) + 1)]


def linear(color: Sequence[int]) -> list[float]:
    """Decodes sRGB."""
    return prefilter.to_linear(np.array([[color]], np.float32) / 255)[0, 0].tolist()


def place(texels: float, error: float) -> tuple[float, float]:
    """The position of a value, from the lower left corner."""
    along = (texels - TEXELS[0]) / (TEXELS[-1] - TEXELS[0])
    return (
        LEFT + along * (WIDTH - LEFT - RIGHT),
        BOTTOM + error / MOST * (HEIGHT - BOTTOM - TOP),
    )


def line(
    points: Sequence[tuple[float, float]],
    color: Sequence[int],
    width: float,
    dashes: Sequence[float] = (),
) -> prefilter.Shape:
    """A stroke through values."""
    shape = prefilter.Shape()
    for index, (texels, error) in enumerate(points):
        (shape.line_to if index else shape.move_to)(*place(texels, error))
    stroke = shape.stroked(width, join="round", dashes=dashes)
    stroke.color = (*linear(color), 1.0)
    return stroke


def write(draw: ImageDraw.ImageDraw) -> None:
    """Adds the numbers of the axes, and a legend."""
    font = ImageFont.load_default(size=15)

    def text(
        at: tuple[float, float], words: str, anchor: str, color: tuple[int, ...] = INK
    ) -> None:
        draw.text((at[0], HEIGHT - at[1]), words, fill=color, font=font, anchor=anchor)

    for texels in TEXELS:
        x, y = place(texels, 0.0)
        text((x, y - 8), str(texels), "mt")
    for error in ticks():
        x, y = place(TEXELS[0], error)
        text((x - 10, y), f"{error:.1f}", "rm")
    text((place(6, 0)[0], 26), "texels", "mt")
    right, top = place(TEXELS[-1], MOST)
    for index, ((name, _, degree), color) in enumerate(zip(CURVES, COLORS, strict=True)):
        y = top - 24 - 24 * index
        text((right - 60, y), name, "rm", INK)
        step = 9 if degree == 2 else 48
        for start in range(0, 48, 14 if degree == 2 else 48):
            ends = [right - 52 + start, right - 52 + min(start + step, 48)]
            draw.line([(x, HEIGHT - y) for x in ends], fill=color, width=3)
    y = top - 24 - 24 * len(CURVES)
    text((right - 60, y), "trilinear interpolation (8 texels)", "rm")
    draw.line([(right - 52, HEIGHT - y), (right - 4, HEIGHT - y)], fill=INK, width=2)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
