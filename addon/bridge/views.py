# SPDX-License-Identifier: GPL-3.0-or-later

"""Views: previews that editors draw instead of images, and the settings that show them."""

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import bpy

from ..core.translations import tr
from . import editors
from .previews import Preview, Previews

T = TypeVar("T", bound=Preview)


@dataclass(frozen=True)
class View(Generic[T]):
    """One kind of preview, and its settings for all editors.

    Attributes:
        previews: The previews of images.
        group: Property of the window manager with the settings, which undo does not change.
        switch: Property of the settings: whether editors draw the previews.
    """

    previews: Previews[T]
    group: str
    switch: str

    def state(self, context: bpy.types.Context) -> Any:
        """Returns the settings."""
        return getattr(context.window_manager, self.group)

    def here(self, context: bpy.types.Context) -> T | None:
        """Returns the preview of the editor's image."""
        return self.previews.find(getattr(context.space_data, "image", None))

    def draw_switch(self, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draws the switch if the editor's image has a preview."""
        if self.here(context) is not None:
            layout.prop(self.state(context), self.switch, text="")

    def show(self, context: bpy.types.Context, image_name: str) -> None:
        """Makes the editors draw the preview of an image."""
        from . import images

        editors.show(context, images.find(image_name))
        setattr(self.state(context), self.switch, True)
        editors.redraw()


class EndsView:
    """A mixin for operators: removes a view's preview of the editor's image."""

    view: View[Any]
    nothing: str
    """Message if there is no preview."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the editor's image has a preview."""
        if cls.view.here(context) is None:
            cls.poll_message_set(tr(cls.nothing))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Removes the preview."""
        self.view.previews.drop(context.space_data.image)
        editors.redraw()
        return {"FINISHED"}
