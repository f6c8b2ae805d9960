# SPDX-License-Identifier: GPL-3.0-or-later

"""A mixin of the operators that resize or resample an image."""

from typing import TYPE_CHECKING

import bpy
from bpy.props import BoolProperty

from ...bridge.image_operator import ImageOperator, MakesImage
from ...core.translations import CONTEXT

if TYPE_CHECKING:
    from ...bridge.images import FloatArray, Picture
    from ...core.outcome import Outcome
    from ..new_picture import NewPicture


class NewImageOperator(ImageOperator, MakesImage):
    """A mixin for operators that make a new image from one, beside it or in its place.

    A subclass has `activity` and `work_on`.
    """

    use_in_place: BoolProperty(
        name="Use Copy Everywhere",
        translation_context=CONTEXT,
        description="Make materials and all other users of the image use the copy instead",
        default=False,
    )

    if TYPE_CHECKING:
        work: NewPicture | None

    def work_on(self, picture: "Picture") -> "NewPicture":
        """Returns the work on an image."""
        raise NotImplementedError

    def keep(self, work: "NewPicture", stored: "FloatArray") -> "Outcome":
        """Makes an image of the new pixels."""
        from ..new_picture import keep

        return keep(work, stored, in_place=self.use_in_place)

    def draw_in(self, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether there is an image."""
        return cls.may_be_redone(context) or super().poll(context)

    def read_work(self, context: bpy.types.Context) -> "NewPicture":
        """Copies the image."""
        from ..new_picture import read

        image = self.chosen_image(context)
        # For a redo: the editor will show the copy, which the redo's undo removes.
        self.image = image.name
        return self.work_on(read(image))

    def load(self) -> tuple[int, int]:
        """Returns the size of the image."""
        assert self.work is not None
        return self.work.old_size

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)
        layout.prop(self, "use_in_place")
