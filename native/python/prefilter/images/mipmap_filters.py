# SPDX-License-Identifier: GPL-3.0-or-later

"""Names of mipmap filters, in a module of its own because options load it early."""

from typing import NamedTuple

from .. import _native
from .._border.names import MipmapFilterName


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


MIPMAP_FILTERS = tuple(MipmapFilter(*found) for found in _native.mipmap_filters())
"""All filters: kernels, "-covered" kernels, least squares, and filters over the surface."""
