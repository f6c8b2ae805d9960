# SPDX-License-Identifier: GPL-3.0-or-later

"""The add-on's tab in the sidebars of the 3D view and the Image editor, and what panels share."""

import math
import textwrap
from collections.abc import Callable, Iterator
from typing import Any

import bpy

from . import running
from .translations import CONTEXT, tr

_LETTER_WIDTH = 6.5
_AROUND_TEXT = 76
"""What margins, tabs and an icon take of a sidebar's width; both at a scale of 1."""
_FEWEST_LETTERS = 12
_FIRST_WIDE = "\u2e80"
"""From here on letters are about twice as wide: those of Chinese and Japanese."""


class Tab:
    """A mixin for panels: in the tab of the 3D view."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Prefilter"


class SidebarPanel(Tab):
    """A mixin for panels of the tab in the 3D view."""

    bl_context = "objectmode"
    bl_label = ""
    mode = "OBJECT"
    """That in which it shows, which `bl_context` says too."""
    wanted = ""
    """The objects that the panel is for, such as "a curve or a text"."""

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Tells whether the panel is for an object, the active one."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an active object that the panel is for."""
        active = context.active_object
        return context.mode == cls.mode and active is not None and cls.fits(active)


class PREFILTER_PT_nothing(Tab, bpy.types.Panel):
    """Stands in for the panels where none is for what is active, and says what they are for."""

    bl_label = "Prefilter"
    bl_translation_context = CONTEXT

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is no other panel."""
        return not any(panel.poll(context) for panel in _panels())

    def draw(self, context: bpy.types.Context) -> None:
        """Draws what to select for each panel."""
        if context.mode != "OBJECT":
            note(self.layout, context, "Prefilter works in Object Mode", "INFO")
            back = self.layout.operator(
                "object.mode_set", text="Object Mode", icon="OBJECT_DATAMODE"
            )
            back.mode = "OBJECT"
            return
        note(self.layout, context, "Make one of these the active object", "INFO")
        for panel in (one for one in _panels() if one.mode == "OBJECT"):
            text = f"{tr(panel.bl_label)}: {tr(panel.wanted)}"
            note(self.layout, context, text, "DOT")


def _panels(base: type[Any] = SidebarPanel) -> Iterator[type[SidebarPanel]]:
    """Yields the panels of the tab that are registered; few classes, as every redraw asks."""
    for one in base.__subclasses__():
        if getattr(one, "is_registered", False):
            yield one
        yield from _panels(one)


class ImagePanel:
    """A mixin for panels of the tab in the Image editor."""

    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Prefilter"


def main_button(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    operator: type[bpy.types.Operator],
    more: Callable[[bpy.types.UILayout], object] | None = None,
) -> bpy.types.UILayout | None:
    """Returns where the main button of a panel goes.

    Args:
        layout: The panel.
        context: The context.
        operator: What the button starts.
        more: Draws a button that adds to the queue, beside the progress.

    Returns:
        None while the operator runs, whose progress is then drawn there.
    """
    column = layout.column(align=True)
    row = column.row()
    row.scale_y = 1.5
    if running.draw(row, context, operator.bl_idname, more):
        return None
    running.draw_successor(column, operator.bl_idname)
    return row


def button(
    layout: bpy.types.UILayout, context: bpy.types.Context, operator: type[bpy.types.Operator]
) -> bpy.types.UILayout | None:
    """Returns where another button goes, as `main_button` does."""
    if running.draw(layout, context, operator.bl_idname):
        return None
    column = layout.column(align=True)
    running.draw_successor(column, operator.bl_idname)
    return column.column()


def note(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """Draws a text of any length, in as many lines as the region needs."""
    scale = context.preferences.system.ui_scale  # 0 without a window.
    room = context.region.width / scale - _AROUND_TEXT if scale else math.inf
    letters = max(_FEWEST_LETTERS, room / _LETTER_WIDTH)
    column = layout.column(align=True)
    for i, line in enumerate(wrapped(tr(text), letters)):
        column.label(text=line, icon="BLANK1" if i else icon)


def wrapped(text: str, letters: float) -> list[str]:
    """Returns the lines of a text.

    Args:
        text: The text.
        letters: How many Latin letters fit in a line.
    """
    wide = sum(one >= _FIRST_WIDE for one in text)
    fitting = letters * len(text) / (len(text) + wide) if text else letters
    return textwrap.wrap(text, int(min(len(text), fitting)) or 1)


def subpanel(
    layout: bpy.types.UILayout, name: str, title: str
) -> tuple[bpy.types.UILayout, bpy.types.UILayout | None]:
    """Draws a panel in a panel, which is closed at first.

    Args:
        layout: The panel, across its whole width.
        name: Tells it from others in the same region.
        title: What its header says.

    Returns:
        The header, for more to draw in it, and the body; None while that is closed.
    """
    header, body = layout.panel(f"PREFILTER_{name}", default_closed=True)
    header.label(text=title, text_ctxt=CONTEXT)
    return header, body


class PartedSettings:
    """A mixin for settings: the usual ones, and parts that are closed at first."""

    def draw_in(self, layout: bpy.types.UILayout, *source: str) -> None:
        """Draws the settings, the usual ones at once.

        Args:
            layout: The layout of a panel.
            source: What the settings are for, where they depend on that.
        """
        layout.use_property_split = True
        layout.use_property_decorate = False
        self.draw_usual(layout, *source)
        self.draw_parts(layout, *source)

    def draw_closed(self, layout: bpy.types.UILayout, *source: str) -> None:
        """Draws the same below a main button: the usual ones are a part as well."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        name = type(self).__name__.removeprefix("PREFILTER_PG_")
        _, body = subpanel(layout, f"{name}_usual", "Settings")
        if body:
            self.draw_usual(body, *source)
        self.draw_parts(layout, *source)

    def draw_usual(self, *arguments: Any, **named: Any) -> None:
        """Draws the usual ones, into the layout that it gets."""
        raise NotImplementedError

    def draw_parts(self, *arguments: Any, **named: Any) -> None:
        """Draws the parts likewise; nothing where there are none."""


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_nothing,))
