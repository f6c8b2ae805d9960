# SPDX-License-Identifier: GPL-3.0-or-later

"""The button of the bake: in the 3D view's sidebar, and among Cycles' settings of the cache."""

from typing import TYPE_CHECKING

import bpy

from ..core.sidebar import SidebarPanel, main_button, note, subpanel
from ..core.translations import CONTEXT, tr
from .operator import ICON, PREFILTER_OT_bake_texture_cache

if TYPE_CHECKING:
    from .states import ImageState

_ICONS = {"stale": "FILE_REFRESH", "missing": "X", "packed": "PACKAGE", "unfit": "ERROR"}
_MOST_IMAGES = 8
_PARENT = "CYCLES_RENDER_PT_performance_texture_cache"
# Of another subject, which also removes other levels: operators are known by their names.
_REMOVE_LEVELS = "prefilter.remove_levels"
_ENGINES = frozenset({"CYCLES"})


class _CachePanel:
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from . import states

        layout = self.layout
        found = states.states(context)
        place = main_button(layout, context, PREFILTER_OT_bake_texture_cache)
        if place:
            name = PREFILTER_OT_bake_texture_cache.bl_idname
            place.operator(name, text="Make Texture Cache", icon=ICON)
        if found:
            note(layout, context, f"{tr('Images')}: {states.summary(found)}", "INFO")
        if place and any(one.state == "packed" for one in found):
            operator = layout.operator(
                PREFILTER_OT_bake_texture_cache.bl_idname, text="Unpack and Bake", icon="PACKAGE"
            )
            operator.use_unpack = True
        header, body = subpanel(layout, "cache_images", "Images")
        header.label(text=str(len(found)))
        if body:
            _draw_images(body, context, found)


def _draw_images(
    layout: bpy.types.UILayout, context: bpy.types.Context, found: list["ImageState"]
) -> None:
    """Draws what is to be known of each image, and what takes the cache away."""
    from . import states

    column = layout.column()
    others = [one for one in found if one.state != "baked"]
    for one in others[:_MOST_IMAGES]:
        column.label(text=f"{one.name}: {tr(states.WORDS[one.state])}", icon=_ICONS[one.state])
    if len(others) > _MOST_IMAGES:
        column.label(text=tr("and {} more").format(len(others) - _MOST_IMAGES), icon="BLANK1")
    text = "Overwrites the cache files. Bake again when images change"
    note(column, context, text, "INFO")
    if any(one.state in {"baked", "stale"} for one in found):
        operator = column.operator(_REMOVE_LEVELS, text="Remove from Texture Cache", icon="TRASH")
        operator.kinds, operator.use_all = {"cache"}, True


class PREFILTER_PT_texture_cache(_CachePanel, bpy.types.Panel):
    """The bake into the texture cache, beside Blender's settings of it."""

    bl_label = "Prefilter"
    bl_translation_context = CONTEXT
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_parent_id = _PARENT

    COMPAT_ENGINES = _ENGINES

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the scene is rendered by Cycles."""
        return context.engine in cls.COMPAT_ENGINES


class PREFILTER_PT_texture_cache_sidebar(_CachePanel, SidebarPanel, bpy.types.Panel):
    """The same in the tab."""

    bl_label = "Texture Cache"
    wanted = "a mesh, in a scene for Cycles"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object."""
        from ..bridge.meshes import may_show_image

        return bpy.context.engine in _ENGINES and may_show_image(obj)


_PANELS = (PREFILTER_PT_texture_cache, PREFILTER_PT_texture_cache_sidebar)


def register() -> None:
    """Registers the panels, in a Blender that has the one around the first."""
    if hasattr(bpy.types, _PARENT):
        for panel in _PANELS:
            bpy.utils.register_class(panel)


def unregister() -> None:
    """Removes the panels."""
    for panel in reversed(_PANELS):
        if panel.is_registered:
            bpy.utils.unregister_class(panel)
