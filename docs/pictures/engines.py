# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the picture of docs/engines.md: a level in file formats, read back by OpenImageIO.

usage: python3 engines.py FOLDER        (with the package prefilter importable)

Leaves FOLDER/engines.png, and prints the errors.
"""

import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import prefilter
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Bytes = NDArray[np.uint8]

PAPER, INK = (246, 246, 244), (40, 40, 40)
GAP, TEXT = 16, 18
SIZE = 512
LEVEL = 2
SHOWN = 64  # Texels along each side of the part that is shown.
ZOOM = 6
GAIN = 3


def main(folder: Path) -> None:
    """Makes the picture."""
    levels = prefilter.mipmaps(texture(), filter="box", encoding="srgb")[LEVEL:]
    path = folder / "level.dds"
    straight = oiio.ImageSpec()
    straight.attribute("oiio:UnassociatedAlpha", 1)
    cells = []
    for name, title in (("rgba8", "8-bit"), ("bc7", "BC7"), ("bc1", "BC1")):
        prefilter.write_dds(path, levels, format=name, encoding="srgb")
        file = oiio.ImageInput.open(str(path), straight)
        found = np.asarray(file.read_image("uint8"))[::-1].astype(float)
        bits = 8 * path.stat().st_size / sum(level.shape[0] * level.shape[1] for level in levels)
        alpha = levels[0][..., 3:] / 255.0
        difference = (found[..., :3] - levels[0][..., :3]) * alpha
        error = np.sqrt(np.mean(difference**2))
        print(f"{title}: {error:.2f} steps of 8 bits, {bits:.1f} bits a texel")
        cells.append((over_gray(found), f"{title}: {bits:.0f} bits a texel"))
        if name != "rgba8":
            shown = np.clip(128 + GAIN * difference, 0, 255)
            cells.append((shown, f"{title}: error x {GAIN}, {error:.1f} / 255"))
    path.unlink()
    sheet(cells).save(folder / "engines.png")


def texture() -> Bytes:
    """Straight RGBA: letters, discs of any color, a soft gradient, and a round edge."""
    random = np.random.default_rng(7)
    y, x = np.mgrid[0 : 1 : SIZE * 1j, 0 : 1 : SIZE * 1j]
    waves = [np.sin(5 * x + 3 * y + c) * np.cos(4 * y - 2 * x + 2 * c) for c in range(3)]
    base = np.stack([110 + 70 * wave for wave in waves], axis=2)
    picture = Image.fromarray(base.astype(np.uint8))
    draw = ImageDraw.Draw(picture)
    for _ in range(70):
        (left, top), radius = random.integers(0, SIZE, 2), random.integers(8, 34)
        color = tuple(int(value) for value in random.integers(0, 256, 3))
        draw.ellipse((left - radius, top - radius, left + radius, top + radius), fill=color)
    font = ImageFont.truetype("DejaVuSans-Bold.ttf", 56)
    draw.text((36, SIZE // 2 - 100), "Text", font=font, fill=(255, 255, 255))
    draw.text((36, SIZE // 2), "on discs", font=font, fill=(20, 20, 20))
    radius = np.hypot(x - 0.5, y - 0.5)
    alpha = np.clip((0.49 - radius) * 40, 0, 1)
    return np.dstack([np.asarray(picture), (255 * alpha).astype(np.uint8)])[::-1].copy()


def over_gray(rgba: NDArray[np.float64]) -> NDArray[np.float64]:
    """The colors over the gray that an error of zero has."""
    alpha = rgba[..., 3:] / 255
    return rgba[..., :3] * alpha + 128 * (1 - alpha)


def sheet(cells: list[tuple[NDArray[np.float64], str]]) -> Image.Image:
    """Sets magnified middles of the pictures side by side, each above its title."""
    side = SHOWN * ZOOM
    made = Image.new("RGB", ((side + GAP) * len(cells) + GAP, side + 3 * GAP + TEXT), PAPER)
    draw = ImageDraw.Draw(made)
    font = ImageFont.truetype("DejaVuSans.ttf", TEXT)
    for number, (values, title) in enumerate(cells):
        start = values.shape[0] // 2 - SHOWN // 2
        part = values[::-1][start : start + SHOWN, :SHOWN]
        image = Image.fromarray(np.rint(part).astype(np.uint8))
        left = GAP + number * (side + GAP)
        made.paste(image.resize((side, side), Image.Resampling.NEAREST), (left, GAP))
        draw.text((left, side + 2 * GAP - 4), title, font=font, fill=INK)
    return made


if __name__ == "__main__":
    main(Path(sys.argv[1]))
