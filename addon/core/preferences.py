# SPDX-License-Identifier: GPL-3.0-or-later

"""What the preferences of the add-on say, for options that a user has not set."""

from typing import Any

import bpy

from .options import declared

PACKAGE = __package__.rpartition(".")[0]
"""The add-on, as Blender calls it."""


def preferred(settings: type) -> dict[str, Any]:
    """Returns the values of the options of a dataclass that follow a preference."""
    return {
        name: preference(found.preference, default)
        for name, default, found in declared(settings)
        if found.preference
    }


def preference(name: str, default: Any) -> Any:
    """Returns what options that follow a preference are; the default where the add-on is off.

    Args:
        name: A key of `Option.preference`.
        default: That of the option.
    """
    found = bpy.context.preferences.addons.get(PACKAGE)
    return default if found is None else getattr(found.preferences, name, default)
