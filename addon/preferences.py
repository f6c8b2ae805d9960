# SPDX-License-Identifier: GPL-3.0-or-later

"""The preferences of the add-on: what its operators and commands do where a user says nothing."""

from dataclasses import dataclass

import bpy

from . import manual
from .core.choices import Choice
from .core.options import number, one_of
from .core.preferences import PACKAGE
from .core.properties import properties
from .mipmaps.choices import FILE_FORMATS, ModelSettings

_MIB = {"mib": 1, "gib": 1024}
UNITS = {
    "mib": Choice("MiB", "1024 KiB"),
    "gib": Choice("GiB", "1024 MiB"),
}


@dataclass(frozen=True)
class Preferences:
    """What holds where a user sets nothing."""

    threads: int = number(
        0,
        "Threads",
        "Number of threads to use; 0 uses all",
        low=0,
        high=1024,
    )
    memory_limit: float = number(
        0.0,
        "Memory Limit",
        "Reconstruct Surface uses at most this much memory beside the points, and temporary files "
        "for the rest; Voxelize, Voxel Boolean and Rasterize refuse what needs more. 0 sets no "
        "limit",
        low=0.0,
        high=1048576.0,
        display={"precision": 1, "step": 50},
    )
    memory_unit: str = one_of("gib", "Unit", "Unit of the memory limit", UNITS)
    file_format: str = one_of(
        ModelSettings.file_format,
        "File Format",
        "Format of the files that bakes write, until another is chosen",
        FILE_FORMATS,
    )


class PREFILTER_AP_preferences(bpy.types.AddonPreferences):
    """What Blender shows below the add-on in its preferences."""

    bl_idname = PACKAGE
    __annotations__ = properties(Preferences)

    @property
    def followed_threads(self) -> int:
        """How many threads to use; 0 for all."""
        return self.threads

    @property
    def followed_memory_limit(self) -> int:
        """How many MiB to use; 0 for no limit."""
        if self.memory_limit <= 0.0:
            return 0
        return max(1, round(self.memory_limit * _MIB[self.memory_unit]))

    @property
    def followed_file_format(self) -> str:
        """A key of `FILE_FORMATS`."""
        return self.file_format

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the preferences."""
        del context
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "threads")
        row = layout.row(align=True)
        row.prop(self, "memory_limit")
        unit = row.row(align=True)
        unit.use_property_split = False
        unit.ui_units_x = 3.5
        unit.prop(self, "memory_unit", text="")
        layout.prop(self, "file_format")
        row = layout.row()
        row.alignment = "RIGHT"
        row.operator("wm.url_open", text="Manual", icon="HELP").url = manual.page()


register, unregister = bpy.utils.register_classes_factory((PREFILTER_AP_preferences,))
