# SPDX-License-Identifier: GPL-3.0-or-later

"""Vector shapes to images: curves, texts, SVG files, and UV maps as masks."""

from ..core.registration import registration
from . import operators, panels, properties

register, unregister = registration(properties, operators, panels)
