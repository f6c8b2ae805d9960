# SPDX-License-Identifier: GPL-3.0-or-later

"""Image editors: showing images, and redrawing."""

import bpy


def show(context: bpy.types.Context, image: bpy.types.Image) -> None:
    """Shows an image in the Image editor of the context, if there is one."""
    if context.area is not None and context.area.type == "IMAGE_EDITOR":
        context.space_data.image = image


def show_anywhere(context: bpy.types.Context, image: bpy.types.Image) -> bool:
    """Shows an image in the Image editor of the context, or else in the window's largest unpinned
    one.

    Returns:
        Whether another editor than that of the context shows it now.
    """
    if context.area is not None and context.area.type == "IMAGE_EDITOR":
        context.space_data.image = image
        return False
    window = None if bpy.app.background else context.window
    areas = window.screen.areas if window is not None else ()
    free = [
        area
        for area in areas
        if area.type == "IMAGE_EDITOR" and not area.spaces.active.use_image_pin
    ]
    if not free:
        return False
    max(free, key=lambda area: area.width * area.height).spaces.active.image = image
    return True


def redraw() -> None:
    """Redraws all Image editors and 3D views."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"IMAGE_EDITOR", "VIEW_3D"}:
                area.tag_redraw()


def redraw_on_change(group: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update callback of properties that redraws editors."""
    del group, context
    redraw()
