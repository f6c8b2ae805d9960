# SPDX-License-Identifier: GPL-3.0-or-later

"""The button in Cycles' render properties, under Performance, Texture Cache."""

import bpy

from ..core.sidebar import button
from .operator import ICON, PREFILTER_OT_bake_texture_cache

_ICONS = {"stale": "FILE_REFRESH", "missing": "X", "packed": "PACKAGE", "unfit": "ERROR"}
_MOST_IMAGES = 8
_PARENT = "CYCLES_RENDER_PT_performance_texture_cache"
# Of another subject, which also removes other levels: operators are known by their names.
_REMOVE_LEVELS = "prefilter.remove_levels"


class PREFILTER_PT_texture_cache(bpy.types.Panel):
    """The bake into the texture cache, beside Blender's settings of it."""

    bl_label = "Prefilter"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_parent_id = _PARENT

    COMPAT_ENGINES = frozenset({"CYCLES"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the scene is rendered by Cycles."""
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from . import states

        column = self.layout.column()
        found = states.states(context)
        place = button(column, context, PREFILTER_OT_bake_texture_cache)
        if place:
            place.operator(PREFILTER_OT_bake_texture_cache.bl_idname, icon=ICON)
        if place and any(one.state == "packed" for one in found):
            operator = place.operator(
                PREFILTER_OT_bake_texture_cache.bl_idname, text="Unpack and Bake", icon="PACKAGE"
            )
            operator.use_unpack = True
        if any(one.state in {"baked", "stale"} for one in found):
            operator = column.operator(
                _REMOVE_LEVELS, text="Remove from Texture Cache", icon="TRASH"
            )
            operator.kinds, operator.use_all = {"cache"}, True
        if found:
            column.label(text=f"Images: {states.summary(found)}")
        others = [one for one in found if one.state != "baked"]
        for one in others[:_MOST_IMAGES]:
            column.label(text=f"{one.name}: {states.WORDS[one.state]}", icon=_ICONS[one.state])
        if len(others) > _MOST_IMAGES:
            column.label(text=f"and {len(others) - _MOST_IMAGES} more", icon="BLANK1")
        column.label(text="Overwrites the cache files", icon="INFO")
        column.label(text="Bake again when images change", icon="BLANK1")


def register() -> None:
    """Registers the panel, in a Blender that has the one around it."""
    if hasattr(bpy.types, _PARENT):
        bpy.utils.register_class(PREFILTER_PT_texture_cache)


def unregister() -> None:
    """Removes the panel."""
    if PREFILTER_PT_texture_cache.is_registered:
        bpy.utils.unregister_class(PREFILTER_PT_texture_cache)
