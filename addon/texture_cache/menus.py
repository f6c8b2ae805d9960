# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake in the menus Image > Prefilter and Object > Prefilter."""

import bpy

from ..core.menus import PREFILTER_MT_image, PREFILTER_MT_object
from ..core.registration import entry, registration
from .operator import ICON, PREFILTER_OT_bake_texture_cache


def _draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.operator(PREFILTER_OT_bake_texture_cache.bl_idname, icon=ICON)


register, unregister = registration(
    entry(PREFILTER_MT_image, _draw), entry(PREFILTER_MT_object, _draw)
)
