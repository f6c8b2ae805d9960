# SPDX-License-Identifier: GPL-3.0-or-later

"""The welcome panel, and demonstrations on built-in models."""

from ..core.registration import registration
from . import choices, operators, panel

MANUAL = {"install": ("demonstrate", "end_demonstration", "dismiss_welcome")}
"""The pages about its operators and settings; see `manual.Manual`."""
PREFERENCES = choices.Preferences
"""Its part of the preferences; see `preferences.SubjectPreferences`."""

register, unregister = registration(operators, panel)
