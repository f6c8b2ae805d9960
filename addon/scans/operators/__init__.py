# SPDX-License-Identifier: GPL-3.0-or-later

"""The operators on scans, one a file."""

from ...core.registration import classes, registration
from .drop_points import PREFILTER_FH_points, PREFILTER_OT_drop_points
from .import_points import PREFILTER_OT_import_points
from .reconstruct import PREFILTER_OT_reconstruct
from .trim_reconstruction import PREFILTER_OT_trim_reconstruction

register, unregister = registration(
    classes(
        PREFILTER_OT_reconstruct,
        PREFILTER_OT_trim_reconstruction,
        PREFILTER_OT_import_points,
        PREFILTER_OT_drop_points,
    ),
    classes(PREFILTER_FH_points),
)
