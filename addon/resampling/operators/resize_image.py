"""`prefilter.resize_image`: an image of another size, beside the old one or in its place."""

import bpy
from bpy.props import BoolProperty, StringProperty

from ...bridge import editors, images
from ...core.operator import WorkOperator
from ..properties import ResizeProperties
from ..resizing import Resizing, read


class PREFILTER_OT_resize_image(ResizeProperties, WorkOperator, bpy.types.Operator):
    """Resizes an image."""

    bl_idname = "prefilter.resize_image"
    bl_label = "Resize Image"
    bl_description = (
        "Make a larger or smaller copy of the image, filtered in linear light, with colors "
        "weighted by alpha"
    )
    bl_options = {"REGISTER", "UNDO"}
    doing = "Resizing"

    image: StringProperty(
        name="Image",
        description="The image to resize; the image of the editor if empty",
        options={"SKIP_SAVE"},
    )
    use_in_place: BoolProperty(
        name="Use Copy Everywhere",
        description="Have materials, and whatever else uses the image, use the copy instead",
        default=False,
    )

    work: Resizing | None = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an image."""
        if cls.may_be_redone(context):
            return True
        if context.area is not None and context.area.type == "IMAGE_EDITOR":
            if context.space_data.image is None:
                cls.poll_message_set("Open an image in this editor first")
                return False
        elif not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True

    def read_work(self, context: bpy.types.Context) -> Resizing:
        """Copies the image."""
        shown = getattr(context.space_data, "image", None)
        image = images.find(self.image) if self.image else shown
        if image is None:
            raise ValueError("image: no name is given, and the editor shows no image")
        # The editor will show the copy, and nothing once that is undone to be done again.
        self.image = image.name
        return Resizing(read(image), self.to_settings(), in_place=self.use_in_place)

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Makes the new image, and shows it in the editor that the operator was called from."""
        del result
        assert self.work is not None
        outcome = self.work.write()
        editors.show(context, bpy.data.images[outcome.images[0]])
        return self.tell(outcome)

    def load(self) -> tuple[int, int]:
        """Returns the size of the image."""
        assert self.work is not None
        return self.work.old_size

    def effort(self, load: tuple[int, int]) -> float:
        """Returns about how many pixels are read and written, times the filter's cost."""
        width, height = self.to_settings().new_size(*load)
        slow = {"least-squares": 8.0, "radial2": 6.0, "radial3": 12.0}
        return (load[0] * load[1] + 2.0 * width * height) * slow.get(self.filter, 1.0)

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)
        layout.prop(self, "use_in_place")
