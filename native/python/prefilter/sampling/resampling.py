# SPDX-License-Identifier: GPL-3.0-or-later

"""Images under affine and projective transforms (section 6.3)."""

from functools import partial
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    Wrap,
    as_name,
    as_size,
    as_wrap,
    set_options,
)
from .._border.arrays import FloatArray, as_array, as_image, as_threads, in_form_of
from .._border.channels import in_channel_groups
from .._border.names import Kernel
from .._border.samples import as_probe_count
from .samples import native_table
from .sampling_table import SamplingTable

_STANDARD_TEXELS = 8

_CHECKS: dict[str, Check] = {
    "filter": partial(as_name, "filter"),
    "exact": bool,
    "max_probes": as_probe_count,
    "wrap": as_wrap,
    "premultiplied": bool,
    "threads": as_threads,
}


def resample(
    image: npt.ArrayLike,
    transform: npt.ArrayLike,
    width: int,
    height: int,
    *,
    table: SamplingTable | str | None = None,
    filter: Kernel = "lanczos2",
    exact: bool = False,
    max_probes: int = 1,
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> FloatArray:
    """The image scaled, rotated, sheared or seen in perspective.

    Each pixel of the result is a sample of the image at the transformed center of the pixel, with a
    filter as wide as the larger singular value of the Jacobian there. A table reads few texels of a
    mipmap, which is made first; "trilinear" interpolates in it; `exact` reads all texels under the
    filter, which can take long. Filters are never narrower than a pixel of the image, nor, unless
    `exact`, wider than a pixel of the coarsest level.

    With more than one probe the filter is an ellipse, like the image of a pixel under the
    transform: see `sample_anisotropic`. This is for "gaussian", which with `exact` is `sample_ewa`.

    Args:
        image: (height, width, channels) of any number, or (height, width), scene-linear, row 0 at
            the bottom. uint8 is divided by 255, uint16 by 65535.
        transform: (3, 3), maps (x, y, 1) of the result to (x w, y w, w) of the image, both in their
            own pixels; pixel i spans [i, i + 1). Or (2, 3): an affine map to (x, y). Pixels of the
            result with w <= 0 are beyond the horizon: they are 0 in all channels.
        width: Width of the result in pixels, 1 to 2^20.
        height: Height of the result.
        table: The sampling table, whose filter makes the mipmap. None: the standard one of `filter`
            with 8 texels. "trilinear": for comparison.
        filter: A name of `SAMPLING_FILTERS`; ignored if a table is given.
        exact: Whether to use the filter itself; excludes a table.
        max_probes: Largest number of isotropic samples per pixel, 1 to 256.
        wrap: Pixels outside of the image: "clamp" (the nearest pixel), "repeat" or "border" (zero),
            or a pair of these for x and y.
        premultiplied: As for `resize`. With the wrap mode "border", images of 2 or 4 channels
            become transparent outside. transparent outside.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        A new float32 array, (height, width, channels), or (height, width) if the image is.

    Raises:
        ValueError: An argument is out of range, or a pixel is not finite or beyond 1e30.
        MemoryError: The result does not fit into memory.
        Cancelled: The progress callback returned False.
    """
    options = set_options(_native.ResampleOptions(), _CHECKS, locals())
    stored = as_image("image", image)
    if exact and table is not None:
        raise ValueError(f"table: {table!r} with exact=True; None is needed, as no table is used")
    if isinstance(table, SamplingTable):
        options.filter = table.filter
    elif table is None and not exact:
        table = SamplingTable.standard(cast("Any", options.filter), _STANDARD_TEXELS)
    sampler = None if table is None else native_table(table, [])
    homography = _as_homography(transform)
    size = as_size("width", width), as_size("height", height)

    def of_channels(
        part: FloatArray, multiplied: bool, reports: ProgressCallback | None
    ) -> FloatArray:
        options.premultiplied = multiplied
        return _native.resample(part, homography, *size, sampler, options, reports)

    groups = in_channel_groups(stored, options.premultiplied, of_channels, progress)
    return in_form_of(image, groups[0] if len(groups) == 1 else np.concatenate(groups, axis=2))


def _as_homography(transform: npt.ArrayLike) -> npt.NDArray[np.float64]:
    matrix = as_array("transform", transform)
    if matrix.dtype.kind not in "iuf":
        raise ValueError(f"transform: dtype {matrix.dtype}; numbers are needed")
    if matrix.shape not in ((3, 3), (2, 3)):
        raise ValueError(f"transform: shape {matrix.shape}; (3, 3) or (2, 3) is needed")
    if len(matrix) == 2:
        matrix = np.vstack([matrix, (0, 0, 1)])
    return np.ascontiguousarray(matrix, np.float64)
