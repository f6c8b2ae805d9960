"""The settings of the operators: defined once, for an operator and for the scene."""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty, StringProperty

from . import bake
from .bake import Choice


def items(choices: dict[str, Choice]) -> list[tuple[str, str, str]]:
    """Returns the items of an enumeration."""
    return [(key, choice.label, choice.description) for key, choice in choices.items()]


class BakeProperties:
    """The properties of a bake; a mixin for an operator and a property group."""

    filter: EnumProperty(
        name="Filter",
        description="How a texel of a level is made from the image",
        items=items(bake.FILTERS),
        default=bake.Settings.filter,
    )
    wrap: EnumProperty(
        name="Wrap",
        description="What lies outside of the image along U",
        items=items(bake.WRAPS),
        default=bake.Settings.wrap,
    )
    wrap_v: EnumProperty(
        name="V",
        description="What lies outside of the image along V",
        items=items(bake.WRAPS_V),
        default=bake.Settings.wrap_v,
    )
    bounds: EnumProperty(
        name="Value Range",
        description="The range, in scene-linear values, that the texels of a level stay in",
        items=items(bake.BOUNDS),
        default=bake.Settings.bounds,
    )
    levels: IntProperty(
        name="Levels",
        description="Number of levels, the image itself included; 0 makes all of them. "
        "A file always gets all",
        default=bake.Settings.levels,
        min=0,
        soft_max=16,
    )
    use_images: BoolProperty(
        name="Level Images",
        description="Keep each level as a packed image named after the image, with .mip1, .mip2 "
        "and so on",
        default=bake.Settings.use_images,
    )
    filepath: StringProperty(
        name="File",
        description="A tiled, mip-mapped file to write: .exr, .tif or .tx; leave empty for none",
        subtype="FILE_PATH",
        default=bake.Settings.filepath,
    )

    def to_settings(self) -> bake.Settings:
        """Returns the values, with the file's path made absolute."""
        values = {name: getattr(self, name) for name in BakeProperties.__annotations__}
        values["filepath"] = bpy.path.abspath(self.filepath)
        return bake.Settings(**values)

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the properties."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "filter")
        column = layout.column(align=True)
        column.prop(self, "wrap", text="Wrap U")
        column.prop(self, "wrap_v")
        layout.prop(self, "bounds")
        layout.prop(self, "levels")
        layout.separator()
        layout.prop(self, "use_images")
        layout.prop(self, "filepath")


def copy_bake_properties(source: bpy.types.bpy_struct, target: bpy.types.bpy_struct) -> None:
    """Copies the properties of a bake between a property group and an operator's properties."""
    for name in BakeProperties.__annotations__:
        setattr(target, name, getattr(source, name))


class PREFILTER_PG_bake(BakeProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""


def register() -> None:
    """Registers the settings on the scene."""
    bpy.utils.register_class(PREFILTER_PG_bake)
    bpy.types.Scene.prefilter_bake = PointerProperty(type=PREFILTER_PG_bake)


def unregister() -> None:
    """Removes the settings from the scene."""
    del bpy.types.Scene.prefilter_bake
    bpy.utils.unregister_class(PREFILTER_PG_bake)
