# SPDX-License-Identifier: GPL-3.0-or-later

"""Switching between a result and its source."""

from ..core.registration import registration
from . import operators, panel, properties

MANUAL = {"voxels": ("switch_source", "forget_source", "made_of", "source_object")}
"""The pages about its operators and settings; see `manual.Manual`."""

register, unregister = registration(properties, operators, panel)
