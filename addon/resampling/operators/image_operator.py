# SPDX-License-Identifier: GPL-3.0-or-later

"""What the operators share that work on an image."""

from typing import TYPE_CHECKING

import bpy
from bpy.props import BoolProperty, StringProperty

from ...bridge import editors
from ...core.operator import WorkOperator

if TYPE_CHECKING:
    from ...bridge.images import Picture
    from ..new_picture import NewPicture


class ImageOperator:
    """A mixin: has an image."""

    image: StringProperty(
        name="Image",
        description="The image to work on; the image of the editor if empty",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an image."""
        if context.area is not None and context.area.type == "IMAGE_EDITOR":
            if context.space_data.image is None:
                cls.poll_message_set("Open an image in this editor first")
                return False
        elif not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True

    def chosen_image(self, context: bpy.types.Context) -> bpy.types.Image:
        """Returns the image that is named, or shown.

        Raises:
            ValueError: There is none.
        """
        from ...bridge import images

        shown = getattr(context.space_data, "image", None)
        image = images.find(self.image) if self.image else shown
        if image is None:
            raise ValueError("image: no name is given, and the editor shows no image")
        return image


class NewImageOperator(ImageOperator, WorkOperator):
    """A mixin: a new image, beside the old one or in its place.

    A subclass has `doing` and `work_on`.
    """

    use_in_place: BoolProperty(
        name="Use Copy Everywhere",
        description="Have materials, and whatever else uses the image, use the copy instead",
        default=False,
    )

    if TYPE_CHECKING:
        work: NewPicture | None

    def work_on(self, picture: "Picture") -> "NewPicture":
        """Returns what is to do to an image."""
        raise NotImplementedError

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an image."""
        return cls.may_be_redone(context) or super().poll(context)

    def read_work(self, context: bpy.types.Context) -> "NewPicture":
        """Copies the image."""
        from ..new_picture import read

        image = self.chosen_image(context)
        # The editor will show the copy, and nothing once that is undone to be done again.
        self.image = image.name
        return self.work_on(read(image))

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

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)
        layout.prop(self, "use_in_place")
