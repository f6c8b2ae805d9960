# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxels of any mesh: closed surfaces, volumes, and set operations."""

from ..core.keys import Key
from ..core.registration import registration
from . import operators, panel, properties, report_panel

MANUAL = {
    "voxels": (
        *("voxelize", "boolean", "update_voxels", "voxel_result", "operand"),
        *("select_found", "found", "found_places"),
    )
}
"""Manual pages of operators and settings; see `manual.Manual`."""
KEYS = (
    Key("voxelize", "V", "Object Mode"),
    Key("voxelize", "V", "Sculpt"),
    Key("boolean", "B", "Object Mode"),
)
"""Default key bindings of its operators; see `keys.Keys`."""

register, unregister = registration(properties, operators, panel, report_panel)
