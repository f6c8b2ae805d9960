# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of voxelizing and of booleans as properties, of operators and of the scene.

A scene has one set of what both have in common.
"""

import bpy

from ..core import preset_menu, presets
from ..core.properties import properties, shared, values
from ..core.registration import classes, registration, state
from ..core.sidebar import PartedSettings, note, subpanel
from ..core.translations import tr
from .choices import BooleanSettings, VoxelizeSettings, VoxelSettings

# The presets of both are the same.
VOXELIZE = presets.Kind("voxelize", "prefilter_voxelize", [(VoxelizeSettings, ("output",))])
BOOLEAN = presets.Kind(
    "voxelize", "prefilter_boolean", [(BooleanSettings, ("operation", "operands"))]
)


class VoxelProperties(PartedSettings):
    """How the settings are drawn that both have in common; a mixin for their properties."""

    def draw_usual(self, layout: bpy.types.UILayout) -> None:
        """Draws the usual settings."""
        self._draw_first(layout)
        layout.prop(self, "resolution")
        layout.prop(self, "depth" if self.resolution == "depth" else "voxel_size")
        if self._makes_mesh():
            layout.prop(self, "adaptivity")
        self._draw_last(layout)

    def draw_parts(self, layout: bpy.types.UILayout) -> None:
        """Draws the parts."""
        name = type(self).__name__.rpartition("_")[2]
        _, body = subpanel(layout, f"{name}_repair", "Thin Parts and Holes")
        if body:
            self._draw_repair(body)
        if not self._makes_mesh():
            return
        _, body = subpanel(layout, f"{name}_surface", "Surface")
        if body:
            self._draw_surface(body)
        _, body = subpanel(layout, f"{name}_transfer", "Transfer")
        if body:
            column = body.column(align=True)
            for name in ("use_materials", "use_uv_maps", "use_colors", "use_attributes"):
                column.prop(self, name)

    def _draw_repair(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "thickness")
        layout.prop(self, "gap")
        row = layout.row(heading="Close Holes", align=True)
        row.prop(self, "use_close_holes", text="")
        part = row.row()
        part.active = self.use_close_holes
        part.prop(self, "holes", text="")

    def _draw_surface(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "interpolant")
        layout.prop(self, "use_cleanup")
        row = layout.row(heading="Smooth Shading", align=True)
        row.prop(self, "use_smooth_shading", text="")
        part = row.row()
        part.active = self.use_smooth_shading
        part.prop(self, "smooth_angle", text="")

    def _makes_mesh(self) -> bool:
        return True

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        """Draws what comes before the resolution."""

    def _draw_last(self, layout: bpy.types.UILayout) -> None:
        """Draws what comes after the size."""


class VoxelizeProperties(VoxelProperties):
    """The properties of `prefilter.voxelize`."""

    __annotations__ = properties(VoxelizeSettings)

    def to_settings(self) -> VoxelizeSettings:
        """Returns the settings."""
        return values(self, VoxelizeSettings)

    def _makes_mesh(self) -> bool:
        return self.output == "mesh"

    def _draw_last(self, layout: bpy.types.UILayout) -> None:
        from ..bridge.files import volumes

        layout.prop(self, "output")
        if self.output != "volume":
            return
        if volumes.is_available():
            layout.prop(self, "filepath")
        else:
            note(layout, bpy.context, tr(volumes.NEEDED), "ERROR")


class BooleanProperties(VoxelProperties):
    """The properties of `prefilter.boolean`."""

    __annotations__ = properties(BooleanSettings)

    def to_settings(self) -> BooleanSettings:
        """Returns the settings."""
        return values(self, BooleanSettings)

    def draw_own(self, layout: bpy.types.UILayout) -> None:
        """Draws what voxelizing does not have."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "operation")
        layout.prop(self, "operands")

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        self.draw_own(layout)


class PREFILTER_PG_voxelize(VoxelizeProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


class PREFILTER_PG_boolean(BooleanProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; what voxelizing has too is that of its settings."""

    __annotations__ = shared(VoxelSettings, VOXELIZE.group)


register, unregister = registration(
    state(bpy.types.Scene, VOXELIZE.group, PREFILTER_PG_voxelize),
    state(bpy.types.Scene, BOOLEAN.group, PREFILTER_PG_boolean),
    classes(preset_menu.panel(VOXELIZE)),
)
