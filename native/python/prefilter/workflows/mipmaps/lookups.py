# SPDX-License-Identifier: GPL-3.0-or-later

"""What the setting Lookups means: the footprint that levels are fitted for."""

from collections.abc import Sequence
from dataclasses import replace

from ...options.mipmaps import FITTED_FILTERS, Settings
from ..files import target_files
from ..wording import Sentence

_FOOTPRINTS = {"supersampled": 0.0, "one-lookup": 1.0, "anisotropic": 1.5, "views": 1.0}
BEFORE_VIEWS = 1.5
"""The footprint of levels that are then fitted to views: among those it comes out best."""
_WORDS = {
    0.0: Sentence(""),
    1.0: Sentence("for one lookup per pixel"),
    1.5: Sentence("for anisotropic lookups"),
}
_TO_VIEWS = Sentence("fitted to views")


def resolved(settings: Settings) -> Settings:
    """Returns settings whose lookups no longer depend on the file."""
    if settings.lookups != "auto":
        return settings
    is_for_games = target_files.has_formats(settings.filepath)
    return replace(settings, lookups="one-lookup" if is_for_games else "supersampled")


def footprint(settings: Settings, filter: str, reader: str) -> float:
    """Returns the texels of a level that a pixel covers, as `prefilter.mipmaps` takes it.

    Args:
        settings: Of the bake.
        filter: A key of `choices.FILTERS`; those that are no fits make the same levels for all.
        reader: How the levels are looked up: readers of encoded texels are supersampled.
    """
    if filter not in FITTED_FILTERS or reader != "linear":
        return 0.0
    return _FOOTPRINTS[resolved(settings).lookups]


def fits_views(settings: Settings, content: str, reader: str, objects: Sequence[str]) -> bool:
    """Tells whether levels are fitted to what pixels show of a model.

    Args:
        settings: Of the bake.
        content: What the image holds.
        reader: How the levels are looked up.
        objects: That wear the image.
    """
    return (
        settings.lookups == "views"
        and content in {"color", "data"}
        and reader == "linear"
        and settings.filter in FITTED_FILTERS
        and len(objects) > 0
    )


def described(footprint: float, *, fits: bool) -> Sentence:
    """Returns what levels are for; empty for supersampled readers.

    Args:
        footprint: Of the levels.
        fits: Whether they are fitted to views.
    """
    return _TO_VIEWS if fits else _WORDS[footprint]
