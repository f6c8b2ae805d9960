# SPDX-License-Identifier: GPL-3.0-or-later

"""Filtering the levels of an image on its surfaces, and measuring the effect of seam weights."""

from collections.abc import Sequence
from functools import partial
from typing import Any, cast

import prefilter

from ...options.textures import SEAM_FILTERS
from .. import picture as images
from ..picture import FloatArray
from ..progress import Progress, go_on, share
from . import contents
from .source import Source

Levels = list[FloatArray]

_FIRST_FILTERED = 2 / 3  # Progress once the levels are filtered, before they are compared.


def filtered(
    source: Source, roughness: contents.Roughness | None, progress: Progress, *, all_levels: bool
) -> tuple[Levels, Levels, str]:
    """Returns the result of `coarser_levels`, and a note about seams if they were weighted.

    Raises:
        prefilter.Cancelled: `progress` returned False.
        ValueError: The library refuses the image or the surfaces.
    """
    compares = weights_seams(source)
    end = _FIRST_FILTERED if compares else 1.0
    with source.naming_objects():
        image_levels, roughness_levels = coarser_levels(
            source, roughness, share(progress, 0.0, end), all_levels=all_levels
        )
        note = seam_note(source, image_levels, share(progress, end, 1.0)) if compares else ""
    return image_levels, roughness_levels, note


def coarser_levels(
    source: Source, roughness: contents.Roughness | None, progress: Progress, *, all_levels: bool
) -> tuple[Levels, Levels]:
    """Returns levels 1 and up, scene-linear, of an image and of its roughness.

    `all_levels`: all levels, as files need, whatever the settings say.

    Raises:
        prefilter.Cancelled: `progress` returned False.
        ValueError: The library refuses the image or the surfaces.
    """
    settings = source.settings
    options: dict[str, Any] = {
        "filter": settings.filter,
        "wrap": source.wrap,
        "levels": None if all_levels else settings.levels or None,
        "threads": settings.threads,
        "footprint": source.footprint,
    }
    if source.content == "normal":
        linear, surfaces = source.linear(progress), source.surfaces or None
        image_levels, roughness_levels = contents.normal_levels(
            linear, surfaces, roughness, progress, **options
        )
        return image_levels[1:], roughness_levels[1:]
    options["reader"] = source.reader
    options["seam_budget"] = settings.seam_budget / 100.0
    if source.content == "cutout":
        return _cutout(source, progress, options), []
    return _plain(source, progress, options), []


def weights_seams(source: Source) -> bool:
    """Tells whether contrast across seams is minimized in an image's levels."""
    return (
        source.settings.seam_budget > 0.0
        and source.settings.filter in SEAM_FILTERS
        and source.content in {"color", "data"}
    )


def seam_note(source: Source, levels: Levels, progress: Progress) -> str:
    """Returns a line that compares seam contrast with and without seam weights."""
    others = source.filtered(
        source.linear(progress),
        source.settings.filter,
        share(progress, 0.0, 0.8),
        levels=len(levels) + 1,
        seam_budget=0.0,
    )
    without, weighed = (
        prefilter.seam_contrast(
            compared, source.surfaces, wrap=cast("Any", source.wrap), progress=part
        )
        for compared, part in (
            (others[1:], share(progress, 0.8, 0.9)),
            (levels, share(progress, 0.9, 1.0)),
        )
    )
    return _contrast_line(source.image_name, without.tolist(), weighed.tolist())


def _contrast_line(image_name: str, without: Sequence[float], weighed: Sequence[float]) -> str:
    """Returns a line that compares contrasts of levels 1 and up; empty without seams.

    Args:
        image_name: The image's name.
        without: Results of `prefilter.seam_contrast` for levels without seam weights.
        weighed: The same for levels with seam weights.
    """
    if not any(without):
        return ""
    pairs = enumerate(zip(without, weighed, strict=True), start=1)
    shown = ", ".join(f"{level}: {before:.3g} > {after:.3g}" for level, (before, after) in pairs)
    return f"Contrast across the seams of '{image_name}' by level, without and with Seams: {shown}"


def _cutout(source: Source, progress: Progress, options: dict[str, Any]) -> Levels:
    linear = source.linear(progress)
    coarser = contents.cutout_levels(
        source.picture,
        linear,
        source.surfaces or None,
        source.bounds(linear),
        source.settings.threshold,
        progress,
        **options,
    )
    return source.capped(coarser[1:], linear)


def _plain(source: Source, progress: Progress, options: dict[str, Any]) -> Levels:
    fits = source.fits_views
    texels, encoding = images.light_or_bytes(source.picture, partial(go_on, progress, 0.0))
    coarser = contents.plain_levels(
        source.picture,
        texels,
        source.surfaces or None,
        source.bounds(texels),
        share(progress, 0.0, 0.2) if fits else progress,
        encoding=encoding,
        **options,
    )
    if fits:
        linear = source.linear(share(progress, 0.2, 0.2))
        bounds = source.bounds(texels)
        coarser = source.fitted_to_views([linear, *coarser], bounds, share(progress, 0.2, 1.0))[1:]
    return source.capped(coarser, texels)
