# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of other sizes and in other places."""

from ..core.registration import registration
from . import operators, panels, properties, view

register, unregister = registration(properties, view, operators, panels)
