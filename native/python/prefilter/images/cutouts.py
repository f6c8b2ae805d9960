# SPDX-License-Identifier: GPL-3.0-or-later

"""Alpha-tested cut-outs: levels that preserve the image's coverage of the surface."""

from collections.abc import Sequence
from functools import partial

import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    Wrap,
    as_number,
    as_progress,
    as_wrap,
    set_options,
)
from .._border.arrays import FloatArray, as_images, as_threads, in_form_of
from ..meshes.surface import Surface, as_surfaces

_CHECKS: dict[str, Check] = {
    "threshold": partial(as_number, "threshold"),
    "wrap": as_wrap,
    "premultiplied": bool,
    "threads": as_threads,
}


def keep_coverage(
    levels: Sequence[npt.ArrayLike],
    surface: Surface | Sequence[Surface] | None = None,
    *,
    threshold: float = 0.5,
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> list[FloatArray]:
    """Levels whose alpha test preserves the coverage of level 0.

    A cut-out is visible where a lookup's alpha is at least a threshold. Filtered alpha drifts to
    its mean, so that leaves and fences get thinner or thicker level by level. Here the alpha of
    each level is mapped by an increasing curve of two straight pieces: 0 and 1 stay, and the
    threshold is taken at the value that gives the coverage of level 0. If even the smallest such
    value shows too little, as with thresholds near 1, alpha of 0 is raised too, but stays below the
    threshold.

    Coverage is the share of the surface's area, or of the image if there is no surface, in which a
    bilinear lookup's alpha is at least the threshold. A level with the right coverage within 0.001
    is unchanged; others get as close as they can: a level of few texels may have to show all or
    nothing.

    Args:
        levels: Level 0 first, as `mipmaps` returns them: (height, width, 4) with alpha as the
            fourth channel, or (height, width, 1) or (height, width), which is alpha. uint8 is
            divided by 255, uint16 by 65535.
        surface: One surface, or several that share the image.
        threshold: The least visible alpha; above 0, at most 1.
        wrap: As for `mipmaps`.
        premultiplied: Whether colors are multiplied by alpha; then they are scaled along with it.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The levels, float32; level 0 is a copy.

    Raises:
        ValueError: An argument is out of range, or alpha is not finite in a level above 0.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.CoverageOptions(), _CHECKS, locals())
    images = as_images(levels)
    coarser = _native.keep_coverage(images, as_surfaces(surface), options, as_progress(progress))
    results = [images[0].copy(), *coarser]
    return [in_form_of(level, image) for level, image in zip(levels, results, strict=True)]
