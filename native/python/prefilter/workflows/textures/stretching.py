# SPDX-License-Identifier: GPL-3.0-or-later

"""Stretching images to sides that readers of compressed blocks need."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np

import prefilter

from ..files import engines
from ..picture import FloatArray, Picture, Texels, encoded, scene_linear
from ..progress import Progress, go_on, share
from ..wording import Sentence
from .outputs import Outputs
from .source import Source

_WHITE = 255


def stretch(source: Source, outputs: Outputs, progress: Progress) -> tuple[Outputs, list[str]]:
    """Stretches images for block formats to the sides that readers need.

    Returns:
        The outputs, with stretched roughness; and notes on stretched images.

    Raises:
        prefilter.Cancelled: `progress` returned False.
        ValueError: A texel is not finite.
    """
    settings, rough, notes = source.settings, outputs.roughness, []
    if not settings.use_multiples_of_4:
        return outputs, []
    size = size_for(source.picture, outputs.target, settings.texture_format)
    if rough is not None:
        # Both images have one size, so they are stretched together.
        own = size_for(rough.picture, outputs.roughness_target, rough.texture_format)
        size = max(size, own)
    change = partial(
        stretched,
        size=size,
        wrap=source.wrap,
        progress=share(progress, 0.0, 0.0),
        check=partial(go_on, progress, 0.0),
        threads=settings.threads,
    )
    if size == source.picture.shape[1::-1]:
        return outputs, []
    if outputs.writes_image:
        notes.append(note(source.picture, size))
    source.picture = change(source.picture, is_normal_map=source.content == "normal")
    if rough is not None:
        notes.append(note(rough.picture, size))
        picture = change(rough.picture)
        rough = replace(rough, picture=picture, linear=scene_linear(picture))
    return replace(outputs, roughness=rough), notes


def size_for(picture: Picture, target: Path | None, texture_format: str) -> tuple[int, int]:
    """Returns the width and height that readers of a picture's file need."""
    height, width, _ = picture.shape
    unit = engines.unit_of_sides(picture, target, texture_format)
    return -(-width // unit) * unit, -(-height // unit) * unit


def stretched(
    picture: Picture,
    size: tuple[int, int],
    wrap: tuple[str, str],
    progress: Progress,
    check: Callable[[], None],
    *,
    is_normal_map: bool = False,
    threads: int = 0,
) -> Picture:
    """Returns a resized picture whose values stay within their original range.

    Args:
        picture: Any picture.
        size: Width and height.
        wrap: Wrap modes along u and v.
        progress: Called with the fraction done.
        check: Called between stages of a slow conversion.
        is_normal_map: Whether its texels are normals, which are renormalized.
        threads: How many to use; 0 for all.

    Raises:
        prefilter.Cancelled: `progress` returned False.
        ValueError: A texel is not finite.
    """
    linear = scene_linear(picture, check)
    try:
        resized = prefilter.resize(
            linear,
            *size,
            filter="lanczos3",
            wrap=cast("Any", wrap),
            premultiplied=not picture.alpha_is_straight,
            progress=progress,
            threads=threads,
        )
    except ValueError as error:
        raise ValueError(f"image '{picture.name}': {error}") from error
    if is_normal_map:
        resized[..., :3] = _normalized(resized[..., :3])
    for channel in range(resized.shape[2]):
        low, high = linear[..., channel].min(), linear[..., channel].max()
        if not is_normal_map or channel == 3:
            np.clip(resized[..., channel], low, high, out=resized[..., channel])
    return replace(picture, texels=_as_stored(picture, encoded(picture, resized, check)))


def note(picture: Picture, size: tuple[int, int]) -> str:
    """Returns a note that a picture is stretched."""
    height, width, _ = picture.shape
    return Sentence(
        "'{}' is stretched from {} x {} to {} x {} texels, as its texture format needs sides "
        "divisible by 4",
        *(picture.name, width, height, *size),
    )


def _normalized(texels: FloatArray) -> FloatArray:
    """Normalizes the vectors of a normal map; zero vectors stay."""
    vectors = 2 * texels - 1
    length = np.sqrt((vectors**2).sum(axis=2, keepdims=True))
    unit = vectors / np.where(length > 0, length, 1)
    return np.asarray((unit + 1) / 2, np.float32)


def _as_stored(picture: Picture, values: FloatArray) -> Texels:
    if picture.texels.dtype != np.uint8:
        return values
    return np.asarray(np.rint(values.clip(0, 1) * _WHITE), np.uint8)
