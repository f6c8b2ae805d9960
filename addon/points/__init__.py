# SPDX-License-Identifier: GPL-3.0-or-later

"""Scans: files of points to objects, and points with normals to meshes."""

from ..core.keys import Key
from ..core.registration import registration
from . import menus, operators, panel, properties

MANUAL = {
    "scans": (
        *("reconstruct", "trim_reconstruction", "import_points", "drop_points"),
        "paint_texture",
        *("subsample_points", "remove_outliers", "crop_points", "align_scans"),
    )
}
"""Manual pages of operators and settings; see `manual.Manual`."""
KEYS = (Key("reconstruct", "R", "Object Mode"),)
"""Default key bindings of its operators; see `keys.Keys`."""

register, unregister = registration(properties, operators, panel, menus)
