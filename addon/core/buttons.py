# SPDX-License-Identifier: GPL-3.0-or-later

"""Buttons that call operators with the settings of the scene, and panels with such a button."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import bpy

from .presets import PresetsOperator, PresetsPanel
from .properties import copy
from .sidebar import main_button


@dataclass(frozen=True)
class Button:
    """A button or menu entry that calls an operator with the settings of the scene.

    Attributes:
        operator: The operator.
        icon: Its icon.
        group: The scene property with the settings.
        settings: The dataclasses of settings to pass to the operator, each with fields to exclude.
    """

    operator: type[bpy.types.Operator]
    icon: str
    group: str
    settings: Mapping[type, Collection[str]]

    def draw(
        self,
        layout: bpy.types.UILayout,
        context: bpy.types.Context,
        text: str | None = None,
        icon: str = "",
        *,
        is_changed: bool = False,
    ) -> bpy.types.OperatorProperties:
        """Draws the button.

        An operator that reads the settings from the scene itself gets none: Blender then finds its
        shortcut, and shows it in menus and tooltips.

        Args:
            layout: The layout to draw into.
            context: The context with the scene.
            text: The text; None for the operator's label.
            icon: The icon; empty for the usual one.
            is_changed: Whether the caller will change some settings, so that all must be passed.
        """
        name = self.operator.bl_idname
        properties = layout.operator(name, text=text, icon=icon or self.icon)
        if is_changed or not issubclass(self.operator, PresetsOperator):
            for settings, without in self.settings.items():
                copy(getattr(context.scene, self.group), properties, settings, without)
        return properties

    def draw_main(
        self, layout: bpy.types.UILayout, context: bpy.types.Context, text: str | None = None
    ) -> None:
        """Draws the main button of a panel, or the progress of the operator."""

        def draw_more(row: bpy.types.UILayout) -> None:
            self.draw(row, context, "", "ADD")

        more = draw_more if self.operator.queue_name else None
        row = main_button(layout, context, self.operator, more)
        if row:
            self.draw(row, context, text)


class SettingsPanel(PresetsPanel):
    """A mixin for panels: a main button, a summary of the result, and the settings, collapsed."""

    button: Button
    makes: str
    """The text of the button, which names the result."""
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        self.button.draw_main(self.layout, context, self.makes)
        self.draw_notes(context)
        getattr(context.scene, self.button.group).draw_collapsed(self.layout)

    def draw_notes(self, context: bpy.types.Context) -> None:
        """Draws a summary of the result, if there is one."""
