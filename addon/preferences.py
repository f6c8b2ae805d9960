# SPDX-License-Identifier: GPL-3.0-or-later

"""The preferences of the add-on: what its operators and commands do where a user says nothing."""

from dataclasses import dataclass

import bpy

from . import manual
from .core.options import number, one_of
from .core.preferences import PACKAGE
from .core.properties import properties
from .mipmaps.choices import FILE_FORMATS, ModelSettings


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
    memory_limit: int = number(
        0,
        "Memory Limit (MiB)",
        "Reconstruct Surface uses at most this many MiB beside the points, and temporary files for "
        "the rest; Voxelize, Voxel Boolean and Rasterize refuse what needs more. 0 sets no limit",
        low=0,
        display={"soft_max": 65536},
    )
    file_format: str = one_of(
        ModelSettings.file_format,
        "File Format",
        "Default format of the files that bakes write",
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
        return self.memory_limit

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
        layout.prop(self, "memory_limit")
        layout.prop(self, "file_format")
        row = layout.row()
        row.alignment = "RIGHT"
        row.operator("wm.url_open", text="Manual", icon="HELP").url = manual.page()


register, unregister = bpy.utils.register_classes_factory((PREFILTER_AP_preferences,))
