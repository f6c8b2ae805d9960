# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.export_mipmaps` and `prefilter.export_model`: levels to files, in File > Export."""

import os
from typing import TYPE_CHECKING, Any

import bpy
from bpy.props import BoolProperty, StringProperty

from ...core.properties import properties
from ...core.translations import reported
from ..choices import FILE_FORMATS, ModelSettings
from ..properties import BAKE, MODEL
from .bake_mipmaps import PREFILTER_OT_bake_mipmaps
from .bake_model import PREFILTER_OT_bake_model
from .source import image_to_read, shown_image

_GLOB = ";".join(f"*.{extension}" for extension in (*FILE_FORMATS, "tiff"))
_HIDDEN = {"HIDDEN", "SKIP_SAVE"}


class _Export:
    """A mixin: opens the file browser, then bakes with the settings of a panel."""

    bl_options = frozenset({"REGISTER"})
    _is_browsing = False

    filter_glob: StringProperty(default=_GLOB, options={"HIDDEN"})
    if TYPE_CHECKING:
        report: Any

    def browse(self, context: bpy.types.Context) -> set[str]:
        """Opens the file browser."""
        context.window_manager.fileselect_add(self)
        self._is_browsing = True
        return {"RUNNING_MODAL"}

    def bake(self, operator: type[bpy.types.Operator], settings: dict[str, Any]) -> set[str]:
        """Bakes; after the file browser, which must not block, in the background."""
        start = getattr(bpy.ops.prefilter, operator.bl_idname.partition(".")[2])
        mode = "INVOKE_DEFAULT" if self._is_browsing else "EXEC_DEFAULT"
        self._is_browsing = False
        try:
            status = start(mode, **settings)
        except RuntimeError as error:
            self.report({"ERROR"}, reported(error))
            return {"CANCELLED"}
        return {"FINISHED"} if status & {"FINISHED", "RUNNING_MODAL"} else {"CANCELLED"}


class PREFILTER_OT_export_mipmaps(_Export, bpy.types.Operator):
    """Asks for the file of an image's levels, and bakes them."""

    bl_idname = "prefilter.export_mipmaps"
    bl_label = "Export Mipmaps"
    bl_description = (
        "Write the mipmap levels of an image to a file, with the settings of the panel Mipmaps. "
        "The ending of its name chooses the format"
    )

    filepath: StringProperty(name="File", subtype="FILE_PATH", options=_HIDDEN)
    check_existing: BoolProperty(default=True, options={"HIDDEN"})
    image: StringProperty(
        name="Image",
        description="The image whose levels are written",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether there is an image."""
        return PREFILTER_OT_bake_mipmaps.poll(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Suggests the shown image, and a name for its file."""
        from .. import file_names

        del event
        try:
            image = image_to_read(context, self.image or _shown_name(context))
        except ValueError:
            image = next(iter(bpy.data.images))
        self.image = image.name
        if not self.filepath:
            extension = context.scene.prefilter_bake.file_format
            name = f"{file_names.name_of(image)}.{extension}"
            self.filepath = os.path.join(os.path.dirname(bpy.data.filepath), name)
        return self.browse(context)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the settings beside the file browser."""
        del context
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop_search(self, "image", bpy.data, "images")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Bakes."""
        from .. import file_names

        settings = BAKE.of_scene(context) | {"result": "file", "filepath": self.filepath}
        settings["file_format"] = file_names.format_of(self.filepath) or settings["file_format"]
        return self.bake(PREFILTER_OT_bake_mipmaps, settings | {"image": self.image})


class _ModelChoices:
    __annotations__ = properties(ModelSettings, {"material", "result", "folder"})


class PREFILTER_OT_export_model(_ModelChoices, _Export, bpy.types.Operator):
    """Asks for the folder of all images' levels, and bakes them."""

    bl_idname = "prefilter.export_model"
    bl_label = "Export All Mipmaps"
    bl_description = (
        "Write the mipmap levels of every image of the scene, or of the selected meshes, to files "
        "in a folder, with the settings of the panel Mipmaps of All Images"
    )

    directory: StringProperty(name="Folder", subtype="DIR_PATH", options=_HIDDEN)
    filter_folder: BoolProperty(default=True, options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether an object shows an image."""
        return PREFILTER_OT_bake_model.poll(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Suggests the settings of the panel."""
        del event
        settings = context.scene.prefilter_model
        self.objects, self.file_format = settings.objects, settings.file_format
        return self.browse(context)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the settings beside the file browser."""
        del context
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "objects")
        layout.prop(self, "file_format")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Bakes."""
        own = {"folder": self.directory, "result": "file"}
        chosen = {name: getattr(self, name) for name in ("objects", "file_format")}
        return self.bake(PREFILTER_OT_bake_model, MODEL.of_scene(context) | own | chosen)


def _shown_name(context: bpy.types.Context) -> str:
    """Returns the name of an image that the window shows; empty for none."""
    if context.area is not None and context.area.type == "IMAGE_EDITOR":
        image = shown_image(context)
        return image.name if image is not None else ""
    areas = context.screen.areas if context.screen is not None else []
    shown = (area.spaces.active.image for area in areas if area.type == "IMAGE_EDITOR")
    return next((image.name for image in shown if image is not None), "")
