# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels fitted to views of a model."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Bounds,
    Check,
    ProgressCallback,
    Wrap,
    as_bounds,
    as_name,
    as_number,
    as_progress,
    as_wrap,
    set_options,
)
from .._border.arrays import as_images, as_threads, in_form_of
from ..meshes.surface import Surface, as_surfaces
from ..sampling.levels import FilteredLevels

_CHECKS: dict[str, Check] = {
    "lookups": partial(as_name, "lookups"),
    "wrap": as_wrap,
    "bounds": as_bounds,
    "premultiplied": bool,
    "steadiness": partial(as_number, "steadiness"),
    "effort": partial(as_number, "effort"),
    "threads": as_threads,
}


def fit_to_views(
    levels: Sequence[npt.ArrayLike],
    surface: Surface | Sequence[Surface],
    *,
    lookups: str = "both",
    wrap: Wrap = "clamp",
    bounds: Bounds | None = (0.0, 1.0),
    premultiplied: bool = False,
    steadiness: float = 0.5,
    effort: float = 1.0,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FilteredLevels[np.float32]:
    """Levels fitted to the pixels that a game should show of a model.

    The model is drawn from all around, at distances where each level matters. A pixel should show
    the mean of the image over the surface visible in it; instead it shows a lookup of the levels,
    or the mean of a row of lookups. All levels together are fitted to the former, by least squares
    with less weight for large errors (Huber). They thus account for effects that `mipmaps` ignores:
    the footprints that actually occur, rows of lookups, and the neighborhood of edges of charts and
    of the model, which single lookups miss. This takes much longer, and is for one model: textures
    that several share are better left to `mipmaps`.

    Args:
        levels: The image, (height, width, 1 to 4 channels) or (height, width), scene-linear, and
            its other levels from `mipmaps` with `footprint` 1.5, or 1 for "trilinear": the search
            starts there, and texels that hardly any view reads stay near them.
        surface: One surface, or several that share the image, each of which is viewed separately.
        lookups: How pixels look up levels: "trilinear", one lookup by the longer axis of the
            pixel's footprint; "anisotropic", a row of up to 16 along that axis; "both", half of the
            views each.
        wrap: As for `mipmaps`.
        bounds: As for `mipmaps`.
        premultiplied: As for `mipmaps`.
        steadiness: Weight of flicker relative to errors in single frames, 0 and up.
        effort: Factor of the number of views, above 0 and up to 100.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The levels, float32, starting with the image as level 0.

    Raises:
        ValueError: An argument is out of range, sizes are not those of a mipmap, or a texel is not
            finite.
        Cancelled: The progress callback returned False.
    """
    images = as_images(levels)
    options = set_options(_native.ViewFitOptions(), _CHECKS, locals())
    coarser: list[npt.NDArray[Any]] = _native.fit_to_views(
        images, as_surfaces(surface), options, as_progress(progress)
    )
    return FilteredLevels(
        [in_form_of(levels[0], level) for level in (images[0].copy(), *coarser)],
        getattr(levels, "filter", None),
    )
