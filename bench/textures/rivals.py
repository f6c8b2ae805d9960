# SPDX-License-Identifier: GPL-3.0-or-later

"""Filters that PAM is measured against, on the original image and on one without background.

Names say the filter, then how it is sharpened, then whether the image was dilated first: its
texels that no triangle touches are filled from those that one does, by push-pull. The image is
scene-linear and the levels are clipped to the bounds, whatever the filter.
"""

from dataclasses import dataclass

import numpy as np
import prefilter

from bench.textures import maketx_levels, subjects
from bench.textures.sampling import Floats, Texels, wrapped
from bench.textures.subjects import Subject

LEAST_SQUARES = "ls-bilinear"
KAISER = "kaiser"
DILATED = ", dilated"
SHARPEN = 0.5
SHARPENED = f" --sharpen {SHARPEN:g}"
MAKETX = (
    "maketx box",
    f"maketx box{SHARPENED}",
    "maketx lanczos3",
    f"maketx lanczos3{SHARPENED}",
    "maketx radial-lanczos3",  # Sharp by itself.
    "maketx rifman",
    f"maketx rifman{SHARPENED}",
)
OWN = (
    "box",
    "tent",
    "lanczos3",
    "box-covered",
    "tent-covered",
    "lanczos3-covered",
    "pam-box",
)
TEXTURE_SPACE = (*MAKETX, KAISER, LEAST_SQUARES)
"""The filters that also get the dilated image."""

KAISER_WIDTH = 3.0
KAISER_ALPHA = 4.0
_KAISER_SAMPLES = 32  # Samples per texel over which the kernel is averaged.


@dataclass(frozen=True)
class Rivals:
    """The levels of all of them for one subject.

    Attributes:
        subject: The image and its surfaces.
        dilated: The image without background.
    """

    subject: Subject
    dilated: Texels

    @classmethod
    def of(cls, subject: Subject) -> "Rivals":
        """Dilates the image of a subject."""
        return cls(subject, _dilated(subject))

    @staticmethod
    def names() -> list[str]:
        """Returns those that this machine can make."""
        made = [name for name in TEXTURE_SPACE if name not in MAKETX]
        if maketx_levels.is_available():
            made = list(TEXTURE_SPACE)
        return [*OWN, *made, *(name + DILATED for name in made)]

    def levels(self, name: str, bounds: tuple[float, float]) -> list[Texels]:
        """Returns all levels; level 0 is the image itself."""
        filter = name.removesuffix(DILATED)
        image = self.subject.image if filter == name else self.dilated
        return [self.subject.image, *self._made(image, filter, bounds)[1:]]

    def _made(self, image: Texels, filter: str, bounds: tuple[float, float]) -> list[Texels]:
        wrap = self.subject.wrap
        if filter == KAISER:
            return [level.clip(*bounds) for level in kaiser_levels(image, wrap)]
        if filter in MAKETX:
            kernel = filter.removeprefix("maketx ").removesuffix(SHARPENED)
            sharpen = SHARPEN if filter.endswith(SHARPENED) else 0.0
            made = maketx_levels.levels(image, filter=kernel, wrap=wrap, sharpen=sharpen)
            return [level.clip(*bounds) for level in made]
        return prefilter.mipmaps(
            image,
            self.subject.surfaces,
            filter=filter,
            wrap=wrap,
            bounds=bounds,
            premultiplied=True,
        )


def is_least_squares(name: str) -> bool:
    """Tells whether a rival is least squares without a mesh."""
    return name.removesuffix(DILATED) == LEAST_SQUARES


def kaiser_levels(image: Texels, wrap: str) -> list[Texels]:
    """Returns the levels of a sinc under a Kaiser window, each made from the one before.

    The NVIDIA Texture Tools do it this way: three texels of the new level to either side, alpha 4,
    and the kernel averaged over the texels of the level before.

    Raises:
        ValueError: A side is odd where it is to be halved.
    """
    made = [image]
    while max(made[-1].shape[:2]) > 1:
        level = made[-1].astype(np.float64)
        for axis in (0, 1):
            if level.shape[axis] > 1:
                level = _halved(level, axis, wrap)
        made.append(level.astype(np.float32))
    return made


def _halved(level: Floats, axis: int, wrap: str) -> Floats:
    size = level.shape[axis]
    if size % 2:
        raise ValueError(f"image: found a side of {size} texels; Kaiser levels need even ones")
    taps = np.arange(-2 * int(KAISER_WIDTH), 2 * int(KAISER_WIDTH)) + 1
    within = (np.arange(_KAISER_SAMPLES) + 0.5) / _KAISER_SAMPLES
    weights = _kaiser((taps[:, None] - 1 + within) / 2).mean(axis=1)
    weights /= weights.sum()
    centers = 2 * np.arange(size // 2)
    return sum(
        weight * level.take(wrapped(centers + tap, size, wrap), axis=axis)
        for tap, weight in zip(taps, weights, strict=True)
    )


def _kaiser(x: Floats) -> Floats:
    """Returns the kernel at distances in texels of the new level."""
    inside = np.maximum(1 - (x / KAISER_WIDTH) ** 2, 0)
    return np.sinc(x) * np.i0(KAISER_ALPHA * np.sqrt(inside)) / np.i0(KAISER_ALPHA)


def _dilated(subject: Subject) -> Texels:
    image = subject.image
    height, width, channels = image.shape
    touched = subjects.touched_texels(subject.uvs, width, height, subject.wrap)
    mask = touched[..., None].astype(np.float32)
    # The library's fill takes up to three channels and the mask.
    parts = [image[..., k : k + 3] for k in range(0, channels, 3)]
    filled = [
        prefilter.fill_transparent(np.concatenate([part, mask], axis=2), wrap=subject.wrap)
        for part in parts
    ]
    return np.concatenate([part[..., :-1] for part in filled], axis=2)
