# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake in the menus Image > Prefilter and Object > Prefilter."""

import bpy

from ..core.menus import PREFILTER_MT_image, PREFILTER_MT_object
from .operator import PREFILTER_OT_bake_texture_cache


def register() -> None:
    """Adds the entries."""
    PREFILTER_MT_image.append(_draw)
    PREFILTER_MT_object.append(_draw)


def unregister() -> None:
    """Removes them."""
    PREFILTER_MT_object.remove(_draw)
    PREFILTER_MT_image.remove(_draw)


def _draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.operator(PREFILTER_OT_bake_texture_cache.bl_idname, icon="TEXTURE")
