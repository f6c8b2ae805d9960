# SPDX-License-Identifier: GPL-3.0-or-later

"""Mipmaps of normal maps, and roughness that compensates for the averaging of normals."""

from collections.abc import Sequence
from functools import partial
from typing import overload

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    Wrap,
    as_level_count,
    as_name,
    as_number,
    as_progress,
    as_wrap,
    set_options,
)
from .._border.arrays import FloatArray, as_array, as_image, as_threads, check_shape, in_form_of
from .._border.names import MipmapFilterName
from ..meshes.surface import Surface, as_surfaces

_CHECKS: dict[str, Check] = {
    "filter": partial(as_name, "filter"),
    "wrap": as_wrap,
    "footprint": partial(as_number, "footprint"),
    "encoded": bool,
    "levels": as_level_count,
    "threads": as_threads,
}


@overload
def normal_mipmaps(
    normals: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    roughness: None = None,
    filter: MipmapFilterName = "pam-bilinear",
    wrap: Wrap = "clamp",
    footprint: float = 0.0,
    encoded: bool = True,
    levels: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> list[FloatArray]: ...
@overload
def normal_mipmaps(
    normals: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    roughness: npt.ArrayLike,
    filter: MipmapFilterName = "pam-bilinear",
    wrap: Wrap = "clamp",
    footprint: float = 0.0,
    encoded: bool = True,
    levels: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> tuple[list[FloatArray], list[FloatArray]]: ...
def normal_mipmaps(
    normals: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    roughness: npt.ArrayLike | None = None,
    filter: MipmapFilterName = "pam-bilinear",
    wrap: Wrap = "clamp",
    footprint: float = 0.0,
    encoded: bool = True,
    levels: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> list[FloatArray] | tuple[list[FloatArray], list[FloatArray]]:
    """Levels of a normal map, filtered as vectors and renormalized.

    Where the normals under a texel differ, their mean is shorter than 1, and the surface should
    look rougher from afar. If a roughness is given, its levels account for that: if L is the length
    of the mean of the normals in a texel, the texel gets

        alpha^2 = (mean of alpha^2) + 2 (1 - L),    alpha = roughness^2,    at most 1.

    The model is a von Mises-Fisher distribution of normals. Its mean has the length
    L = coth k - 1 / k, so its concentration k is 1 / (1 - L) up to e^(-2 k), and it spreads like a
    lobe with alpha^2 = 2 / k. Squares of widths add up, as in LEAN mapping.

    Both conventions, OpenGL and DirectX, work: levels use that of the map.

    Args:
        normals: (height, width, 3), in tangent or object space. uint8 is divided by 255, uint16 by
            65535. Lengths are ignored; a vector shorter than 0.02 has no direction and is replaced
            by (0, 0, 1).
        surface: As for `mipmaps`.
        roughness: None, a number, or (height, width, 1) or (height, width) of the size of the
            normals, as the Principled BSDF takes it; clamped to [0, 1].
        filter: As for `mipmaps`, for the normals. The means for the roughness are over a texel's
            surface ("pam-box") for the "pam-" filters, otherwise by "box" or "box-covered".
        wrap: As for `mipmaps`.
        footprint: As for `mipmaps`, for the normals.
        encoded: Whether a component c is stored as (c + 1) / 2, in the map and in the levels.
        levels: As for `mipmaps`.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The levels of the normals, level 0 unchanged; with a roughness, a pair of these and the
        levels of the roughness.

    Raises:
        ValueError: An argument is out of range, or a texel that matters is not finite.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.NormalMipmapOptions(), _CHECKS, locals())
    array = as_array("normals", normals)
    check_shape("normals", array, ("height", "width", 3))
    image = as_image("normals", normals)
    rough = None if roughness is None else _as_roughness(roughness, image.shape[:2])
    coarser, roughness_levels = _native.normal_mipmaps(
        image, rough, as_surfaces(surface), options, as_progress(progress)
    )
    directions = [image.copy(), *coarser]
    if roughness is None or rough is None:
        return directions
    return directions, [in_form_of(roughness, level) for level in (rough.copy(), *roughness_levels)]


def _as_roughness(roughness: npt.ArrayLike, size: tuple[int, int]) -> FloatArray:
    if np.ndim(roughness) == 0:
        number = np.asarray(roughness)
        if number.dtype.kind not in "fiu" or not 0 <= number <= 1:
            raise ValueError(f"roughness: {roughness!r}; a number in [0, 1] or an image is needed")
        return np.full((*size, 1), number, np.float32)
    array = as_array("roughness", roughness)
    check_shape("roughness", array, size if array.ndim == 2 else (*size, 1))
    return as_image("roughness", roughness)
