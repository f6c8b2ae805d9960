# SPDX-License-Identifier: GPL-3.0-or-later

"""Mixins for operators that work on an image, or make one."""

from collections.abc import Sequence

import bpy
from bpy.props import StringProperty

from ..core.operator import WorkOperator
from ..core.translations import CONTEXT, tr
from ..core.wording import Sentence
from . import editors


class ImageOperator:
    """A mixin: works on a named image, or else on the editor's image."""

    image: StringProperty(
        name="Image",
        translation_context=CONTEXT,
        description="The image to work on; the image of the editor if empty",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def shown_image(cls, context: bpy.types.Context) -> bpy.types.Image | None:
        """Returns the image of the editor."""
        return getattr(context.space_data, "image", None)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is an image."""
        if context.area is not None and context.area.type == "IMAGE_EDITOR":
            if cls.shown_image(context) is None:
                cls.poll_message_set(tr("Open an image in this editor first"))
                return False
        elif not bpy.data.images:
            cls.poll_message_set(tr("There is no image in this file"))
            return False
        return True

    def chosen_image(self, context: bpy.types.Context) -> bpy.types.Image:
        """Returns the named image, or else the editor's.

        Raises:
            ValueError: There is none.
        """
        from . import images

        image = images.find(self.image) if self.image else self.shown_image(context)
        if image is None:
            raise ValueError(Sentence("image: no name is given, and the editor shows no image"))
        return image

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Image]:
        """Returns the image."""
        return [self.chosen_image(context)]

    def retarget(self, targets: Sequence[bpy.types.ID]) -> None:
        """Keeps the name of the image."""
        self.image = targets[0].name


class MakesImage(WorkOperator):
    """A mixin: work that makes an image, and shows it in an Image editor."""

    queue_name = "images"

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the image, shows it, and returns what to report."""
        del result
        assert self.work is not None
        outcome = self.work.write()
        image = bpy.data.images[outcome.images[0]]
        is_elsewhere = editors.show_anywhere(context, image)
        summary = self.report_outcome(outcome)
        return Sentence("{}, shown in the Image editor", summary) if is_elsewhere else summary
