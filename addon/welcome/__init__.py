# SPDX-License-Identifier: GPL-3.0-or-later

"""What someone sees at first: three lines, and demonstrations on models of the add-on's own."""

from ..core.registration import registration
from . import choices, operators, panel

MANUAL = {"install": ("demonstrate", "end_demonstration", "dismiss_welcome")}
"""The pages about its operators and settings; see `manual.Manual`."""
PREFERENCES = choices.Preferences
"""What it adds to the preferences; see `preferences.OfSubjects`."""

register, unregister = registration(operators, panel)
