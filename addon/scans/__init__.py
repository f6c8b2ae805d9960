# SPDX-License-Identifier: GPL-3.0-or-later

"""Surfaces of scans: points with normals to closed meshes."""

from ..core.registration import registration
from . import operator, panel, properties

MANUAL = {"scans": ("reconstruct",)}
"""The pages about its operators and settings; see `manual.Manual`."""

register, unregister = registration(properties, operator, panel)
