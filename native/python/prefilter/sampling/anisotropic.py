# SPDX-License-Identifier: GPL-3.0-or-later

"""Anisotropic samples of a mipmap (section 6.3, figure 6.12)."""

from collections.abc import Sequence

import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, Wrap, as_progress, set_options
from .._border.arrays import FloatArray
from .._border.samples import (
    SAMPLE_CHECKS,
    as_coordinates,
    as_jacobians,
    as_probe_count,
    as_pyramid,
    as_samples,
)
from .samples import native_table
from .sampling_table import SamplingTable

_CHECKS = {**SAMPLE_CHECKS, "max_probes": as_probe_count}


def sample_anisotropic(
    levels: Sequence[npt.ArrayLike],
    table: SamplingTable | str,
    coordinates: npt.ArrayLike,
    jacobians: npt.ArrayLike,
    *,
    max_probes: int = 16,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray:
    """Samples of a mipmap under elliptical Gaussians, composed of isotropic samples in a row.

    The Jacobian's singular values are the widths of the ellipse. Isotropic samples as wide as the
    minor axis, the probes, lie along the major axis, with Gaussian weights, so that their sum
    approximates the ellipse's Gaussian (as in Feline: McCormack, Perry, Farkas and Jouppi 1999). A
    ratio r of the widths needs ceil(2 r) - 1 probes, and up to a ratio of 1.1 a single one. If
    max_probes is less, they are as wide as for a ratio of (max_probes + 1) / 2. The squared error
    of an ideal sum is at most 0.09 of the elliptical Gaussian's norm; a table of "gaussian" adds
    little to it, "trilinear" more. Tables of other filters have their own shape across the major
    axis, and a blurred one along it. Compare `sample_ewa`.

    Args:
        levels: As for `sample`, filtered by the table's filter; for "trilinear" by "gaussian".
        table: The table, as for `sample`.
        coordinates: (n, 2), u and v of each sample; the image spans 0 to 1 along both.
        jacobians: (n, 2, 2), [[dx/di, dx/dj], [dy/di, dy/dj]]: derivatives of the position in the
            image, in texels of level 0, by pixel coordinates. Singular values are at least 1, and
            at most the width of a texel of the last level.
        max_probes: Largest number of probes per sample, 1 to 256. With 1, a sample is isotropic,
            and as wide as the larger singular value.
        wrap: As for `sample`.
        progress: As for `sample`.
        threads: As for `sample`.

    Returns:
        The samples, float32 (n, channels), or (n,) if the levels are (height, width).

    Raises:
        ValueError: An argument is out of range, or the levels are known to have another filter.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.AnisotropicOptions(), _CHECKS, locals())
    pyramid = as_pyramid(levels)
    places = as_coordinates(coordinates)
    samples = _native.sample_anisotropic(
        pyramid,
        native_table(table, levels),
        places,
        as_jacobians(jacobians, len(places)),
        options,
        as_progress(progress),
    )
    return as_samples(levels, samples)
