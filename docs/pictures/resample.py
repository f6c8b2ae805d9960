# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the picture of docs/resample.md: an image pinned by its corners, and close-ups by method.

usage: blender --background --python resample.py -- TARGET.png        (with the extension installed)

Prints how far the close-ups are from the exact one.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parent))

from resize import drawn
from sheets import PAPER, encoded, sheet

Array = NDArray[np.float32]

SIDE = 1024
SIZE = WIDTH, HEIGHT = 640, 400
CORNERS = {
    "lower_left": (0.02, 0.05),
    "lower_right": (0.98, 0.13),
    "upper_right": (0.70, 0.95),
    "upper_left": (0.36, 0.82),
}
LEFT, BOTTOM, MAGNIFIED = 318, 262, 4  # Corner of the close-ups, and their scale.
METHODS = {"exact": "Exact", "8": "8 Texels", "trilinear": "Trilinear"}


def main(target: Path) -> None:
    """Makes the picture."""
    made = {method: pinned(method) for method in METHODS}
    cells = [(encoded(made["exact"]), f"{SIDE} x {SIDE} pixels, pinned by their corners")]
    for method, label in METHODS.items():
        note = label
        if method != "exact":
            error = np.mean((made[method] - made["exact"]) ** 2, dtype=np.float64)
            note = f"{label}, {-10 * np.log10(error):.1f} dB"
            print(note)
        part = made[method][BOTTOM:, LEFT:][: HEIGHT // MAGNIFIED, : WIDTH // MAGNIFIED]
        large = part.repeat(MAGNIFIED, axis=0).repeat(MAGNIFIED, axis=1)
        cells.append((encoded(large), note))
    sheet([(pixels[::-1], note) for pixels, note in cells], columns=2).save(target)


def pinned(method: str) -> Array:
    """Returns (height, width, 3) scene-linear values, row 0 at the bottom, on the page's paper."""
    light = np.ones((SIDE, SIDE, 4), np.float32)
    light[..., :3] = drawn(SIDE)
    image = bpy.data.images.new("Picture", SIDE, SIDE, alpha=True, float_buffer=True)
    image.pixels.foreach_set(light.ravel())
    bpy.ops.prefilter.resample_image(
        image=image.name,
        warp="corners",
        size="pixels",
        width=WIDTH,
        height=HEIGHT,
        method=method,
        **CORNERS,
    )
    found = bpy.data.images[f"{image.name}.pinned"]
    pixels = np.empty(4 * WIDTH * HEIGHT, np.float32)
    found.pixels.foreach_get(pixels)
    pixels = pixels.reshape(HEIGHT, WIDTH, 4)
    bpy.data.images.remove(found)
    bpy.data.images.remove(image)
    paper = prefilter.to_linear(np.array([[PAPER]], np.float32) / 255)
    return pixels[..., :3] + (1 - pixels[..., 3:]) * paper


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]))
