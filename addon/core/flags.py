# SPDX-License-Identifier: GPL-3.0-or-later

"""Options as command-line flags, whose defaults may follow the add-on's preferences."""

import argparse
from functools import partial
from typing import Any, TypeVar

from prefilter.options import flags
from prefilter.options.flags import given, tables

from .preferences import preferred

__all__ = ("PREFERRED", "add_flags", "given", "settings_given", "tables")

Settings = TypeVar("Settings")

PREFERRED = ", or as in the preferences"
"""Added in the help to the default of an option that follows a preference."""
add_flags = partial(flags.add_flags, preferred=PREFERRED)
"""Adds the flags of options to a parser."""


def settings_given(options: argparse.Namespace, settings: type[Settings], **more: Any) -> Settings:
    """Returns settings from `more`, else from flags, else from the add-on's preferences."""
    return settings(**preferred(settings) | given(options, settings) | more)
