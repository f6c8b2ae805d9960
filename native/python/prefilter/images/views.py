# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels fitted to what pixels show of a model."""

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
    as_items,
    as_name,
    as_number,
    as_progress,
    as_wrap,
    set_options,
)
from .._border.arrays import as_image, as_threads, in_form_of
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
    """Levels that come nearest to what pixels of a game should show of a model.

    The model is drawn from all around, at distances where each level counts. What a pixel should
    show is the mean of the image over what is visible in it; what it shows is a lookup of the
    levels, one or a row of them. All levels together are fitted to that, by least squares with
    less weight for what is far off (Huber). They then know what `mipmaps` leaves out: which
    footprints occur, rows of lookups, and what lies beside the edges of charts and of the model,
    which single lookups miss. It takes much longer, and is for one model: textures that several
    share are better left to `mipmaps`.

    Args:
        levels: The image, (height, width, 1 to 4 channels) or (height, width), scene-linear, and
            its other levels, as `mipmaps` returns them with `footprint` 1.5, or 1 for "trilinear":
            the search starts there, and texels that hardly any view reads stay near them.
        surface: One surface, or several that share the image, each of which is seen by itself.
        lookups: How pixels look levels up: "trilinear", one lookup by the longer axis of the
            pixel's footprint; "anisotropic", a row of up to 16 along that axis; "both", half of the
            time each.
        wrap: As for `mipmaps`.
        bounds: As for `mipmaps`.
        premultiplied: As for `mipmaps`.
        steadiness: What flickers counts so much beside what is wrong in single frames, 0 and up.
        effort: How many more views there are, above 0 and up to 100.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The levels, float32, level 0 first, which is the image.

    Raises:
        ValueError: An argument is out of range, sizes are not those of a mipmap, or a texel is not
            finite.
        Cancelled: The progress callback returned False.
    """
    if not isinstance(levels, Sequence):
        raise ValueError(f"levels: a {type(levels).__name__}; a list of arrays is needed")
    options = set_options(_native.ViewFitOptions(), _CHECKS, locals())
    images = [
        as_image(f"levels: level {k}", level)
        for k, level in enumerate(as_items("levels", levels, "a list of images"))
    ]
    made: list[npt.NDArray[Any]] = _native.fit_to_views(
        images, as_surfaces(surface), options, as_progress(progress)
    )
    return FilteredLevels(
        [in_form_of(levels[0], level) for level in (images[0].copy(), *made)],
        getattr(levels, "filter", None),
    )
