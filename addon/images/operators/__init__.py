# SPDX-License-Identifier: GPL-3.0-or-later

"""The operators on resizing, resampling and tables."""

import bpy

from .drag_corners import PREFILTER_OT_drag_corners
from .preview_plane import PREFILTER_OT_end_plane, PREFILTER_OT_preview_plane
from .resample_image import PREFILTER_OT_resample_image
from .resize_image import PREFILTER_OT_resize_image
from .sampling_table import PREFILTER_OT_sampling_table

register, unregister = bpy.utils.register_classes_factory(
    (
        PREFILTER_OT_resize_image,
        PREFILTER_OT_resample_image,
        PREFILTER_OT_drag_corners,
        PREFILTER_OT_preview_plane,
        PREFILTER_OT_end_plane,
        PREFILTER_OT_sampling_table,
    )
)
