# SPDX-License-Identifier: GPL-3.0-or-later

"""The operators on objects, one a file."""

import bpy

from .boolean import PREFILTER_OT_boolean
from .select_found import PREFILTER_OT_select_found
from .update import PREFILTER_OT_update_voxels
from .voxelize import PREFILTER_OT_voxelize

register, unregister = bpy.utils.register_classes_factory(
    (
        PREFILTER_OT_voxelize,
        PREFILTER_OT_boolean,
        PREFILTER_OT_update_voxels,
        PREFILTER_OT_select_found,
    )
)
