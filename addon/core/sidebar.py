# SPDX-License-Identifier: GPL-3.0-or-later

"""The add-on's tab in the sidebars of the 3D view and the Image editor, with helpers for panels."""

import math
import textwrap
from collections.abc import Callable, Iterator
from typing import Any

import bpy

from . import runs
from .translations import CONTEXT, tr

_LETTER_WIDTH = 6.5
"""Mean width of a Latin letter, in pixels at a scale of 1."""
_AROUND_TEXT = 76
"""Width of margins, tabs and an icon in a sidebar, in pixels at a scale of 1."""
_FEWEST_LETTERS = 12
_FIRST_WIDE = "\u2e80"
"""First code point of the letters of double width: Chinese and Japanese."""


class Tab:
    """A mixin for panels in the tab of the 3D view."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Prefilter"


class SidebarPanel(Tab):
    """A mixin for panels in the tab of the 3D view that need a certain active object."""

    bl_context = "objectmode"
    bl_label = ""
    mode = "OBJECT"
    """The mode in which the panel shows; `bl_context` has to match."""
    required_object = ""
    """The kind of active object that the panel needs, such as "a curve or a text"."""

    @staticmethod
    def fits(obj: bpy.types.Object) -> bool:
        """Returns whether the panel can work on an active object."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the mode and the active object fit the panel."""
        active = context.active_object
        return context.mode == cls.mode and active is not None and cls.fits(active)


class PREFILTER_PT_nothing(Tab, bpy.types.Panel):
    """A placeholder if no panel fits the active object: lists the objects that the panels need."""

    bl_label = "Prefilter"
    bl_translation_context = CONTEXT

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether no other panel shows."""
        return not any(panel.poll(context) for panel in _panels())

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the kind of object that each panel needs."""
        if context.mode != "OBJECT":
            note(self.layout, context, "Prefilter works in Object Mode", "INFO")
            mode_set = self.layout.operator(
                "object.mode_set", text="Object Mode", icon="OBJECT_DATAMODE"
            )
            mode_set.mode = "OBJECT"
            return
        note(self.layout, context, "Make one of these the active object", "INFO")
        for panel in (panel for panel in _panels() if panel.mode == "OBJECT"):
            text = f"{tr(panel.bl_label)}: {tr(panel.required_object)}"
            note(self.layout, context, text, "DOT")


def _panels(base: type[Any] = SidebarPanel) -> Iterator[type[SidebarPanel]]:
    """Yields the registered panels of the tab."""
    for panel in base.__subclasses__():
        if getattr(panel, "is_registered", False):
            yield panel
        yield from _panels(panel)


class ImagePanel:
    """A mixin for panels in the tab of the Image editor."""

    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Prefilter"


def main_button(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    operator: type[bpy.types.Operator],
    more: Callable[[bpy.types.UILayout], object] | None = None,
) -> bpy.types.UILayout | None:
    """Returns the layout for the main button of a panel.

    Args:
        layout: The layout of the panel.
        context: The context.
        operator: The operator of the button.
        more: Draws a button that adds to the queue, beside the progress.

    Returns:
        None while the operator runs; then its progress is drawn instead.
    """
    column = layout.column(align=True)
    row = column.row()
    row.scale_y = 1.5
    if runs.draw(row, context, operator.bl_idname, more):
        return None
    runs.draw_successor(column, operator.bl_idname)
    return row


def button(
    layout: bpy.types.UILayout, context: bpy.types.Context, operator: type[bpy.types.Operator]
) -> bpy.types.UILayout | None:
    """Returns the layout for a secondary button; see `main_button`."""
    if runs.draw(layout, context, operator.bl_idname):
        return None
    column = layout.column(align=True)
    runs.draw_successor(column, operator.bl_idname)
    return column.column()


def note(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """Draws a text of any length, wrapped to the width of the region."""
    scale = context.preferences.system.ui_scale  # 0 without a window.
    width = context.region.width / scale - _AROUND_TEXT if scale else math.inf
    letters = max(_FEWEST_LETTERS, width / _LETTER_WIDTH)
    column = layout.column(align=True)
    for i, line in enumerate(wrapped(tr(text), letters)):
        column.label(text=line, icon="BLANK1" if i else icon)


def wrapped(text: str, letters: float) -> list[str]:
    """Returns the lines of a text.

    Args:
        text: The text.
        letters: How many Latin letters fit in a line.
    """
    wide = sum(letter >= _FIRST_WIDE for letter in text)
    fitting = letters * len(text) / (len(text) + wide) if text else letters
    return textwrap.wrap(text, int(min(len(text), fitting)) or 1)


def subpanel(
    layout: bpy.types.UILayout, name: str, title: str
) -> tuple[bpy.types.UILayout, bpy.types.UILayout | None]:
    """Draws a panel within a panel, closed by default.

    Args:
        layout: The layout of the panel, across its whole width.
        name: A name that is unique in the region.
        title: The text of its header.

    Returns:
        The layouts of the header and of the body; None for the body while it is closed.
    """
    header, body = layout.panel(f"PREFILTER_{name}", default_closed=True)
    header.label(text=title, text_ctxt=CONTEXT)
    return header, body


class GroupedSettings:
    """A mixin for settings: basic ones, and groups in subpanels that are closed by default."""

    def draw_in(self, layout: bpy.types.UILayout, *source: str) -> None:
        """Draws the basic settings, followed by the groups.

        Args:
            layout: The layout of a panel.
            source: The kind of source, if the settings depend on it.
        """
        layout.use_property_split = True
        layout.use_property_decorate = False
        self.draw_basic(layout, *source)
        self.draw_groups(layout, *source)

    def draw_collapsed(self, layout: bpy.types.UILayout, *source: str) -> None:
        """Draws the settings below a main button, with the basic ones in a subpanel too."""
        layout.use_property_split = True
        layout.use_property_decorate = False
        name = type(self).__name__.removeprefix("PREFILTER_PG_")
        _, body = subpanel(layout, f"{name}_usual", "Settings")
        if body:
            self.draw_basic(body, *source)
        self.draw_groups(layout, *source)

    def draw_basic(self, *arguments: Any, **named: Any) -> None:
        """Draws the basic settings."""
        raise NotImplementedError

    def draw_groups(self, *arguments: Any, **named: Any) -> None:
        """Draws the groups, if there are any."""


register, unregister = bpy.utils.register_classes_factory((PREFILTER_PT_nothing,))
