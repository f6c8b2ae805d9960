# SPDX-License-Identifier: GPL-3.0-or-later

"""The setting Lookups: footprints that levels are fitted for."""

from collections.abc import Sequence
from dataclasses import replace

from ...options.textures import FITTED_FILTERS, Settings
from ..files import target_files
from ..wording import Sentence

_FOOTPRINTS = {"supersampled": 0.0, "one-lookup": 1.0, "anisotropic": 1.5, "views": 1.0}
BEFORE_VIEWS = 1.5
"""Footprint of levels before they are fitted to views; chosen for the best result."""
_WORDS = {
    0.0: Sentence(""),
    1.0: Sentence("for one lookup per pixel"),
    1.5: Sentence("for anisotropic lookups"),
}
_TO_VIEWS = Sentence("fitted to views")


def resolved(settings: Settings) -> Settings:
    """Returns settings with Lookups resolved for the file type."""
    if settings.lookups != "auto":
        return settings
    is_for_games = target_files.has_formats(settings.filepath)
    return replace(settings, lookups="one-lookup" if is_for_games else "supersampled")


def footprint(settings: Settings, filter: str, reader: str) -> float:
    """Returns the width of a pixel in texels of a level, as `prefilter.mipmaps` takes it.

    Args:
        settings: The settings of the bake.
        filter: A key of `choices.FILTERS`; filters that are no fits do not depend on it.
        reader: How the levels are looked up; readers of encoded texels are supersampled.
    """
    if filter not in FITTED_FILTERS or reader != "linear":
        return 0.0
    return _FOOTPRINTS[resolved(settings).lookups]


def fits_views(settings: Settings, content: str, reader: str, objects: Sequence[str]) -> bool:
    """Tells whether levels are fitted to views of a model."""
    return (
        settings.lookups == "views"
        and content in {"color", "data"}
        and reader == "linear"
        and settings.filter in FITTED_FILTERS
        and len(objects) > 0
    )


def described(footprint: float, *, fits: bool) -> Sentence:
    """Returns the lookups that levels are made for, in words; empty for supersampled readers.

    Args:
        footprint: The footprint of the levels.
        fits: Whether they are fitted to views.
    """
    return _TO_VIEWS if fits else _WORDS[footprint]
