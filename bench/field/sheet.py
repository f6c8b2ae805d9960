# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws many results on one sheet, for an eye to look over."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from bench.field.runs import Run
from bench.points import sheet as surfaces

SIDE = 160
CAPTION = 14
MAX_RESULTS = 600
_COLUMNS = 16
_CHECKER = 8


def write(path: Path, runs: Sequence[Run]) -> None:
    """Draws results that are pictures or surfaces; those with findings have a red caption."""
    runs = [one for one in runs if one.target.exists()][:MAX_RESULTS]
    columns = min(_COLUMNS, max(1, len(runs)))
    rows = max(1, math.ceil(len(runs) / columns))
    page = Image.new("RGB", (columns * SIDE, rows * (SIDE + CAPTION)), "white")
    draw = ImageDraw.Draw(page)
    for number, one in enumerate(runs):
        x, y = number % columns * SIDE, number // columns * (SIDE + CAPTION)
        if (tile := _tile(one.target)) is not None:
            page.paste(tile, (x, y))
        color = (200, 0, 0) if one.findings else (0, 0, 0)
        draw.text((x + 2, y + SIDE + 1), one.source.name[:26], fill=color)
    page.save(path)


def _tile(path: Path) -> Image.Image | None:
    if path.suffix == ".ply":
        frame = surfaces.frame_of(surfaces.VIEW, surfaces.UP)
        try:
            middle, half = surfaces.window(path, frame, (0, 0, 1))
        except (ValueError, IndexError):
            return None
        pixels = surfaces.picture(path, frame, middle, half)
        return _fitted(Image.fromarray(np.uint8(255 * pixels.clip(0, 1))))
    if path.suffix == ".png":
        with Image.open(path) as image:
            return _fitted(_on_checker(image.convert("RGBA")))
    return None


def _fitted(image: Image.Image) -> Image.Image:
    image.thumbnail((SIDE - 2, SIDE - 2))
    return image


def _on_checker(image: Image.Image) -> Image.Image:
    """Puts a picture on a checkerboard, so that alpha shows."""
    y, x = np.mgrid[: image.height, : image.width]
    is_dark: NDArray[np.bool_] = (x // _CHECKER + y // _CHECKER) % 2 == 0
    board = Image.fromarray(np.where(is_dark, 220, 255).astype(np.uint8)).convert("RGBA")
    return Image.alpha_composite(board, image).convert("RGB")
