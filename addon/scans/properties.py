# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of reconstructing as properties, of the operator and of the scene."""

import bpy
from bpy.props import PointerProperty

from ..core.properties import properties, values
from ..core.sidebar import subpanel
from .choices import ScanSettings


class ScanProperties:
    """The properties of `prefilter.reconstruct`."""

    __annotations__ = properties(ScanSettings)

    def to_settings(self) -> ScanSettings:
        """Returns the settings."""
        return values(self, ScanSettings)

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "resolution")
        layout.prop(self, "depth" if self.resolution == "depth" else "voxel_size")
        layout.prop(self, "trim", text="Trim (Cells)")
        layout.prop(self, "points")
        _, body = subpanel(layout, "scan_surface", "Surface")
        if body:
            body.prop(self, "wavelet")
            column = body.column(align=True)
            for name in ("use_smooth", "use_fit", "use_smooth_shading"):
                column.prop(self, name)
            body.prop(self, "isovalue")
            if self.isovalue == "custom":
                body.prop(self, "custom_isovalue")
        _, body = subpanel(layout, "scan_performance", "Performance")
        if body:
            body.prop(self, "memory_limit", text="Memory (MB)")


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
