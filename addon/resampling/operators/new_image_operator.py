# SPDX-License-Identifier: GPL-3.0-or-later

"""What the operators share that make an image of another size, or in another place."""

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
    """A mixin: a new image, beside the old one or in its place.

    A subclass has `doing` and `work_on`.
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
        """Returns what is to do to an image."""
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
        """Tells whether there is an image."""
        return cls.may_be_redone(context) or super().poll(context)

    def read_work(self, context: bpy.types.Context) -> "NewPicture":
        """Copies the image."""
        from ..new_picture import read

        image = self.chosen_image(context)
        # The editor will show the copy, and nothing once that is undone to be done again.
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
