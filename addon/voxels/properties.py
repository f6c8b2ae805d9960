# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings of voxelizing and booleans as properties of operators, scenes and results.

In a scene both share the settings that they have in common.
"""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    FloatProperty,
    IntProperty,
    IntVectorProperty,
    PointerProperty,
    StringProperty,
)

from ..core import preset_menu, presets
from ..core.properties import properties, shared_properties, values
from ..core.registration import classes, registration, state
from ..core.sidebar import GroupedSettings, note, subpanel
from ..core.translations import tr
from .choices import BooleanSettings, VoxelizeSettings, VoxelSettings

# Both have the same presets, which leave these settings to the scene.
_OF_SCENES = ("output", "originals", "operation", "operands", "use_keep_resolution")
VOXELIZE = presets.Kind("voxelize", "prefilter_voxelize", [(VoxelizeSettings, _OF_SCENES)])
BOOLEAN = presets.Kind("voxelize", "prefilter_boolean", [(BooleanSettings, _OF_SCENES)])


class VoxelProperties(GroupedSettings):
    """A mixin: draws the settings that voxelizing and booleans have in common."""

    def draw_basic(self, layout: bpy.types.UILayout) -> None:
        """Draws the usual settings."""
        self._draw_first(layout)
        layout.prop(self, "resolution")
        layout.prop(self, "depth" if self.resolution == "depth" else "voxel_size")
        if bpy.context.mode == "SCULPT":
            # Sculpting replaces the mesh, with small triangles for brushes.
            return
        if self._makes_mesh():
            layout.prop(self, "faces")
            row = layout.row()
            row.active = self.faces == "triangles"
            row.prop(self, "adaptivity")
        self._draw_last(layout)
        if self._makes_mesh():
            self._draw_originals(layout)

    def draw_groups(self, layout: bpy.types.UILayout) -> None:
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
        row = layout.row()
        row.active = self.faces == "triangles"
        row.prop(self, "use_cleanup")
        row = layout.row(heading="Smooth Shading", align=True)
        row.prop(self, "use_smooth_shading", text="")
        part = row.row()
        part.active = self.use_smooth_shading
        part.prop(self, "smooth_angle", text="")

    def _makes_mesh(self) -> bool:
        return True

    def _draw_originals(self, layout: bpy.types.UILayout) -> None:
        """Draws the treatment of the original."""
        layout.prop(self, "originals")

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings before the resolution."""

    def _draw_last(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings after the resolution."""


class VoxelizeProperties(VoxelProperties):
    """The properties of `prefilter.voxelize`."""

    __annotations__ = properties(VoxelizeSettings)

    def to_settings(self) -> VoxelizeSettings:
        """Returns the settings."""
        return values(self, VoxelizeSettings)

    def _makes_mesh(self) -> bool:
        return self.output == "mesh" or bpy.context.mode == "SCULPT"

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
        """Draws the settings that only booleans have."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "operation")
        layout.prop(self, "operands")
        self._draw_keeping(layout)

    def _draw_keeping(self, layout: bpy.types.UILayout) -> None:
        """Draws nothing; the operator sets the resolution itself."""

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        self.draw_own(layout)


class PREFILTER_PG_voxelize(VoxelizeProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


class PREFILTER_PG_boolean(BooleanProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; shared ones are stored with those of voxelizing."""

    __annotations__ = shared_properties(VoxelSettings, VOXELIZE.group)

    def _draw_keeping(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "use_keep_resolution")


class PREFILTER_PG_operand(bpy.types.PropertyGroup):
    """An object that a result was combined with."""

    obj: PointerProperty(type=bpy.types.Object)


class PREFILTER_PG_voxel_result(VoxelProperties, bpy.types.PropertyGroup):
    """The recipe of an object, which its panel shows.

    Attributes:
        is_made: Whether the object is a result.
        is_boolean: Whether a boolean made it.
        is_operand: Whether a result was made with it as an operand.
        operands: Objects that it was combined with.
        mesh: Checksum of the mesh as it was made.
        cell: Side of a cell in the object's own space: of a cube with the cell's volume there.
    """

    __annotations__ = (
        properties(VoxelizeSettings, {"output", "filepath"})
        | properties(BooleanSettings, {"operands"})
        | {
            "is_made": BoolProperty(),
            "is_boolean": BoolProperty(),
            "is_operand": BoolProperty(),
            "operands": CollectionProperty(type=PREFILTER_PG_operand),
            "mesh": StringProperty(),
            "cell": FloatProperty(),
        }
    )

    def to_settings(self) -> VoxelizeSettings | BooleanSettings:
        """Returns the settings."""
        if self.is_boolean:
            return values(self, BooleanSettings, {"operands"})
        return values(self, VoxelizeSettings, {"output", "filepath"})

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        if self.is_boolean:
            layout.prop(self, "operation")

    def _draw_originals(self, layout: bpy.types.UILayout) -> None:
        """Draws nothing; the original is kept for updates."""


class PREFILTER_PG_found_places(bpy.types.PropertyGroup):
    """Faces or edges of one kind, on one mesh.

    Attributes:
        kind: A kind of `findings`.
        operand: Name of the operand; empty for the original.
        count: Number of faces or edges.
        rows: Their encoded indices; see `places`.
    """

    kind: StringProperty()
    operand: StringProperty()
    count: IntProperty()
    rows: StringProperty()


class PREFILTER_PG_found(bpy.types.PropertyGroup):
    """Stored report on the sources of a result; see `places`.

    Attributes:
        is_there: Whether a report is stored.
        parts: Number before and after.
        cavities: Number before and after.
        genus: Genus before and after; -1 if it is not known.
        advice: Resolution that preserves thin walls, in the user's language.
        places: The faces and edges.
    """

    is_there: BoolProperty()
    parts: IntVectorProperty(size=2)
    cavities: IntVectorProperty(size=2)
    genus: IntVectorProperty(size=2)
    advice: StringProperty()
    places: CollectionProperty(type=PREFILTER_PG_found_places)


register, unregister = registration(
    state(bpy.types.Scene, VOXELIZE.group, PREFILTER_PG_voxelize),
    state(bpy.types.Scene, BOOLEAN.group, PREFILTER_PG_boolean),
    classes(preset_menu.panel(VOXELIZE), PREFILTER_PG_operand, PREFILTER_PG_found_places),
    state(bpy.types.Object, "prefilter_voxels", PREFILTER_PG_voxel_result),
    state(bpy.types.Object, "prefilter_found", PREFILTER_PG_found),
)
