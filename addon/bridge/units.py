# SPDX-License-Identifier: GPL-3.0-or-later

"""Lengths and volumes as text, in the units of the scene."""

import bpy


def length(value: float) -> str:
    """Formats a length in world space."""
    return _in_units(value, "LENGTH", 1)


def volume(value: float) -> str:
    """Formats a volume in world space."""
    return _in_units(value, "VOLUME", 3)


def _in_units(value: float, category: str, dimension: int) -> str:
    units = bpy.context.scene.unit_settings
    if units.system == "NONE":
        return f"{value:.4g}"
    scaled = value * units.scale_length**dimension
    # Blender has no unit between a cubic meter and a millionth of it.
    if units.system == "METRIC" and category == "VOLUME" and 1e-3 <= scaled < 1.0:
        return f"{scaled:.4g} m³"
    return bpy.utils.units.to_string(units.system, category, scaled, precision=4)
