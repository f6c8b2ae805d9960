# SPDX-License-Identifier: GPL-3.0-or-later

"""Options of resizing, resampling and sampling tables."""

from dataclasses import dataclass

from prefilter.options.images import (
    CORNERS,
    FILTERS,
    LONGEST_SIDE,
    METHODS,
    PROPORTIONS,
    RESULT_SIZES,
    SIZES,
    SUFFIXES,
    TABLE_FILTERS,
    WARPS,
    WRAPS,
    ResampleSettings,
    ResizeSettings,
)
from prefilter.options.sampling import LANGUAGES, SPECTRA, TARGETS, TableSettings

from ..core.options import one_of

__all__ = (
    "CORNERS",
    "FILTERS",
    "LANGUAGES",
    "LONGEST_SIDE",
    "METHODS",
    "PROPORTIONS",
    "RESULT_SIZES",
    "SIZES",
    "SPECTRA",
    "SUFFIXES",
    "TABLE_FILTERS",
    "TARGETS",
    "WARPS",
    "WRAPS",
    "PlaneSettings",
    "ResampleSettings",
    "ResizeSettings",
    "TableSettings",
)


@dataclass(frozen=True)
class PlaneSettings:
    """Options of the preview plane."""

    filter: str = one_of(
        "lanczos2",
        "Filter",
        "Filter of the mipmap's levels, which the table reproduces",
        TABLE_FILTERS,
        flag="",
    )
