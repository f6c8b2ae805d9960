# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes pictures as small PNG files of at most 256 colors.

usage: python3 shrink.py FOLDER PICTURE...
"""

import sys
from pathlib import Path

from PIL import Image

WIDTH = 1400

folder = Path(sys.argv[1])
for name in sys.argv[2:]:
    picture = Image.open(name).convert("RGB")
    if picture.width > WIDTH:
        height = round(picture.height * WIDTH / picture.width)
        picture = picture.resize((WIDTH, height), Image.Resampling.LANCZOS)
    # Pillow dithers with a given palette only.
    small = picture.quantize(palette=picture.quantize(256), dither=Image.Dither.FLOYDSTEINBERG)
    small.save(folder / Path(name).with_suffix(".png").name, optimize=True)
