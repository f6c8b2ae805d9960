# SPDX-License-Identifier: GPL-3.0-or-later

"""The add-on's preferences: defaults for its operators and commands."""

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType

import bpy

from . import manual
from .core import shortcuts
from .core.options import number
from .core.preferences import PACKAGE
from .core.properties import properties
from .core.translations import CONTEXT


@dataclass(frozen=True)
class Preferences:
    """Defaults that several subjects share."""

    threads: int = number(
        0,
        "Threads",
        "Number of threads to use; 0 uses all",
        low=0,
        high=1024,
    )
    memory_limit: int = number(
        0,
        "Memory Limit (MiB)",
        "Reconstruct Surface uses at most this many MiB beside the points, and temporary files for "
        "the rest; Voxelize, Voxel Boolean and Rasterize refuse what needs more. 0 sets no limit",
        low=0,
        display={"soft_max": 65536},
    )


class PREFILTER_AP_preferences(bpy.types.AddonPreferences):
    """The preferences that Blender shows below the add-on."""

    bl_idname = PACKAGE
    __annotations__ = properties(Preferences)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the preferences."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in type(self).__annotations__:
            layout.prop(self, name)
        shortcuts.draw_keys(layout, context)
        row = layout.row()
        row.alignment = "RIGHT"
        link = row.operator("wm.url_open", text="Manual", text_ctxt=CONTEXT, icon="HELP")
        link.url = manual.page()


class SubjectPreferences:
    """The preferences, with those of all subjects: their optional `PREFERENCES`, dataclasses of
    options."""

    def __init__(self, subjects: Sequence[ModuleType]) -> None:
        """Adds the preferences of the subjects' packages."""
        for subject in subjects:
            if (options := getattr(subject, "PREFERENCES", None)) is not None:
                PREFILTER_AP_preferences.__annotations__ |= properties(options)

    def register(self) -> None:
        """Registers the preferences."""
        bpy.utils.register_class(PREFILTER_AP_preferences)

    def unregister(self) -> None:
        """Unregisters them."""
        bpy.utils.unregister_class(PREFILTER_AP_preferences)
