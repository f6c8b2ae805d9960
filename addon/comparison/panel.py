# SPDX-License-Identifier: GPL-3.0-or-later

"""The switch between a result and its source, in the 3D view's tab and the Object menu."""

import bpy

from ..core.menus import PREFILTER_MT_object
from ..core.registration import classes, entry, registration
from ..core.sidebar import Tab
from .operators import PREFILTER_OT_forget_source, PREFILTER_OT_switch_source


class PREFILTER_PT_before_after(Tab, bpy.types.Panel):
    """The switch, if the active object has a source or a result."""

    bl_label = "Before and After"
    bl_context = "objectmode"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the active object is a result or a source."""
        from ..bridge.kept_sources import result_of

        return result_of(context.active_object) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        from ..bridge.kept_sources import result_of

        result = result_of(context.active_object)
        is_source = result is not None and result.prefilter_made_of.is_source_shown
        row = self.layout.row(align=True)
        row.operator(
            PREFILTER_OT_switch_source.bl_idname,
            text="Show Result" if is_source else "Show Source",
            icon="LOOP_FORWARDS" if is_source else "LOOP_BACK",
        )
        row.operator(PREFILTER_OT_forget_source.bl_idname, text="", icon="X")


def _draw_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.separator()
    menu.layout.operator(PREFILTER_OT_switch_source.bl_idname, icon="LOOP_BACK")
    menu.layout.operator(PREFILTER_OT_forget_source.bl_idname, icon="X")


register, unregister = registration(
    classes(PREFILTER_PT_before_after), entry(PREFILTER_MT_object, _draw_menu)
)
