# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.update_drawn`: updates an image of shapes in place."""

from typing import TYPE_CHECKING

import bpy

from ...bridge.image_operator import ImageOperator
from ...core.translations import tr
from ...core.wording import Sentence
from .shape_operator import ShapeOperator

if TYPE_CHECKING:
    from ..rasterization import Load, Rasterization


class PREFILTER_OT_update_drawn(ImageOperator, ShapeOperator, bpy.types.Operator):
    """Rasterizes the present state of an image's objects or file again."""

    bl_idname = "prefilter.update_drawn"
    bl_label = "Update Rasterized Image"
    bl_description = (
        "Rasterize again what this image shows, with the settings of the image, in place: whatever "
        "uses the image shows the new one"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether there is an image made by Rasterize."""
        from ..provenance import is_drawn

        if context.area is not None and context.area.type == "IMAGE_EDITOR":
            if not is_drawn(cls.shown_image(context)):
                cls.poll_message_set(tr("The image of this editor was not made by Rasterize"))
                return False
        elif not any(is_drawn(image) for image in bpy.data.images):
            cls.poll_message_set(tr("No image in this file was made by Rasterize"))
            return False
        return True

    def duration(self, load: "Load") -> float:
        """Returns the same duration as before."""
        del load
        return 1.0

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws nothing: the settings are those of the image."""

    def chosen_image(self, context: bpy.types.Context) -> bpy.types.Image:
        """Returns the image that is named or shown, or the only one made by Rasterize."""
        from ...bridge import images

        if self.image:
            return images.find(self.image)
        return self.shown_image(context) or _only_drawn()

    def read_work(self, context: bpy.types.Context) -> "Rasterization":
        """Copies the shapes of the image."""
        from ..provenance import is_drawn, load_request
        from ..rasterization import Rasterization

        image = self.chosen_image(context)
        if not is_drawn(image):
            raise ValueError(Sentence("image '{}' was not made by Rasterize", image.name))
        if image.library is not None:
            raise ValueError(
                Sentence("image '{}' is linked; update it in its own file", image.name)
            )
        request, settings, warnings = load_request(image)
        self.warn(warnings)
        return Rasterization.read(request, settings, context, image=image)


def _only_drawn() -> bpy.types.Image:
    from ..provenance import is_drawn

    drawn = [image for image in bpy.data.images if is_drawn(image)]
    if len(drawn) != 1:
        raise ValueError(Sentence("image: no name is given, and the editor shows no image"))
    return drawn[0]
