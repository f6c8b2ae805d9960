# SPDX-License-Identifier: GPL-3.0-or-later

"""Vector shapes to images: curves, texts, SVG files, and UV maps as masks."""

from ..core.keys import Key
from ..core.registration import registration
from . import operators, panels, properties

MANUAL = {"shapes": ("rasterize", "rasterize_svg", "drawn", "update_drawn", "use_as_decal")}
"""The pages about its operators and settings; see `manual.Manual`."""
KEYS = (
    Key("rasterize", "X", "Object Mode"),
    Key("update_drawn", "U", "Image"),
)
"""The default shortcuts of its operators; see `keys.Keys`."""

register, unregister = registration(properties, operators, panels)
