# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.use_as_decal`: an image of shapes on a plane in their place, or in a material."""

import bpy

from ...bridge.image_operator import ImageOperator
from ...core.outcome import FAILURES, reason
from ...core.properties import properties, values
from ...core.translations import report, tr
from ...core.wording import Sentence
from ..choices import DecalSettings


class PREFILTER_OT_use_as_decal(ImageOperator, bpy.types.Operator):
    """Puts a rasterized image on a plane, or into a material."""

    bl_idname = "prefilter.use_as_decal"
    bl_label = "Use as Decal"
    bl_description = (
        "Put the rasterized image on a plane in the place of its curves and texts, with its alpha, "
        "or over the base color of the active object's material"
    )
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = properties(DecalSettings)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether there is an image made by Rasterize."""
        if _default_image(context) is None:
            if context.area is not None and context.area.type == "IMAGE_EDITOR":
                cls.poll_message_set(tr("The image of this editor was not made by Rasterize"))
            else:
                cls.poll_message_set(tr("No image in this file was made by Rasterize"))
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set(tr("Prefilter works in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Puts the image there."""
        from ...bridge import images
        from ...bridge.color_materials import show_in_views
        from ..decal import use_as_decal
        from ..provenance import is_drawn

        try:
            image = images.find(self.image) if self.image else _default_image(context)
            if image is None or not is_drawn(image):
                raise ValueError(Sentence("image '{}' was not made by Rasterize", self.image))
            self.image = image.name
            outcome = use_as_decal(image, values(self, DecalSettings), context)
        except FAILURES as error:
            self.report({"ERROR"}, report(reason(error)))
            return {"CANCELLED"}
        for warning in outcome.warnings:
            self.report({"WARNING"}, report(warning))
        if show_in_views(context, kind="TEXTURE"):
            self.report({"INFO"}, report("3D views in Solid mode show textures now"))
        self.report({"INFO"}, report(outcome.summary))
        return {"FINISHED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the redo panel."""
        del context
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if self.target == "plane":
            layout.prop(self, "use_hide")
            layout.prop(self, "offset")


def _default_image(context: bpy.types.Context) -> bpy.types.Image | None:
    """Returns the image of an Image editor; elsewhere that of the active object, or the newest."""
    from ..provenance import is_drawn, latest_image, latest_image_of

    if context.area is not None and context.area.type == "IMAGE_EDITOR":
        image = getattr(context.space_data, "image", None)
        return image if is_drawn(image) else None
    active = context.active_object
    return (latest_image_of(active) if active is not None else None) or latest_image()
