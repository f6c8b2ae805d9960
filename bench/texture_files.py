# SPDX-License-Identifier: GPL-3.0-or-later

"""Textures of real models, if available."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray
from PIL import Image

FOLDER = Path(__file__).resolve().parents[2] / "shared" / "data" / "textured"
PICTURES = {
    "spot": "spot/spot_texture.png",
    "Duck": "Duck/DuckCM.png",
    "BoomBox": "BoomBox/BoomBox_baseColor.png",
    "AntiqueCamera": "AntiqueCamera/camera_camera_BaseColor.png",
    "DamagedHelmet": "DamagedHelmet/Default_albedo.jpg",
}


def textures() -> Iterator[tuple[str, NDArray[np.float32]]]:
    """Yields names and scene-linear pictures of three channels, row 0 at the bottom."""
    for name, path in PICTURES.items():
        if (FOLDER / path).exists():
            colors = np.asarray(Image.open(FOLDER / path).convert("RGB"))[::-1]
            yield name, prefilter.to_linear(colors.astype(np.float32) / 255)
