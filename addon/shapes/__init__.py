# SPDX-License-Identifier: GPL-3.0-or-later

"""Vector shapes to images: curves, texts, SVG files, and UV maps as masks."""

from ..core.registration import registration
from . import operators, panels, properties

MANUAL = {"shapes": ("rasterize", "rasterize_svg", "drawn", "update_drawn", "use_as_decal")}
"""The pages about its operators and settings; see `manual.Manual`."""

register, unregister = registration(properties, operators, panels)
