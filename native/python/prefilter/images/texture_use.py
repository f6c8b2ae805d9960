# SPDX-License-Identifier: GPL-3.0-or-later

"""The texels of a texture that a surface uses."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, Wrap, as_progress, as_size, as_wrap
from .._border.arrays import as_image, as_threads, in_form_of
from ..meshes.surface import Surface, as_surfaces


def texel_weights(
    surface: Surface | Sequence[Surface],
    width: int,
    height: int,
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float32]:
    """Surface area in each texel: the weights of "pam-box" (equation 7.1).

    Args:
        surface: One surface, or several that share the image.
        width: Texels along u.
        height: Texels along v.
        wrap: As for `mipmaps`.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        (height, width) shares of the area, row 0 at v = 0, scaled so that a uniform use of the
        whole image gives 1; exactly 0 in texels without surface.

    Raises:
        ValueError: An argument is out of range.
        Cancelled: The progress callback returned False.
    """
    return _native.texel_weights(
        as_surfaces(surface),
        as_size("width", width),
        as_size("height", height),
        as_wrap(wrap),
        as_progress(progress),
        as_threads(threads),
    )[:, :, 0]


def fill_unused(
    image: npt.ArrayLike,
    surface: Surface | Sequence[Surface],
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float32]:
    """The image with those texels filled that no bilinear lookup on the surface reads.

    They are filled from the others, out to the image's edge (push-pull: Gortler et al., "The
    Lumigraph", 1996, section 3.4). Renders of the surface at level 0 do not change; texture
    compressors, and readers with wider filters, no longer see the background.

    Args:
        image: (height, width, 1 to 4 channels) or (height, width). uint8 is divided by 255, uint16
            by 65535.
        surface: One surface, or several that share the image.
        wrap: As for `mipmaps`.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The image, float32.

    Raises:
        ValueError: An argument is out of range.
        Cancelled: The progress callback returned False.
    """
    filled = _native.fill_unused(
        as_image("image", image),
        as_surfaces(surface),
        as_wrap(wrap),
        as_progress(progress),
        as_threads(threads),
    )
    return in_form_of(image, filled)


def fill_transparent(
    image: npt.ArrayLike,
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float32]:
    """The image with transparent pixels filled by the colors around them (push-pull).

    Otherwise lookups between texels would mix in hidden colors, which darkens edges of cut-outs.

    Args:
        image: (height, width, 2 to 4 channels), the last of which is straight alpha. Colors are
            ignored where it is 0 or less, and otherwise weighted by it. uint8 is divided by 255,
            uint16 by 65535.
        wrap: As for `mipmaps`.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The image, float32; alpha is unchanged, and so are colors where it is above 0. An image that
        is transparent everywhere is unchanged.

    Raises:
        ValueError: An argument is out of range.
        Cancelled: The progress callback returned False.
    """
    return _native.fill_transparent(
        as_image("image", image), as_wrap(wrap), as_progress(progress), as_threads(threads)
    )
