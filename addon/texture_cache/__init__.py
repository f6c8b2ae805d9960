# SPDX-License-Identifier: GPL-3.0-or-later

"""Mipmaps fitted to meshes in Cycles' texture cache."""

from ..core.registration import registration
from . import menus, operator, panel

MANUAL = {"texture_cache": ("bake_texture_cache",)}
"""The pages about its operators and settings; see `manual.Manual`."""

register, unregister = registration(operator, panel, menus)
