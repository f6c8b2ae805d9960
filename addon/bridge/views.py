# SPDX-License-Identifier: GPL-3.0-or-later

"""Views: what editors draw in the place of images, whether they do, and how that ends."""

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import bpy

from ..core.translations import tr
from . import editors
from .previews import Preview, Previews

T = TypeVar("T", bound=Preview)


@dataclass(frozen=True)
class View(Generic[T]):
    """One kind of previews, and the settings of all editors for it.

    Attributes:
        previews: What is kept of images.
        group: The settings, a property of the window manager: no undo changes them.
        switch: The property of these that says whether editors draw it.
    """

    previews: Previews[T]
    group: str
    switch: str

    def state(self, context: bpy.types.Context) -> Any:
        """Returns the settings."""
        return getattr(context.window_manager, self.group)

    def here(self, context: bpy.types.Context) -> T | None:
        """Returns what is kept of the editor's image."""
        return self.previews.find(getattr(context.space_data, "image", None))

    def draw_switch(self, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draws the switch, where something is kept of the editor's image."""
        if self.here(context) is not None:
            layout.prop(self.state(context), self.switch, text="")

    def show(self, context: bpy.types.Context, image_name: str) -> None:
        """Has the editors draw what is kept of an image."""
        from . import images

        editors.show(context, images.find(image_name))
        setattr(self.state(context), self.switch, True)
        editors.redraw()


class EndsView:
    """A mixin for operators: forgets what a view keeps of the editor's image."""

    view: View[Any]
    nothing: str
    """What is said where there is nothing to forget."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether something is kept of the editor's image."""
        if cls.view.here(context) is None:
            cls.poll_message_set(tr(cls.nothing))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forgets it."""
        self.view.previews.drop(context.space_data.image)
        editors.redraw()
        return {"FINISHED"}
