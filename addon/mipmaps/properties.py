"""The settings of the operators: defined once, for an operator and for the scene."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..bridge.files import engines
from ..core.choices import items
from . import choices


class BakeProperties:
    """The properties of a bake; a mixin for an operator and a property group."""

    filter: EnumProperty(
        name="Filter",
        description="How a texel of a level is made from the image",
        items=items(choices.FILTERS),
        default=choices.Settings.filter,
    )
    wrap: EnumProperty(
        name="Wrap",
        description="What lies outside of the image along U",
        items=items(choices.WRAPS),
        default=choices.Settings.wrap,
    )
    wrap_v: EnumProperty(
        name="V",
        description="What lies outside of the image along V",
        items=items(choices.WRAPS_V),
        default=choices.Settings.wrap_v,
    )
    bounds: EnumProperty(
        name="Value Range",
        description="The range, in scene-linear values, that the texels of a level stay in",
        items=items(choices.BOUNDS),
        default=choices.Settings.bounds,
    )
    reader: EnumProperty(
        name="Reader",
        description="What looks up the levels; PAM Bilinear fits them to it, and the preview and "
        "the error plot show what it sees",
        items=items(choices.READERS),
        default=choices.Settings.reader,
    )
    content: EnumProperty(
        name="Content",
        description="What the image holds, which decides how its levels are made",
        items=items(choices.CONTENTS),
        default=choices.Settings.content,
    )
    objects: EnumProperty(
        name="Objects",
        description="Whose surfaces decide how much each texel counts",
        items=items(choices.OBJECTS),
        default=choices.Settings.objects,
    )
    threshold: FloatProperty(
        name="Threshold",
        description="The alpha from which on the material shows the surface",
        subtype="FACTOR",
        default=choices.Settings.threshold,
        min=0.001,
        max=1.0,
    )
    roughness: StringProperty(
        name="Roughness",
        description="An image of the roughness of the same surface, whose levels get what those of "
        "the normal map lose. Leave empty for none",
        default=choices.Settings.roughness,
    )
    roughness_channel: EnumProperty(
        name="Channel",
        description="Where the roughness image holds roughness; its other channels are filtered "
        "as data",
        items=items(choices.ROUGHNESS_CHANNELS),
        default=choices.Settings.roughness_channel,
    )
    roughness_filepath: StringProperty(
        name="Roughness File",
        description="A file of the roughness to write, like the one of the image; leave empty for "
        "none",
        subtype="FILE_PATH",
        default=choices.Settings.roughness_filepath,
    )
    levels: IntProperty(
        name="Levels",
        description="Number of levels, the image itself included; 0 makes all of them. "
        "A file always gets all",
        default=choices.Settings.levels,
        min=0,
        soft_max=16,
    )
    use_subdivision_limit: BoolProperty(
        name="Subdivision Limit",
        description="Objects with a Catmull-Clark modifier on top count as the smooth surface that "
        "subdividing forever would give",
        default=choices.Settings.use_subdivision_limit,
    )
    importance: StringProperty(
        name="Importance",
        description="A vertex group or attribute that says where texels matter more: areas are "
        "multiplied by it; leave empty for none",
        default=choices.Settings.importance,
    )
    seam_weight: FloatProperty(
        name="Seams",
        description="How much it counts that the two sides of a UV seam agree in every level: 0 "
        "leaves seams alone, 1 halves what shows of them. For PAM Bilinear and PAM Trilinear",
        default=choices.Settings.seam_weight,
        min=0.0,
        soft_max=2.0,
        step=10,
    )
    use_frames: BoolProperty(
        name="Frame Range",
        description="Average over frames of the animation instead of the current one only",
        default=choices.Settings.use_frames,
    )
    frame_start: IntProperty(
        name="Start",
        description="The first frame of the average",
        default=choices.Settings.frame_start,
    )
    frame_end: IntProperty(
        name="End",
        description="The last frame of the average",
        default=choices.Settings.frame_end,
    )
    frame_step: IntProperty(
        name="Step",
        description="How far the frames of the average are apart",
        default=choices.Settings.frame_step,
        min=1,
    )
    use_images: BoolProperty(
        name="Level Images",
        description="Keep each level as a packed image named after the image, with .mip01, "
        ".mip02 and so on",
        default=choices.Settings.use_images,
    )
    filepath: StringProperty(
        name="File",
        description="A file of all levels to write: .exr, .tif or .tx for renderers, .dds or .ktx2 "
        "for engines; .png makes a file a level. Leave empty for none",
        subtype="FILE_PATH",
        default=choices.Settings.filepath,
    )
    texture_format: EnumProperty(
        name="Texture Format",
        description="How a DDS or KTX 2 file holds texels",
        items=items(choices.TEXTURE_FORMATS),
        default=choices.Settings.texture_format,
    )

    def to_settings(self) -> choices.Settings:
        """Returns the values, with the file's path made absolute."""
        values = {name: getattr(self, name) for name in BakeProperties.__annotations__}
        values["filepath"] = bpy.path.abspath(self.filepath)
        values["roughness_filepath"] = bpy.path.abspath(self.roughness_filepath)
        if not self._shows_roughness():
            # What an earlier choice has left in fields that are not shown.
            values["roughness"] = values["roughness_filepath"] = ""
        return choices.Settings(**values)

    def _shows_roughness(self) -> bool:
        return self.content == "normal" or (self.content == "auto" and bool(self.roughness))

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the properties."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "filter")
        layout.prop(self, "reader")
        if self.reader != "linear" and self.filter == "pam-trilinear":
            layout.label(text="PAM Trilinear goes with Linear Light", icon="ERROR")
        column = layout.column(align=True)
        column.prop(self, "wrap", text="Wrap U")
        column.prop(self, "wrap_v")
        layout.prop(self, "content")
        if self.content == "cutout":
            layout.prop(self, "threshold")
        if self._shows_roughness():
            layout.prop_search(self, "roughness", bpy.data, "images")
        has_roughness = self._shows_roughness() and self.roughness
        if has_roughness:
            layout.prop(self, "roughness_channel")
        row = layout.row()
        row.active = self.content != "normal"
        row.prop(self, "bounds")
        layout.prop(self, "levels")
        layout.separator()
        layout.prop(self, "objects")
        layout.prop(self, "importance")
        layout.prop(self, "seam_weight")
        layout.prop(self, "use_subdivision_limit")
        layout.prop(self, "use_frames")
        column = layout.column(align=True)
        column.active = self.use_frames
        column.prop(self, "frame_start")
        column.prop(self, "frame_end")
        column.prop(self, "frame_step")
        layout.separator()
        layout.prop(self, "use_images")
        layout.prop(self, "filepath")
        if has_roughness:
            layout.prop(self, "roughness_filepath")
        paths = (self.filepath, self.roughness_filepath if has_roughness else "")
        if any(engines.has_formats(path) for path in paths):
            layout.prop(self, "texture_format")


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
