# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxels of any mesh: closed surfaces, volumes, and set operations."""

from ..core.registration import registration
from . import operators, panel, properties

MANUAL = {"voxels": ("voxelize", "boolean")}
"""The pages about its operators and settings; see `manual.Manual`."""

register, unregister = registration(properties, operators, panel)
