# SPDX-License-Identifier: GPL-3.0-or-later

"""Mipmaps that know the mesh: bakes, and levels in view."""

from ..core.registration import registration
from . import menus, operators, panels, properties, view

register, unregister = registration(properties, view, operators, panels, menus)
