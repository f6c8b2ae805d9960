# SPDX-License-Identifier: GPL-3.0-or-later

"""The menus Object > Prefilter and Image > Prefilter, to which subjects add their operators.

A search (F3) lists an operator once for each of its entries in the menus of the editor's header.
"""

import bpy

from .translations import CONTEXT


class PREFILTER_MT_object(bpy.types.Menu):
    """Operators on objects."""

    bl_label = "Prefilter"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draws nothing; subjects append to it."""


class PREFILTER_MT_image(bpy.types.Menu):
    """Operators on images."""

    bl_label = "Prefilter"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draws nothing; subjects append to it."""


def _draw_object_first(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.menu(PREFILTER_MT_object.__name__)
    menu.layout.separator()


def _draw_object(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.separator()
    menu.layout.menu(PREFILTER_MT_object.__name__)


def _draw_image(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    del context
    menu.layout.separator()
    menu.layout.menu(PREFILTER_MT_image.__name__)


# On small screens the end of the menu Object is out of sight.
_FIRST = {"VIEW3D_MT_object": _draw_object_first}
_LAST = {
    "VIEW3D_MT_object_context_menu": _draw_object,
    "IMAGE_MT_image": _draw_image,
}
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_MT_object, PREFILTER_MT_image)
)


def register() -> None:
    """Registers the menus, and adds them to Blender's."""
    _register_classes()
    for name, draw in _FIRST.items():
        getattr(bpy.types, name).prepend(draw)
    for name, draw in _LAST.items():
        getattr(bpy.types, name).append(draw)


def unregister() -> None:
    """Removes them."""
    for name, draw in (_FIRST | _LAST).items():
        getattr(bpy.types, name).remove(draw)
    _unregister_classes()
