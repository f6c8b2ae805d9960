# SPDX-License-Identifier: GPL-3.0-or-later

"""The filters of the library, and what each may be used for."""

from typing import Any, NamedTuple

from .. import _native


class PixelFilter(NamedTuple):
    """A filter of pixels.

    Attributes:
        name: As functions take it.
        label: As users see it.
        radius: Half the width of what it reads, in pixels.
        uses: Some of "raster", "resize", "mipmap" and "sampling".
    """

    name: str
    label: str
    radius: float
    uses: tuple[str, ...]


PIXEL_FILTERS = tuple(PixelFilter(*found) for found in _native.pixel_filters())


def names_for(use: str) -> tuple[Any, ...]:
    """The names of the filters that may be used so: those of a type in `_border.names`."""
    return tuple(found.name for found in PIXEL_FILTERS if use in found.uses)
