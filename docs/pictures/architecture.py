# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws the layers of Prefilter for docs/architecture.md.

usage: python3 architecture.py FOLDER        (with the package prefilter importable)

Leaves FOLDER/architecture.png. The drawing is an SVG document, which `prefilter.rasterize_svg`
renders.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import prefilter
from PIL import Image

WIDTH, MARGIN, GAP = 900, 24, 14
ROW = 92  # height of a box
INK, PAPER, LINE = "#1d2b33", "#ffffff", "#5d7078"

# From the top: title, color, rows of boxes as (name, contents). Each layer uses only lower ones.
LAYERS: tuple[tuple[str, str, Sequence[Sequence[tuple[str, str]]]], ...] = (
    (
        "addon/   Blender add-on",
        "#dcefe9",
        (
            (
                ("textures", "texture_cache"),
                ("images", "shapes"),
                ("voxels", "comparison"),
                ("points", "welcome"),
            ),
            (("bridge", "Blender \u2194 numpy"), ("core", "operators, options, queue")),
        ),
    ),
    (
        "native/python/prefilter/   Python package",
        "#fdf1d4",
        (
            (
                ("commands", "program prefilter"),
                ("workflows", "shared jobs"),
                ("options", "for users to set"),
            ),
            (
                ("images", "textures"),
                ("meshes", "voxels"),
                ("points", "shapes"),
                ("sampling", "files"),
            ),
        ),
    ),
    (
        "native/prefilter/   C++ library, in nine wings",
        "#e3e8f6",
        (
            (("points", "scans to surfaces"),),
            (
                ("textures", "mipmaps, blocks"),
                ("sampling", "tables, samples"),
                ("shapes", "SVG, outlines"),
                ("voxels", "solids, contours"),
            ),
            (("wavelet", "octrees of cell means"),),
            (("geometry", "meshes, moments"), ("images", "filters, resize")),
            (("base", "vectors, threads, files, solvers"),),
        ),
    ),
)


def main(folder: Path) -> None:
    """Makes the picture."""
    source, height = drawing()
    pixels, _ = prefilter.rasterize_svg(source, WIDTH, height, dtype=np.uint8)
    Image.fromarray(pixels[::-1, :, :3].copy()).save(folder / "architecture.png")


def drawing() -> tuple[bytes, int]:
    """Returns the SVG document and its height."""
    parts: list[str] = []
    y = MARGIN
    for title, color, rows in LAYERS:
        height = 56 + len(rows) * (ROW + GAP)
        parts.append(_rectangle(MARGIN, y, WIDTH - 2 * MARGIN, height, color, LINE))
        parts.append(_text(MARGIN + GAP + 4, y + 38, title, 28, "start"))
        for number, row in enumerate(rows):
            top = y + 56 + number * (ROW + GAP)
            width = (WIDTH - 2 * MARGIN - GAP * (len(row) + 1)) / len(row)
            for column, (name, contents) in enumerate(row):
                left = MARGIN + GAP + column * (width + GAP)
                parts.append(_rectangle(left, top, width, ROW, PAPER, LINE))
                middle = left + width / 2
                parts.append(_text(middle, top + 42, name, 27))
                parts.append(_text(middle, top + 75, contents, 22))
        y += height
        if title != LAYERS[-1][0]:
            parts.append(_arrow(WIDTH / 2, y, y + 44))
            y += 44
    height = y + MARGIN
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}">'
    paper = f'<rect width="100%" height="100%" fill="{PAPER}"/>'
    return "".join([head, paper, *parts, "</svg>"]).encode(), height


def _rectangle(x: float, y: float, width: float, height: float, fill: str, stroke: str) -> str:
    return (
        f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" rx="8" '
        f'fill="{fill}" stroke="{stroke}" stroke-width="2"/>'
    )


def _text(x: float, y: float, text: str, size: int, anchor: str = "middle") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-family="DejaVu Sans" font-size="{size}" '
        f'fill="{INK}" text-anchor="{anchor}">{text}</text>'
    )


def _arrow(x: float, top: float, bottom: float) -> str:
    return (
        f'<path d="M{x} {top + 6}V{bottom - 16}" stroke="{LINE}" stroke-width="4"/>'
        f'<path d="M{x - 11} {bottom - 20}h22l-11 16z" fill="{LINE}"/>'
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
