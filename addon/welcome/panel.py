# SPDX-License-Identifier: GPL-3.0-or-later

"""The welcome panel, at the top of the 3D view's tab until it is dismissed."""

import bpy

from ..core.preferences import preference
from ..core.sidebar import Tab
from ..core.translations import marked
from .choices import DEMONSTRATIONS, is_demonstration
from .operators import (
    PREFILTER_OT_demonstrate,
    PREFILTER_OT_dismiss_welcome,
    PREFILTER_OT_end_demonstration,
)

_LINES = (
    marked("Each panel makes one thing"),
    marked("F9 changes it, Esc cancels it"),
    marked("Try it on a model of ours:"),
)
_ICONS = {"mipmaps": "TEXTURE", "solid": "MOD_REMESH", "surface": "POINTCLOUD_DATA"}


class PREFILTER_PT_welcome(Tab, bpy.types.Panel):
    """Three lines of help, and the buttons of the demonstrations."""

    bl_label = "Welcome to Prefilter"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether it is not dismissed; a demonstration always needs the button back."""
        return preference("show_welcome", default=True) or _is_demonstration(context)

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """Draws the Dismiss button."""
        del context
        name = PREFILTER_OT_dismiss_welcome.bl_idname
        self.layout.operator(name, text="", icon="X", emboss=False)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        column = self.layout.column(align=True)
        for line in _LINES:
            column.label(text=line)
        column = self.layout.column(align=True)
        name = PREFILTER_OT_demonstrate.bl_idname
        for key, choice in DEMONSTRATIONS.items():
            column.operator(name, text=choice.label, icon=_ICONS[key]).kind = key
        if _is_demonstration(context):
            self.layout.operator(PREFILTER_OT_end_demonstration.bl_idname, icon="LOOP_BACK")


def _is_demonstration(context: bpy.types.Context) -> bool:
    return is_demonstration(context.scene)


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_welcome,))
