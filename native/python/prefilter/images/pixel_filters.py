# SPDX-License-Identifier: GPL-3.0-or-later

"""The library's pixel filters, and their uses."""

from typing import Any, NamedTuple

from .. import _native


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


PIXEL_FILTERS = tuple(PixelFilter(*found) for found in _native.pixel_filters())


def names_for(use: str) -> tuple[Any, ...]:
    """Returns the names of the filters for a use; `_border.names` has a type of them."""
    return tuple(found.name for found in PIXEL_FILTERS if use in found.uses)
