# SPDX-License-Identifier: GPL-3.0-or-later

"""Choices of the library's filters."""

from collections.abc import Mapping

import prefilter

from .options import Choice

LABELS = {filter.name: filter.label for filter in prefilter.PIXEL_FILTERS}


def filters_for(use: str, descriptions: Mapping[str, str]) -> dict[str, Choice]:
    """Returns the filters for a use, described ones first, in the order of `descriptions`."""
    names = [filter.name for filter in prefilter.PIXEL_FILTERS if use in filter.uses]
    ordered = [*descriptions, *(name for name in names if name not in descriptions)]
    return {
        name: Choice(LABELS[name], descriptions.get(name, "")) for name in ordered if name in names
    }
