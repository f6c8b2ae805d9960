# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the picture of docs/resize.md: figure 1.8, reduced by filters and enlarged again.

usage: python3 resize.py FOLDER        (with the package prefilter importable)

Leaves FOLDER/resize.png, and prints the errors.
"""

import sys
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Array = NDArray[np.float32]

PAPER, INK = (246, 246, 244), (40, 40, 40)
GAP, TEXT = 16, 18
SIZE, SMALL = 384, 64
FINE = 4  # Oversampling of the drawing.
SHOWN = (
    ("box", "auto", "Box"),
    ("lanczos3", "auto", "Lanczos 3"),
    ("radial3", "auto", "Radial 3"),
    ("least-squares", "allow", "Least squares, ringing"),
    ("least-squares", "auto", "Least squares"),
)


def main(folder: Path) -> None:
    """Makes the picture."""
    picture = drawn()
    cells = [(picture, f"{SIZE} x {SIZE}")]
    for filter, ringing, title in SHOWN:
        small = prefilter.resize(picture, SMALL, SMALL, filter=filter, ringing=ringing)
        large = prefilter.resize(small, SIZE, SIZE, filter="tent")
        error = np.sqrt(np.mean((large - picture) ** 2))
        print(f"{title}: error {error:.4f}, from {small.min():.3f} to {small.max():.3f}")
        cells.append((large, f"{title}: error {error:.3f}"))
    sheet(cells, columns=3).save(folder / "resize.png")


def drawn(size: int = SIZE) -> Array:
    """Letters, rays and rings, in scene-linear values."""
    side = FINE * size
    page = Image.new("RGB", (side, side), (255, 255, 255))
    draw = ImageDraw.Draw(page)
    for ray in range(24):
        angle, turn = 2 * np.pi * ray / 24, np.pi / 24
        ends = [
            (side * (0.74 + 0.23 * np.cos(a)), side * (0.27 + 0.23 * np.sin(a)))
            for a in (angle, angle + turn)
        ]
        draw.polygon([(0.74 * side, 0.27 * side), *ends], fill=(190, 20, 30))
    for ring in range(9, 0, -1):
        radius = 0.024 * side * ring
        box = [
            0.27 * side - radius,
            0.73 * side - radius,
            0.27 * side + radius,
            0.73 * side + radius,
        ]
        draw.ellipse(box, fill=(20, 40, 150) if ring % 2 else (240, 200, 40))
    font = ImageFont.truetype("DejaVuSans-Bold.ttf", side * 3 // 10)
    draw.text((0.04 * side, 0.04 * side), "Rg", font=font, fill=(0, 0, 0))
    draw.text((0.53 * side, 0.55 * side), "a&", font=font, fill=(0, 110, 60))
    fine = prefilter.to_linear(np.asarray(page)[::-1].astype(np.float32) / 255)
    return prefilter.resize(fine, size, size, filter="box")


def sheet(cells: list[tuple[Array, str]], columns: int) -> Image.Image:
    """Puts pictures in rows, with a line under each."""
    rows = -(-len(cells) // columns)
    step = SIZE + GAP + TEXT + 6
    page = Image.new("RGB", (GAP + columns * (SIZE + GAP), GAP + rows * step), PAPER)
    draw = ImageDraw.Draw(page)
    font = ImageFont.truetype("DejaVuSans.ttf", TEXT - 2)
    for index, (values, note) in enumerate(cells):
        left, top = GAP + index % columns * (SIZE + GAP), GAP + index // columns * step
        encoded = prefilter.to_srgb(values.clip(0, 1))[::-1]
        page.paste(Image.fromarray(np.rint(255 * encoded).astype(np.uint8)), (left, top))
        draw.text((left + SIZE // 2, top + SIZE + 5), note, fill=INK, font=font, anchor="mt")
    return page


if __name__ == "__main__":
    main(Path(sys.argv[1]))
