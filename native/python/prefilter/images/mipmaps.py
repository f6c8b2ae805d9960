# SPDX-License-Identifier: GPL-3.0-or-later

"""Mipmaps of a texture on a surface (chapter 7)."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Concatenate, ParamSpec, Protocol, cast, overload

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Bounds,
    Check,
    ProgressCallback,
    Wrap,
    as_bounds,
    as_level_count,
    as_name,
    as_number,
    as_progress,
    as_wrap,
    is_srgb,
    set_options,
)
from .._border.arrays import as_image, as_images, as_texels, as_threads, in_form_of
from .._border.names import Encoding, MipmapFilterName, Reader
from ..meshes.surface import Surface, as_surfaces
from ..sampling.levels import FilteredLevels
from .color import as_light, as_words

_Arguments = ParamSpec("_Arguments")


_CHECKS: dict[str, Check] = {
    "filter": partial(as_name, "filter"),
    "wrap": as_wrap,
    "bounds": as_bounds,
    "levels": as_level_count,
    "premultiplied": bool,
    "reader": partial(as_name, "reader"),
    "seam_budget": partial(as_number, "seam_budget"),
    "footprint": partial(as_number, "footprint"),
    "threads": as_threads,
}


class _TypedByImage(Protocol[_Arguments]):
    """A function whose levels have the type of its image: uint8, uint16, or else float32."""

    @overload
    def __call__(
        self, image: npt.NDArray[np.uint8], *args: _Arguments.args, **named: _Arguments.kwargs
    ) -> FilteredLevels[np.uint8]: ...
    @overload
    def __call__(
        self, image: npt.NDArray[np.uint16], *args: _Arguments.args, **named: _Arguments.kwargs
    ) -> FilteredLevels[np.uint16]: ...
    @overload
    def __call__(
        self, image: npt.NDArray[np.floating], *args: _Arguments.args, **named: _Arguments.kwargs
    ) -> FilteredLevels[np.float32]: ...
    @overload
    def __call__(
        self, image: npt.ArrayLike, *args: _Arguments.args, **named: _Arguments.kwargs
    ) -> FilteredLevels[Any]: ...


def _typed_by_image(
    function: Callable[Concatenate[npt.ArrayLike, _Arguments], FilteredLevels[Any]],
) -> _TypedByImage[_Arguments]:
    return cast("_TypedByImage[_Arguments]", function)


@_typed_by_image
def mipmaps(
    image: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    filter: MipmapFilterName = "pam-bilinear",
    wrap: Wrap = "clamp",
    bounds: Bounds | None = (0.0, 1.0),
    levels: int | None = None,
    premultiplied: bool = False,
    reader: Reader = "linear",
    encoding: Encoding = "linear",
    seam_budget: float = 0.0,
    footprint: float = 0.0,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FilteredLevels[Any]:
    """Mipmap levels of an image, each fitted to the surface that uses it.

    "pam-bilinear" minimizes, level by level, the integral over the surface of the squared
    difference between a bilinear lookup of the level and one of the image (section 7.3), within
    the bounds. "pam-trilinear" does the same for all levels together and trilinear lookups,
    averaged over all mip values; level 0 is the image and the last level, of 1 x 1 texel, its mean
    over the surface. "ls-bilinear" is "pam-bilinear" for the unit square: for tiled textures, and
    textures shared by meshes that are not known yet. "pam-box" takes means over the surface
    (equation 7.1). The other filters work in texture space: kernels such as "box", "tent" or
    "lanczos3" use all texels, and their "-covered" variants only texels that some triangle touches.
    `MIPMAP_FILTERS` has all names.
    Texels that the surface does not read have no influence on the "pam-" and "-covered" filters;
    they are filled from their surroundings (push-pull).

    Args:
        image: (height, width, 1 to 4 channels) or (height, width), scene-linear, row 0 at v = 0, of
            any size. uint8 is divided by 255, uint16 by 65535; see `encoding`.
        surface: One surface, or several that share the image. Plain kernels need none.
        filter: A name of `MIPMAP_FILTERS`.
        wrap: Result of lookups outside of the image: "clamp", "repeat" or "border" (zero; surface
            outside of the unit square has no weight), or a pair of these for u and v.
        bounds: (low, high) limits of the levels' texels; either may be None, and None means
            neither. "pam-bilinear" and "pam-trilinear" are solved within them, the others are
            clipped.
        levels: How many levels to return, including level 0; None = down to 1 x 1.
        premultiplied: Whether the colors of a 4-channel image are already multiplied by alpha, or
            its fourth channel is not coverage: then every channel is filtered as it stands.
            Otherwise they are multiplied for filtering and divided afterward.
        reader: How the levels will be looked up, for "pam-bilinear": "linear" decodes texels, then
            filters (GPUs, and float textures everywhere); "srgb-after" filters sRGB-encoded texels,
            then decodes (Cycles on 8-bit sRGB images). The image and the levels are scene-linear in
            both cases, and lookups of the image use the same reader. The second is a bounded
            Gauss-Newton fit, started from the first.
        encoding: Encoding of uint8 and uint16 images and of their levels: with "srgb", colors are
            decoded for filtering and encoded again. A fourth channel is alpha, and linear.
        seam_budget: Share by which the error of each level may rise to hide UV seams, for
            least-squares filters: 0.01 is 1 %. The two sides of the seams then agree as well as
            that allows. The error is the root mean square over the surface, as in `mipmap_error`
            for the level and its reader; with a footprint, against the image averaged over it.
            Seams along which the image itself differs, by more than a tenth of its standard
            deviation, are ignored; 0 ignores all.
        footprint: Width of a reader's pixel in texels of a level, 0 to 2, for least squares and the
            linear reader. 0: levels are fitted to the image itself, which is right if a pixel is
            the mean of many lookups (film, supersampling). 1: a pixel is one lookup (games); levels
            are fitted to the image averaged over a pixel, by kernels with the variance of a box of
            that width. 1.5: one lookup with anisotropic filtering, which reads finer levels than
            the pixel's shorter side asks for.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        The levels, with as many axes as the image, level 0 first, which is a copy of the image.
            They are uint8 or uint16 if the image is, else float32, in a list that stores its
            filter.
        Each level has half the sides of the previous one, rounded down, at least 1.

    Raises:
        ValueError: An argument is out of range, or a texel that matters is not finite.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.MipmapOptions(), _CHECKS, locals())
    surfaces, report = as_surfaces(surface), as_progress(progress)
    stored, srgb = as_texels("image", image), is_srgb(encoding)
    coarser: list[npt.NDArray[Any]]
    if stored.dtype == np.uint8:
        coarser = _native.coarser_byte_levels(stored, srgb, surfaces, options, report)
    else:
        light = as_light(stored, srgb, options.threads)
        coarser = _native.coarser_levels(light, surfaces, options, report)
        if stored.dtype == np.uint16:
            coarser = [as_words(level, srgb, options.threads) for level in coarser]
    # Copied once the memory for filtering is free again.
    return FilteredLevels([in_form_of(image, level) for level in (stored.copy(), *coarser)], filter)


