# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures side by side, each with a line of text."""

from collections.abc import Sequence

import numpy as np
import prefilter
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Array = NDArray[np.float64]

PAPER, INK = (246, 246, 244), (40, 40, 40)
GAP, TEXT = 16, 18


def encoded(light: Array) -> Array:
    """Encodes sRGB, clipped."""
    return prefilter.to_srgb(np.clip(light, 0, 1).astype(np.float32))


def sheet(cells: Sequence[tuple[Array, str]], columns: int) -> Image.Image:
    """Puts pictures of one size in rows, with a line under each."""
    high, wide = cells[0][0].shape[:2]
    rows = -(-len(cells) // columns)
    size = (GAP + columns * (wide + GAP), GAP + rows * (high + GAP + TEXT + 6))
    page = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(page)
    font = ImageFont.load_default(size=TEXT - 3)
    for index, (pixels, note) in enumerate(cells):
        left = GAP + index % columns * (wide + GAP)
        top = GAP + index // columns * (high + GAP + TEXT + 6)
        page.paste(Image.fromarray(np.round(255 * pixels).astype(np.uint8)), (left, top))
        draw.text((left + wide // 2, top + high + 4), note, fill=INK, font=font, anchor="mt")
    return page
