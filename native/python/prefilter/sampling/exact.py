# SPDX-License-Identifier: GPL-3.0-or-later

"""Samples of an image by exact filters, which tables and probes approximate."""

from functools import partial

import numpy.typing as npt

from .. import _native
from .._border.arguments import Check, ProgressCallback, Wrap, as_name, as_progress, set_options
from .._border.arrays import FloatArray, as_image, check_texels, in_form_of
from .._border.names import Kernel
from .._border.samples import SAMPLE_CHECKS, as_coordinates, as_jacobians, as_scales

_CHECKS: dict[str, Check] = {**SAMPLE_CHECKS, "filter": partial(as_name, "filter")}


def sample_exact(
    image: npt.ArrayLike,
    coordinates: npt.ArrayLike,
    scales: npt.ArrayLike,
    *,
    filter: Kernel = "lanczos2",
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray:
    """Samples of an image under a kernel of any scale, from all texels that it covers.

    The texels' weights are the kernel's values at their centers, along x times along y, with its
    unit `scale` texels wide, divided by their sum; "box" is the mean over a square of that side.
    The time of a sample is proportional to the texels under the kernel, limited to the whole image.

    Args:
        image: (height, width, channels) of any number, or (height, width), row 0 at v = 0. uint8 is
            divided by 255, uint16 by 65535. Every channel is filtered as it stands: colors must be
            multiplied by their alpha.
        coordinates: (n, 2), u and v of each sample; the image spans 0 to 1 along both.
        scales: (n,), or one number for all: the width of the kernel's unit in texels, at least 0. A
            scale below 1 counts as 1.
        filter: A name of `SAMPLING_FILTERS`.
        wrap: Texels outside of the image: "clamp" (the nearest texel), "repeat" or "border" (zero),
            or a pair of these for u and v.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        The samples, float32 (n, channels), or (n,) if the image is (height, width).

    Raises:
        ValueError: An argument is out of range, or a texel is not finite or beyond 1e30.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.ExactOptions(), _CHECKS, locals())
    stored = as_image("image", image)
    check_texels("image", stored)
    places = as_coordinates(coordinates)
    samples = _native.sample_exact(
        stored,
        places,
        as_scales(scales, len(places)).reshape(-1),
        options,
        as_progress(progress),
    )
    return in_form_of(image, samples)


def sample_ewa(
    image: npt.ArrayLike,
    coordinates: npt.ArrayLike,
    jacobians: npt.ArrayLike,
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray:
    """Samples of an image under elliptical Gaussians, from all texels that they cover.

    The Gaussian exp(-pi |p|^2) of a pixel p, mapped into the image by its Jacobian J, weights the
    texels by exp(-pi d^T (J J^T)^-1 d) at a distance of d texels; weights are divided by their sum.
    Singular values of J are at least 1, and at most the width of a texel of the coarsest level. The
    Gaussian is cut off at |p| = 2 sqrt(2), where it is 1e-11.

    Args:
        image: As for `sample_exact`.
        coordinates: As for `sample_exact`.
        jacobians: (n, 2, 2), [[dx/di, dx/dj], [dy/di, dy/dj]]: derivatives of the position in the
            image, in texels, by pixel coordinates.
        wrap: As for `sample_exact`.
        progress: As for `sample_exact`.
        threads: As for `sample_exact`.

    Returns:
        The samples, float32 (n, channels), or (n,) if the image is (height, width).

    Raises:
        ValueError: An argument is out of range, or a texel is not finite or beyond 1e30.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.EllipticalOptions(), SAMPLE_CHECKS, locals())
    stored = as_image("image", image)
    check_texels("image", stored)
    places = as_coordinates(coordinates)
    samples = _native.sample_ewa(
        stored,
        places,
        as_jacobians(jacobians, len(places)),
        options,
        as_progress(progress),
    )
    return in_form_of(image, samples)
