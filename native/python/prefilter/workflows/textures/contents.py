# SPDX-License-Identifier: GPL-3.0-or-later

"""Computing levels according to an image's content: color, data, cut-out, or normal map."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import prefilter

from ...options.textures import TEXTURE_SPACE_FILTERS
from ..picture import Encoding, FloatArray, Picture, Texels, as_srgb, automatic_bounds
from ..progress import Progress, share
from .blocks import is_gray

Bounds = tuple[float | None, float | None] | None

CHANNELS = {"all": (0, 1, 2), "red": (0,), "green": (1,), "blue": (2,)}
"""Indices of the image channels that hold roughness, by the key of the choice."""


@dataclass(frozen=True)
class Roughness:
    """The roughness that belongs to a normal map.

    Attributes:
        picture: The image.
        linear: Its values as a shader reads them, in the size of the normal map.
        channels: A key of `CHANNELS`.
        texture_format: A key of `choices.TEXTURE_FORMATS`, for its file.
    """

    picture: Picture
    linear: FloatArray
    channels: str
    texture_format: str = "auto"


def as_content(picture: Picture, content: str) -> Picture:
    """Returns the picture with its values interpreted as the given content."""
    if content in {"normal", "data"}:
        # Blender stores float images as light in any color space; levels must declare that.
        space = picture.linear_space if picture.is_float else picture.colorspace
        changed = replace(picture, encoding=Encoding.NONE, is_data=True, colorspace=space)
        return picture if picture.is_data else changed
    if picture.is_data and not picture.is_float and (content == "color" or picture.shape[2] == 4):
        picture = as_srgb(picture)
    return replace(picture, is_data=False, covers=picture.covers or content == "cutout")


def check_cutout(picture: Picture) -> None:
    """Raises ValueError if an alpha test of the picture makes no sense."""
    if picture.shape[2] == 3 and not is_gray(picture):
        raise ValueError(
            f"image '{picture.name}': has no alpha, and is not a grayscale mask; a cut-out needs "
            f"alpha that is not 1 everywhere, or a grayscale image"
        )


def check_roughness(picture: Picture, roughness: Picture) -> None:
    """Raises ValueError if a roughness image does not fit the normal map."""
    if roughness.full_name == picture.full_name:
        raise ValueError(f"Roughness: '{roughness.name}' is the normal map itself")
    (height, width), (high, wide) = picture.shape[:2], roughness.shape[:2]
    if (high, wide) != (height, width):
        raise ValueError(
            f"Roughness: '{roughness.name}' has {wide} x {high} texels, and "
            f"'{picture.name}' has {width} x {height}; they must be the same"
        )


def plain_levels(
    picture: Picture,
    texels: Texels,
    surfaces: Sequence[prefilter.Surface] | None,
    bounds: Bounds,
    progress: Progress,
    **options: Any,
) -> list[FloatArray]:
    """Returns levels 1 and up of color or data, from light or from bytes."""
    return prefilter.coarser_levels(
        texels,
        surfaces,
        bounds=bounds,
        premultiplied=not picture.alpha_is_straight,
        progress=progress,
        **options,
    )


def cutout_levels(
    picture: Picture,
    linear: FloatArray,
    surfaces: Sequence[prefilter.Surface] | None,
    bounds: Bounds,
    threshold: float,
    progress: Progress,
    **options: Any,
) -> list[FloatArray]:
    """Returns levels 1 and up of color whose alpha test preserves the coverage of level 0.

    Without an alpha channel, the image itself is tested.
    """
    is_mask = linear.shape[2] == 3
    tested = np.ascontiguousarray(linear[..., :1]) if is_mask else linear
    unscaled = plain_levels(picture, tested, surfaces, bounds, share(progress, 0.0, 0.6), **options)
    scaled = prefilter.keep_coverage(
        [tested, *unscaled],
        None if options["filter"] in TEXTURE_SPACE_FILTERS else surfaces,
        threshold=threshold,
        wrap=options["wrap"],
        premultiplied=picture.alpha_is_coverage and not picture.alpha_is_straight,
        progress=share(progress, 0.6, 1.0),
        threads=options["threads"],
    )
    return [np.repeat(level, 3, axis=2) for level in scaled] if is_mask else scaled


def normal_levels(
    linear: FloatArray,
    surfaces: Sequence[prefilter.Surface] | None,
    roughness: Roughness | None,
    progress: Progress,
    **options: Any,
) -> tuple[list[FloatArray], list[FloatArray]]:
    """Returns the levels of a normal map, and those of its roughness; none without roughness.

    A fourth channel of the normal map, and channels of the roughness image other than roughness,
    are filtered as data.
    """
    normals = np.ascontiguousarray(linear[..., :3])
    filtered_normals: list[FloatArray] = []
    rough: list[FloatArray] = []
    steps = 4
    if roughness is None:
        filtered_normals = prefilter.normal_mipmaps(
            normals, surfaces, progress=share(progress, 0.0, 3 / steps), **options
        )
    else:
        rough = prefilter.mipmaps(
            roughness.linear,
            surfaces,
            premultiplied=True,
            bounds=automatic_bounds(roughness.linear),
            progress=share(progress, 0.0, 1 / steps),
            **options,
        )
        finished: list[tuple[FloatArray, list[FloatArray]]] = []
        for channel in CHANNELS[roughness.channels]:
            values = np.ascontiguousarray(roughness.linear[..., channel : channel + 1])
            same = [levels for other, levels in finished if np.array_equal(other, values)]
            if not same:
                start = (1 + len(finished) / 2) / steps
                filtered_normals, levels = prefilter.normal_mipmaps(
                    normals,
                    surfaces,
                    roughness=values,
                    progress=share(progress, start, start + 0.5 / steps),
                    **options,
                )
                finished.append((values, levels))
                same = [levels]
            for whole, part in zip(rough, same[0], strict=True):
                whole[..., channel : channel + 1] = part
    if linear.shape[2] == 4:
        fourth = prefilter.mipmaps(
            np.ascontiguousarray(linear[..., 3:]),
            surfaces,
            bounds=(0.0, 1.0),
            progress=share(progress, 3 / steps, 1.0),
            **options,
        )
        filtered_normals = [
            np.concatenate([level, last], axis=2)
            for level, last in zip(filtered_normals, fourth, strict=True)
        ]
    return filtered_normals, rough
