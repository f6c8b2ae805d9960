# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of reconstructing as properties, of the operator and of the scene."""

import bpy
from bpy.props import PointerProperty

from ..core.properties import properties, values
from .choices import ScanSettings


class ScanProperties:
    """The properties of `prefilter.reconstruct`."""

    __annotations__ = properties(ScanSettings)

    def to_settings(self) -> ScanSettings:
        """Returns the settings."""
        return values(self, ScanSettings)

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        self.draw_most_used(layout)
        self.draw_others(layout)

    def draw_most_used(self, layout: bpy.types.UILayout) -> None:
        """Draws what is set most often."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "resolution")
        layout.prop(self, "depth" if self.resolution == "depth" else "voxel_size")
        layout.prop(self, "wavelet")

    def draw_others(self, layout: bpy.types.UILayout) -> None:
        """Draws the other settings."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(heading="Surface", align=True)
        column.prop(self, "use_smooth")
        column.prop(self, "use_fit")
        column.prop(self, "use_smooth_shading")
        layout.prop(self, "trim", text="Trim (Cells)")
        layout.prop(self, "isovalue")
        if self.isovalue == "custom":
            layout.prop(self, "custom_isovalue")
        layout.prop(self, "points")
        layout.prop(self, "memory_limit", text="Memory (MB)")


class PREFILTER_PG_reconstruct(ScanProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


def register() -> None:
    """Registers the settings on the scene."""
    bpy.utils.register_class(PREFILTER_PG_reconstruct)
    bpy.types.Scene.prefilter_reconstruct = PointerProperty(type=PREFILTER_PG_reconstruct)


def unregister() -> None:
    """Removes the settings from the scene."""
    del bpy.types.Scene.prefilter_reconstruct
    bpy.utils.unregister_class(PREFILTER_PG_reconstruct)
