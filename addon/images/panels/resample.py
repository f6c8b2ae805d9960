# SPDX-License-Identifier: GPL-3.0-or-later

"""Resampling: a panel in the Image editor's sidebar, and an entry in Image > Prefilter."""

from collections.abc import Iterator

import bpy

from ...core.buttons import Button, SettingsPanel
from ...core.menus import PREFILTER_MT_image
from ...core.registration import classes, entry, registration
from ...core.sidebar import ImagePanel, note
from ...core.translations import tr
from ..choices import ResampleSettings
from ..operators.drag_corners import PREFILTER_OT_drag_corners
from ..operators.resample_image import PREFILTER_OT_resample_image
from ..properties import RESAMPLE
from ..view import pins

_BUTTON = Button(PREFILTER_OT_resample_image, "MOD_LATTICE", RESAMPLE.group, {ResampleSettings: ()})


class PREFILTER_PT_resample(ImagePanel, SettingsPanel, bpy.types.Panel):
    """The button and the settings."""

    bl_label = "Resample"
    presets = RESAMPLE
    button = _BUTTON
    makes = "Make Image"

    def draw_notes(self, context: bpy.types.Context) -> None:
        """Draws the size of the result, and Drag Corners."""
        settings = context.scene.prefilter_resample
        image = context.space_data.image
        if image is not None and all(image.size):
            source = settings.source_of(image)
            if source != image:
                text = tr("Made anew from '{}'").format(source.name)
                note(self.layout, context, text, "FILE_REFRESH")
            image = source
            for text, icon in _result_notes(settings.to_settings(), *image.size):
                note(self.layout, context, text, icon)
        self.layout.operator(
            PREFILTER_OT_drag_corners.bl_idname, icon="HANDLE_VECTOR", depress=pins.is_on(image)
        )


def _draw_image_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    _BUTTON.draw(menu.layout, context)
    menu.layout.operator(PREFILTER_OT_drag_corners.bl_idname, icon="HANDLE_VECTOR")


def _result_notes(settings: ResampleSettings, width: int, height: int) -> Iterator[tuple[str, str]]:
    """Yields the size of the result, warnings and errors, each with an icon."""
    from prefilter.workflows.images.placement import knows_proportions, placement

    try:
        placed = placement(settings, width, height)
    except ValueError as error:
        yield str(error), "ERROR"
        return
    text = tr("{} x {} to {} x {}").format(width, height, placed.width, placed.height)
    yield text, "INFO"
    if not knows_proportions(settings, width, height):
        text = tr("Proportions are a guess: these corners fit every lens. Give the ratio")
        yield text, "QUESTION"


register, unregister = registration(
    classes(PREFILTER_PT_resample), entry(PREFILTER_MT_image, _draw_image_menu)
)
