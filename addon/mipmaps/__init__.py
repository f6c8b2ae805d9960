"""Mipmaps that know the mesh: bakes, levels in view, Cycles' texture cache."""

from ..core.registration import registration
from . import menus, operators, panels, properties, users, view

register, unregister = registration(properties, users, view, operators, panels, menus)
