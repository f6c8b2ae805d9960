# SPDX-License-Identifier: GPL-3.0-or-later

"""Mipmaps that know the mesh: bakes, levels in view, Cycles' texture cache."""

from ..core.registration import registration
from . import menus, operators, panels, properties, remembered, view

register, unregister = registration(properties, remembered, view, operators, panels, menus)
