# SPDX-License-Identifier: GPL-3.0-or-later

"""Access to the add-on's preferences, for options that a user has not set."""

from typing import Any

import bpy

from .options import declared

PACKAGE = __package__.rpartition(".")[0]
"""The name of the add-on's package."""


def preferred(settings: type) -> dict[str, Any]:
    """Returns the options of a dataclass that follow a preference, with their values."""
    return {
        name: preference(option.preference, default)
        for name, default, option in declared(settings)
        if option.preference
    }


def preference(name: str, default: Any) -> Any:
    """Returns the value of a preference; the default if the add-on is disabled.

    Args:
        name: The name in `Option.preference`.
        default: The default of the option.
    """
    addon = bpy.context.preferences.addons.get(PACKAGE)
    return default if addon is None else getattr(addon.preferences, name, default)