def coarser_levels(
    image: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    filter: MipmapFilterName = "pam-bilinear",
    wrap: Wrap = "clamp",
    bounds: Bounds | None = (0.0, 1.0),
    levels: int | None = None,
    premultiplied: bool = False,
    reader: Reader = "linear",
    encoding: Encoding = "linear",
    seam_budget: float = 0.0,
    footprint: float = 0.0,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FilteredLevels[np.float32]:
    """The levels of `mipmaps` from level 1 on, always as floats.

    This takes less memory: the image is not copied, and "pam-bilinear", "pam-trilinear" and
    "pam-box" read bytes directly unless alpha matters. All arguments are those of `mipmaps`;
    `levels` includes level 0.

    Returns:
        Levels 1, 2, ..., float32 and scene-linear, even if the image has bytes.

    Raises:
        ValueError: As `mipmaps`.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.MipmapOptions(), _CHECKS, locals())
    surfaces, report = as_surfaces(surface), as_progress(progress)
    stored, srgb = as_texels("image", image), is_srgb(encoding)
    if stored.dtype == np.uint8:
        coarser = _native.coarser_float_levels_of_bytes(stored, srgb, surfaces, options, report)
    else:
        light = as_light(stored, srgb, options.threads)
        coarser = _native.coarser_levels(light, surfaces, options, report)
    return FilteredLevels((in_form_of(image, level) for level in coarser), filter)


def mipmap_error(
    levels: Sequence[npt.ArrayLike],
    image: npt.ArrayLike,
    surface: Surface | Sequence[Surface],
    mip_values: npt.ArrayLike,
    *,
    wrap: Wrap = "clamp",
    reader: Reader = "linear",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float64]:
    """Error of a mipmap relative to its image over the surface, at any mip value (figure 7.7).

    The root mean square, over the surface's area and the channels, of the difference between a
    trilinear lookup of the levels and a bilinear lookup of the image. It is exact: the integrals
    are computed from moments, not samples.

    Args:
        levels: Level 0 first, with the sizes of `mipmaps`; the last ones may be omitted.
        image: The image that they approximate.
        surface: One surface, or several that share the image.
        mip_values: Numbers in an array of any shape; 0 is the first level. Values below 0 or beyond
            the last level read the nearest level, as on a GPU.
        wrap: As for `mipmaps`.
        reader: As for `mipmaps`: with "srgb-after" each bilinear lookup, also of the image,
            interpolates encoded texels and decodes the result; the integrals are then computed by
            quadrature in the cells of the image.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The error at each mip value, float64, in the shape of `mip_values`.

    Raises:
        ValueError: An argument is out of range, or a texel that the surface reads is not finite.
        Cancelled: The progress callback returned False.
    """
    try:
        values = np.asarray(mip_values, np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"mip_values: numbers are needed: {error}") from error
    errors = _native.mipmap_error(
        as_images(levels),
        as_image("image", image),
        as_surfaces(surface),
        values.ravel().tolist(),
        as_wrap(wrap),
        as_name("reader", reader),
        as_progress(progress),
        as_threads(threads),
    )
    return np.array(errors).reshape(values.shape)


def seam_contrast(
    levels: Sequence[npt.ArrayLike],
    surface: Surface | Sequence[Surface],
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
) -> npt.NDArray[np.float64]:
    """Contrast across UV seams in each level, which `seam_budget` reduces.

    A seam is an edge whose two triangles have different texture coordinates there; vertices at the
    same position count as one, and edges of more than two triangles are ignored.

    Args:
        levels: Arrays (height, width, channels) or (height, width), of any sizes.
        surface: One surface, or several that share the image.
        wrap: As for `mipmaps`.
        progress: As for `mipmaps`.

    Returns:
        For each level, the root mean square, over the length of the seams and the channels, of the
        difference between the bilinear lookups on their two sides; 0 where there is no seam.

    Raises:
        ValueError: An argument is out of range, or a texel that a seam reads is not finite.
        Cancelled: The progress callback returned False.
    """
    return np.array(
        _native.seam_contrast(
            as_images(levels), as_surfaces(surface), as_wrap(wrap), as_progress(progress)
        )
    )
