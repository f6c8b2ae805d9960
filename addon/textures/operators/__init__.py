# SPDX-License-Identifier: GPL-3.0-or-later

"""The operators on mipmaps."""

import bpy

from .bake_mipmaps import PREFILTER_OT_bake_mipmaps
from .bake_model import PREFILTER_OT_bake_model
from .export import PREFILTER_OT_export_mipmaps, PREFILTER_OT_export_model
from .fill_unused import PREFILTER_OT_fill_unused
from .plot_error import PREFILTER_OT_plot_error
from .preview_levels import PREFILTER_OT_end_preview, PREFILTER_OT_preview_levels
from .preview_on_model import (
    PREFILTER_OT_end_model_preview,
    PREFILTER_OT_preview_on_model,
)
from .remove_levels import PREFILTER_OT_remove_levels
from .show_weights import PREFILTER_OT_show_source, PREFILTER_OT_show_weights

_CLASSES = (
    PREFILTER_OT_bake_mipmaps,
    PREFILTER_OT_bake_model,
    PREFILTER_OT_export_mipmaps,
    PREFILTER_OT_export_model,
    PREFILTER_OT_preview_levels,
    PREFILTER_OT_end_preview,
    PREFILTER_OT_preview_on_model,
    PREFILTER_OT_end_model_preview,
    PREFILTER_OT_remove_levels,
    PREFILTER_OT_plot_error,
    PREFILTER_OT_show_weights,
    PREFILTER_OT_show_source,
    PREFILTER_OT_fill_unused,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
