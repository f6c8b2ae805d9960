# SPDX-License-Identifier: GPL-3.0-or-later

"""The add-on's tab in the sidebar of the 3D view."""

import bpy


class SidebarPanel:
    """A mixin for panels of that tab."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Prefilter"
    bl_context = "objectmode"

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object, the active one."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an active object that the panel is for."""
        return context.active_object is not None and cls.fits(context.active_object)


class OptionsPanel:
    """A mixin for panels below others, with what is set less often."""

    bl_label = "Options"
    bl_options = frozenset({"DEFAULT_CLOSED"})
