# SPDX-License-Identifier: GPL-3.0-or-later

"""Mipmaps that know the mesh in Cycles' texture cache."""

from ..core.registration import registration
from . import menus, operator, panel

register, unregister = registration(operator, panel, menus)
