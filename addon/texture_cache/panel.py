# SPDX-License-Identifier: GPL-3.0-or-later

"""The panels of the bake, in the 3D view's sidebar and in Cycles' settings of the cache."""

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
# An operator of another subject, which must not be imported here.
_REMOVE_LEVELS = "prefilter.remove_levels"
_ENGINES = frozenset({"CYCLES"})


class _CachePanel:
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from . import states

        layout = self.layout
        images = states.states(context)
        row = main_button(layout, context, PREFILTER_OT_bake_texture_cache)
        if row:
            name = PREFILTER_OT_bake_texture_cache.bl_idname
            row.operator(name, text="Make Texture Cache", icon=ICON)
        if images:
            note(layout, context, f"{tr('Images')}: {states.summary(images)}", "INFO")
        if row and any(image.state == "packed" for image in images):
            operator = layout.operator(
                PREFILTER_OT_bake_texture_cache.bl_idname, text="Unpack and Bake", icon="PACKAGE"
            )
            operator.use_unpack = True
        header, body = subpanel(layout, "cache_images", "Images")
        header.label(text=str(len(images)))
        if body:
            _draw_images(body, context, images)


def _draw_images(
    layout: bpy.types.UILayout, context: bpy.types.Context, images: list["ImageState"]
) -> None:
    """Draws the states of images, and the button that removes the cache."""
    from . import states

    column = layout.column()
    others = [image for image in images if image.state != "baked"]
    for image in others[:_MOST_IMAGES]:
        state = tr(states.WORDS[image.state])
        column.label(text=f"{image.name}: {state}", icon=_ICONS[image.state])
    if len(others) > _MOST_IMAGES:
        column.label(text=tr("and {} more").format(len(others) - _MOST_IMAGES), icon="BLANK1")
    text = "Overwrites the cache files. Bake again when images change"
    note(column, context, text, "INFO")
    if any(image.state in {"baked", "stale"} for image in images):
        operator = column.operator(_REMOVE_LEVELS, text="Remove from Texture Cache", icon="TRASH")
        operator.kinds, operator.use_all = {"cache"}, True


class PREFILTER_PT_texture_cache(_CachePanel, bpy.types.Panel):
    """The panel below Cycles' settings of the texture cache."""

    bl_label = "Prefilter"
    bl_translation_context = CONTEXT
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_parent_id = _PARENT

    COMPAT_ENGINES = _ENGINES

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the scene is rendered by Cycles."""
        return context.engine in cls.COMPAT_ENGINES


class PREFILTER_PT_texture_cache_sidebar(_CachePanel, SidebarPanel, bpy.types.Panel):
    """The panel in the tab of the 3D view."""

    bl_label = "Texture Cache"
    required_object = "a mesh, in a scene for Cycles"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Returns whether Cycles renders the scene, and an object may show an image."""
        from ..bridge.meshes import may_show_image

        return bpy.context.engine in _ENGINES and may_show_image(obj)


_PANELS = (PREFILTER_PT_texture_cache, PREFILTER_PT_texture_cache_sidebar)


def register() -> None:
    """Registers the panels, if Blender has the parent panel."""
    if hasattr(bpy.types, _PARENT):
        for panel in _PANELS:
            bpy.utils.register_class(panel)


def unregister() -> None:
    """Removes the panels."""
    for panel in reversed(_PANELS):
        if panel.is_registered:
            bpy.utils.unregister_class(panel)
