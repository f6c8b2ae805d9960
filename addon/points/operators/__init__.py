# SPDX-License-Identifier: GPL-3.0-or-later

"""The operators on scans, one a file."""

from ...core.registration import classes, registration
from .align_scans import PREFILTER_OT_align_scans
from .crop_points import PREFILTER_OT_crop_points
from .drop_points import PREFILTER_FH_points, PREFILTER_OT_drop_points
from .import_points import PREFILTER_OT_import_points
from .paint_texture import PREFILTER_OT_paint_texture
from .reconstruct import PREFILTER_OT_reconstruct
from .remove_outliers import PREFILTER_OT_remove_outliers
from .subsample_points import PREFILTER_OT_subsample_points
from .trim_reconstruction import PREFILTER_OT_trim_reconstruction

register, unregister = registration(
    classes(
        PREFILTER_OT_reconstruct,
        PREFILTER_OT_trim_reconstruction,
        PREFILTER_OT_paint_texture,
        PREFILTER_OT_import_points,
        PREFILTER_OT_drop_points,
    ),
    classes(
        PREFILTER_OT_subsample_points,
        PREFILTER_OT_remove_outliers,
        PREFILTER_OT_crop_points,
        PREFILTER_OT_align_scans,
    ),
    classes(PREFILTER_FH_points),
)
