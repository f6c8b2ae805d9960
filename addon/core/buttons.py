# SPDX-License-Identifier: GPL-3.0-or-later

"""Buttons of operators with the settings of the scene, and the panels that consist of both."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import bpy

from .presets import PresetsOperator, PresetsPanel
from .properties import copy
from .sidebar import main_button


@dataclass(frozen=True)
class Button:
    """An operator that has the settings of the scene, in panels and menus.

    Attributes:
        operator: The operator.
        icon: Its icon.
        group: The settings of the scene, a property of it.
        settings: The dataclasses of what is handed to the operator, each with fields that are not.
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
        """Draws it, with another text or icon if one is given.

        An operator that looks up the settings by itself gets none: Blender then finds its key, and
        shows that in menus and tooltips.

        Args:
            layout: Where.
            context: Has the scene.
            text: What it says; its label if None.
            icon: Its icon; its usual one if empty.
            is_changed: Whether the caller changes some of the settings, so that all are needed.
        """
        made = layout.operator(self.operator.bl_idname, text=text, icon=icon or self.icon)
        if is_changed or not issubclass(self.operator, PresetsOperator):
            for settings, without in self.settings.items():
                copy(getattr(context.scene, self.group), made, settings, without)
        return made

    def draw_main(
        self, layout: bpy.types.UILayout, context: bpy.types.Context, text: str | None = None
    ) -> None:
        """Draws it as the main button of a panel, or how far the operator is."""

        def draw_more(row: bpy.types.UILayout) -> None:
            self.draw(row, context, "", "ADD")

        more = draw_more if self.operator.line else None
        place = main_button(layout, context, self.operator, more)
        if place:
            self.draw(place, context, text)


class SettingsPanel(PresetsPanel):
    """A mixin for panels: a main button, what its settings come to, and these, closed at first."""

    button: Button
    makes: str
    """What the button says: what it makes."""
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        self.button.draw_main(self.layout, context, self.makes)
        self.draw_notes(context)
        getattr(context.scene, self.button.group).draw_closed(self.layout)

    def draw_notes(self, context: bpy.types.Context) -> None:
        """Draws what the settings come to; nothing where that is not said."""
