# SPDX-License-Identifier: GPL-3.0-or-later

"""What the setting Lookups means: the footprint that levels are fitted for."""

from dataclasses import replace

from ..bridge.files import engines
from ..core.wording import Sentence
from .choices import FITTED_FILTERS, Settings

_FOOTPRINTS = {"supersampled": 0.0, "one-lookup": 1.0, "anisotropic": 1.5}
_WORDS = {
    0.0: Sentence(""),
    1.0: Sentence("for one lookup per pixel"),
    1.5: Sentence("for anisotropic lookups"),
}


def resolved(settings: Settings) -> Settings:
    """Returns settings whose lookups no longer depend on the file."""
    if settings.lookups != "auto":
        return settings
    is_for_games = engines.has_formats(settings.filepath)
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


def described(footprint: float) -> Sentence:
    """Returns what levels of such a footprint are for; empty for supersampled readers."""
    return _WORDS[footprint]
