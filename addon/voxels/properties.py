"""The settings of voxelizing and of booleans: defined once, for an operator and for the scene."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..bridge.files import volumes
from ..core.choices import items
from . import choices

_Settings = choices.VoxelSettings


class VoxelProperties:
    """What both have in common; a mixin for operators and property groups."""

    resolution: EnumProperty(
        name="Resolution",
        description="How the size of the cells is given",
        items=items(choices.RESOLUTIONS),
        default=_Settings.resolution,
    )
    depth: IntProperty(
        name="Depth",
        description="How often the cube around the object is halved: 8 makes 256 cells along an "
        "axis, and each step more about four times as many triangles",
        default=_Settings.depth,
        min=1,
        max=choices.MOST_DEPTH,
        soft_max=10,
    )
    voxel_size: FloatProperty(
        name="Voxel Size",
        description="The side of a cell in world space",
        subtype="DISTANCE",
        default=_Settings.voxel_size,
        min=choices.LEAST_SIZE,
        soft_min=0.001,
        precision=4,
        step=1,
    )
    interpolant: EnumProperty(
        name="Interpolant",
        description="How the surface runs through the cells",
        items=items(choices.INTERPOLANTS),
        default=_Settings.interpolant,
    )
    use_close_holes: BoolProperty(
        name="Close Holes",
        description="Close each hole by triangles to the middle of its border; without them the "
        "surface ends in steps there",
        default=_Settings.use_close_holes,
    )
    use_cleanup: BoolProperty(
        name="Clean Up",
        description="Collapse short edges: a quarter fewer triangles, and no slivers, which "
        "shade badly",
        default=_Settings.use_cleanup,
    )
    use_materials: BoolProperty(
        name="Materials",
        description="Triangles get the material of the nearest face",
        default=_Settings.use_materials,
    )
    use_colors: BoolProperty(
        name="Color Attributes",
        description="Vertices get the colors of the nearest point of the surface",
        default=_Settings.use_colors,
    )
    use_smooth: BoolProperty(
        name="Smooth Shading",
        description="Shade the result smooth",
        default=_Settings.use_smooth,
    )
    smooth_angle: FloatProperty(
        name="Angle",
        description="Edges between faces that meet at a greater angle stay sharp",
        subtype="ANGLE",
        default=_Settings.smooth_angle,
        min=0.0,
        max=3.141593,
    )

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        self._draw_first(layout)
        layout.prop(self, "resolution")
        layout.prop(self, "depth" if self.resolution == "depth" else "voxel_size")
        layout.prop(self, "use_close_holes")
        if self._makes_mesh():
            layout.prop(self, "interpolant")
            layout.prop(self, "use_cleanup")
            column = layout.column(heading="Transfer", align=True)
            column.prop(self, "use_materials")
            column.prop(self, "use_colors")
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

    output: EnumProperty(
        name="Output",
        description="What to make",
        items=items(choices.OUTPUTS),
        default=choices.VoxelizeSettings.output,
    )
    filepath: StringProperty(
        name="File",
        description="The OpenVDB file of the volume; empty for one beside the .blend file, named "
        "after the object",
        subtype="FILE_PATH",
        default=choices.VoxelizeSettings.filepath,
    )

    def to_settings(self) -> choices.VoxelizeSettings:
        """Returns the settings."""
        return choices.VoxelizeSettings(**_values(self, VoxelizeProperties))

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

    operation: EnumProperty(
        name="Operation",
        description="What to keep",
        items=items(choices.OPERATIONS),
        default=choices.BooleanSettings.operation,
    )
    operands: EnumProperty(
        name="Others",
        description="What becomes of the other selected objects",
        items=items(choices.OPERANDS),
        default=choices.BooleanSettings.operands,
    )

    def to_settings(self) -> choices.BooleanSettings:
        """Returns the settings."""
        return choices.BooleanSettings(**_values(self, BooleanProperties))

    def _draw_first(self, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "operation")
        layout.prop(self, "operands")


class PREFILTER_PG_voxelize(VoxelizeProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


class PREFILTER_PG_boolean(BooleanProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


def copy_voxel_properties(
    source: VoxelProperties, target: VoxelProperties, mixin: type[VoxelProperties]
) -> None:
    """Copies the properties of a mixin between a property group and an operator."""
    for name in _names(mixin):
        setattr(target, name, getattr(source, name))


def _values(properties: VoxelProperties, mixin: type[VoxelProperties]) -> dict[str, object]:
    return {name: getattr(properties, name) for name in _names(mixin)}


def _names(mixin: type[VoxelProperties]) -> list[str]:
    return [name for base in mixin.__mro__[:-1] for name in base.__annotations__]


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
