# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the pictures of shapes for docs/benchmarks/shapes.md and docs/algorithms.md.

usage: python3 shapes.py FOLDER        (with the package prefilter importable)

Leaves FOLDER/patterns.png (figures 2.5 and 2.6), FOLDER/abutting.png, FOLDER/gaps.png
(figure 3.3) and, where the drawings gathered beside the checkout are, FOLDER/tiger.png.
"""

import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray
from PIL import Image
from sheets import encoded, sheet

Array = NDArray[np.float32]

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "svg"
FILTERS = ("box", "tent", "mitchell", "lanczos3", "radial3")
CELL = 256
QUAD_COLOR = np.array([0.10, 0.32, 0.65], np.float32)
TIGER_SMALL = 64
TIGER_CELL = 384


def main(folder: Path) -> None:
    """Makes all pictures."""
    patterns().save(folder / "patterns.png")
    abutting().save(folder / "abutting.png")
    gaps().save(folder / "gaps.png")
    drawing = DATA / "Ghostscript_Tiger.svg"
    if drawing.exists():
        tiger(drawing).save(folder / "tiger.png")


def patterns() -> Image.Image:
    """Lines in perspective, a star and rings, each by several filters."""
    cells = []
    for shape, size in ((fan(), 128), (star(), 64), (rings(), 64)):
        for name in FILTERS:
            found = prefilter.rasterize([shape], size, size, filter=name)
            cells.append((shown(1 - found, CELL), name))
    return sheet(cells, len(FILTERS))


def gaps() -> Image.Image:
    """An outline whose sides do not meet, by both methods, and the wavelets at smaller depths."""
    size = 128
    outline = torn_star(size)
    strokes = prefilter.rasterize([outline.stroked(1.0)], size, size)
    cells = [(shown(1 - strokes, CELL), "outline")]
    for name, note in (("scanline", "scanline, each side closed"), ("wavelet", "wavelet")):
        found = prefilter.rasterize([outline], size, size, method=name)
        cells.append((shown(1 - found, CELL), note))
    for depth in (3, 4, 5):
        found = prefilter.rasterize([outline], size, size, method="wavelet", depth=depth)
        cells.append((shown(1 - found, CELL), f"wavelet, depth {depth}"))
    return sheet(cells, 3)


def torn_star(size: int) -> prefilter.Shape:
    """A star of 7 tips with a hole, each side a separate contour that ends before its corner."""
    shape = prefilter.Shape()
    for radii, direction, bend in (((0.46, 0.24), 1, 0.03), ((0.13, 0.13), -1, 0.0)):
        angles = 0.5 * np.pi + direction * np.pi * np.arange(15) / 7
        lengths = size * np.array([radii[i % 2] for i in range(15)])
        corners = 0.5 * size + lengths[:, None] * np.stack([np.cos(angles), np.sin(angles)], -1)
        for begin, end in pairwise(corners):
            along = end - begin
            first, last = begin + 0.03 * along, end - 0.03 * along
            middle = 0.5 * (begin + end) + bend * size * np.array([-along[1], along[0]]) / 30
            shape.move_to(*first)
            shape.curve_to(*middle, *last)
    return shape


def fan() -> prefilter.Shape:
    """A plane of lines, 1/4 a pixel at the bottom and 2 a pixel at the top of 128 pixels."""
    shape = prefilter.Shape()
    for left in np.arange(-128, 128):
        near, far = 64 + 4 * (left + np.array([0, 0.5])), 64 + 0.5 * (left + np.array([0, 0.5]))
        shape.add_polygon([(near[0], 0), (near[1], 0), (far[1], 128), (far[0], 128)])
    return shape


def star() -> prefilter.Shape:
    """32 triangles around the middle of 64 pixels."""
    shape = prefilter.Shape()
    for angle in 2 * np.pi * np.arange(32) / 32:
        sides = angle + 2 * np.pi * np.array([-0.25, 0.25]) / 32
        tips = 32 + 31 * np.stack([np.cos(sides), np.sin(sides)], axis=1)
        shape.add_polygon([(32, 32), *tips])
    return shape


def rings() -> prefilter.Shape:
    """A quarter of 32 rings of the same area, by quadratic curves, in 64 pixels."""
    shape = prefilter.Shape()
    radii = 64 * np.sqrt(np.arange(1, 65) / 64)
    for inner, outer in zip(radii[::2], radii[1::2], strict=True):
        shape.move_to(outer, 0)
        for control, end in arc(outer, 0, np.pi / 2):
            shape.curve_to(*control, *end)
        shape.line_to(0, inner)
        for control, end in arc(inner, np.pi / 2, 0):
            shape.curve_to(*control, *end)
        shape.close()
    return shape


def arc(radius: float, begin: float, end: float) -> Iterator[tuple[Array, Array]]:
    """Yields control points and ends of two quadratic curves around the origin."""
    for first, last in pairwise(np.linspace(begin, end, 3)):
        middle = (first + last) / 2
        reach = radius / np.cos((last - first) / 2)
        yield (
            reach * np.array([np.cos(middle), np.sin(middle)]),
            radius * np.array([np.cos(last), np.sin(last)]),
        )


def abutting() -> Image.Image:
    """Quads side by side that cover 64 x 64 pixels, composited one after another, and added."""
    quads = []
    for left in range(0, 64, 8):
        bottom = [left, left + 8]
        top = [x if x in (0, 64) else x + 3 for x in bottom]
        corners = [(bottom[0], 0), (bottom[1], 0), (top[1], 64), (top[0], 64)]
        quads.append(prefilter.Shape())
        quads[-1].add_polygon(np.array(corners, float))
    composited = np.zeros((64, 64, 1), np.float32)
    for quad in quads:
        coverage = prefilter.rasterize([quad], 64, 64)
        composited += coverage * (1 - composited)
    added = prefilter.rasterize(quads, 64, 64, overlap="add")
    cells = []
    for found, how in ((composited, "composited"), (added, "added")):
        print(f"abutting quads, {how}: lowest {np.floor(255 * found.min() + 0.5):.0f} of 255")
        cells.append((shown(found * QUAD_COLOR, CELL), how))
    return sheet(cells, 2)


def tiger(drawing: Path) -> Image.Image:
    """The drawing at 64 pixels by two filters, and large."""
    svg = prefilter.read_svg(drawing, light="linear")
    cells = []
    for size, name in ((TIGER_SMALL, "box"), (TIGER_SMALL, "mitchell"), (TIGER_CELL, "mitchell")):
        found = prefilter.rasterize(
            svg.shapes_for(size, size), size, size, filter=name, overlap="cover"
        )
        over_white = found[..., :3] + 1 - found[..., 3:]
        cells.append((shown(over_white, TIGER_CELL), f"{name}, {size} x {size}"))
    return sheet(cells, len(cells))


def shown(light: Array, side: int) -> Array:
    """Returns sRGB with rows from the top, pixels enlarged to squares."""
    times = side // light.shape[0]
    large = encoded(light)[::-1].repeat(times, axis=0).repeat(times, axis=1)
    return np.broadcast_to(large, (*large.shape[:2], 3)) if light.shape[2] == 1 else large


if __name__ == "__main__":
    main(Path(sys.argv[1]))
