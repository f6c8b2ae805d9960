# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing and resampling of images, and sampling tables."""

from ..core.registration import registration
from . import operators, panels, properties, view

MANUAL = {
    "resize": ("resize", "resize_image"),
    "resample": (
        *("resample", "resample_image", "drag_corners"),
        *("plane", "preview_plane", "end_plane"),
    ),
    "shaders": ("sampling_table",),
}
"""The pages about its operators and settings; see `manual.Manual`."""

register, unregister = registration(properties, view, operators, panels)
