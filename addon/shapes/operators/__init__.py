# SPDX-License-Identifier: GPL-3.0-or-later

"""The operators on shapes."""

from ...core.registration import classes, registration
from .rasterize import PREFILTER_OT_rasterize
from .rasterize_svg import PREFILTER_FH_svg, PREFILTER_OT_rasterize_svg
from .update_drawn import PREFILTER_OT_update_drawn
from .use_as_decal import PREFILTER_OT_use_as_decal

register, unregister = registration(
    classes(PREFILTER_OT_rasterize, PREFILTER_OT_rasterize_svg),
    classes(PREFILTER_OT_update_drawn, PREFILTER_OT_use_as_decal),
    classes(PREFILTER_FH_svg),
)
