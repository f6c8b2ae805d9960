# SPDX-License-Identifier: GPL-3.0-or-later

"""The filters of mipmaps by name; what options are made of, so it loads little."""

from typing import NamedTuple

from .. import _native
from .._border.names import MipmapFilterName


class MipmapFilter(NamedTuple):
    """A filter that `mipmaps` has.

    Attributes:
        name: What it is called: "tent", "tent-covered" or "pam-bilinear".
        needs_surface: Whether it is made over the surface, or the texels that the surface touches.
        is_fit: Whether it is a least-squares fit: the only ones that `seam_budget` changes.
    """

    name: MipmapFilterName
    needs_surface: bool
    is_fit: bool


MIPMAP_FILTERS = tuple(MipmapFilter(*found) for found in _native.mipmap_filters())
"""All filters: each kernel, each with "-covered" behind, least squares, and those over the surface.
"""
