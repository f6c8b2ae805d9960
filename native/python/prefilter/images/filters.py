# SPDX-License-Identifier: GPL-3.0-or-later

"""Tables of the library's pixel filters and mipmap filters; loads little, as options need it."""

from typing import Any, NamedTuple

from .. import _native
from .._border.names import MipmapFilterName


class PixelFilter(NamedTuple):
    """A filter of pixels.

    Attributes:
        name: The name that functions take.
        label: The name that users see.
        radius: Half the filter's width, in pixels.
        uses: A subset of "raster", "resize", "mipmap" and "sampling".
    """

    name: str
    label: str
    radius: float
    uses: tuple[str, ...]


PIXEL_FILTERS = tuple(PixelFilter(*row) for row in _native.pixel_filters())


def names_for(use: str) -> tuple[Any, ...]:
    """Returns the names of the filters for a use; `_border.names` has a type of them."""
    return tuple(filter.name for filter in PIXEL_FILTERS if use in filter.uses)


class MipmapFilter(NamedTuple):
    """A filter of `mipmaps`.

    Attributes:
        name: Its name, such as "tent", "tent-covered" or "pam-bilinear".
        needs_surface: Whether it filters over the surface, or over texels that the surface touches.
        is_fit: Whether it is a least-squares fit: only these depend on `seam_budget`.
    """

    name: MipmapFilterName
    needs_surface: bool
    is_fit: bool


MIPMAP_FILTERS = tuple(MipmapFilter(*row) for row in _native.mipmap_filters())
"""All filters: kernels, "-covered" kernels, least squares, and filters over the surface."""
