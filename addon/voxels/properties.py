# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of voxelizing and of booleans as properties, of operators and of the scene."""

import bpy
from bpy.props import PointerProperty

from ..bridge.files import volumes
from ..core.properties import properties, values
from .choices import BooleanSettings, VoxelizeSettings


class VoxelProperties:
    """How the settings are drawn that both have in common; a mixin for their properties."""

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        self.draw_most_used(layout)
        self.draw_others(layout)

    def draw_most_used(self, layout: bpy.types.UILayout) -> None:
        """Draws what is set most often."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        self._draw_first(layout)
        layout.prop(self, "resolution")
        layout.prop(self, "depth" if self.resolution == "depth" else "voxel_size")
        if self._makes_mesh():
            layout.prop(self, "adaptivity")

    def draw_others(self, layout: bpy.types.UILayout) -> None:
        """Draws the other settings."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(align=True)
        column.prop(self, "thickness")
        column.prop(self, "gap")
        row = layout.row(heading="Close Holes", align=True)
        row.prop(self, "use_close_holes", text="")
        part = row.row()
        part.active = self.use_close_holes
        part.prop(self, "holes", text="")
        if self._makes_mesh():
            layout.prop(self, "interpolant")
            layout.prop(self, "use_cleanup")
            column = layout.column(heading="Transfer", align=True)
            for name in ("use_materials", "use_uv_maps", "use_colors", "use_attributes"):
                column.prop(self, name)
            row = layout.row(heading="Smooth Shading", align=True)
            row.prop(self, "use_smooth", text="")
            part = row.row()
            part.active = self.use_smooth
            part.prop(self, "smooth_angle", text="")
        self._draw_last(layout)

    def _makes_mesh(self) -> bool:
        return True

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        """Draws what comes before the resolution."""

    def _draw_last(self, layout: bpy.types.UILayout) -> None:
        """Draws what comes after the shading."""


class VoxelizeProperties(VoxelProperties):
    """The properties of `prefilter.voxelize`."""

    __annotations__ = properties(VoxelizeSettings)

    def to_settings(self) -> VoxelizeSettings:
        """Returns the settings."""
        return values(self, VoxelizeSettings)

    def _makes_mesh(self) -> bool:
        return self.output == "mesh"

    def _draw_last(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "output")
        if self.output != "volume":
            return
        if volumes.is_available():
            layout.prop(self, "filepath")
        else:
            layout.label(text=volumes.NEEDED, icon="ERROR")


class BooleanProperties(VoxelProperties):
    """The properties of `prefilter.boolean`."""

    __annotations__ = properties(BooleanSettings)

    def to_settings(self) -> BooleanSettings:
        """Returns the settings."""
        return values(self, BooleanSettings)

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "operation")
        layout.prop(self, "operands")


class PREFILTER_PG_voxelize(VoxelizeProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


class PREFILTER_PG_boolean(BooleanProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


def register() -> None:
    """Registers the settings on the scene."""
    bpy.utils.register_class(PREFILTER_PG_voxelize)
    bpy.utils.register_class(PREFILTER_PG_boolean)
    bpy.types.Scene.prefilter_voxelize = PointerProperty(type=PREFILTER_PG_voxelize)
    bpy.types.Scene.prefilter_boolean = PointerProperty(type=PREFILTER_PG_boolean)


def unregister() -> None:
    """Removes the settings from the scene."""
    del bpy.types.Scene.prefilter_boolean
    del bpy.types.Scene.prefilter_voxelize
    bpy.utils.unregister_class(PREFILTER_PG_boolean)
    bpy.utils.unregister_class(PREFILTER_PG_voxelize)
