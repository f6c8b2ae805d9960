# SPDX-License-Identifier: GPL-3.0-or-later

"""Registration of modules and classes in order."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import bpy
from bpy.props import PointerProperty


class Part(Protocol):
    """A module, a package or a `Step` that is registered with the add-on."""

    @property
    def register(self) -> Callable[[], None]:
        """Registers it with Blender."""

    @property
    def unregister(self) -> Callable[[], None]:
        """Undoes `register`."""


@dataclass(frozen=True)
class Step:
    """A part given by two functions."""

    register: Callable[[], None]
    unregister: Callable[[], None]


def registration(*parts: Part) -> tuple[Callable[[], None], Callable[[], None]]:
    """Returns functions that register parts in order, and unregister them in reverse."""

    def register() -> None:
        for part in parts:
            part.register()

    def unregister() -> None:
        for part in reversed(parts):
            part.unregister()

    return register, unregister


def classes(*types: type) -> Step:
    """Returns the part that registers classes of Blender's types."""
    return Step(*bpy.utils.register_classes_factory(types))


def entry(menu: Any, draw: Callable[[Any, bpy.types.Context], None]) -> Step:
    """Returns the part that appends a draw function to a menu, a panel or a header."""
    return Step(lambda: menu.append(draw), lambda: menu.remove(draw))


def state(owner: type, name: str, group: type[bpy.types.PropertyGroup]) -> Step:
    """Returns the part that registers a property group and adds it to a type of data-block."""

    def register() -> None:
        bpy.utils.register_class(group)
        setattr(owner, name, PointerProperty(type=group))

    def unregister() -> None:
        delattr(owner, name)
        bpy.utils.unregister_class(group)

    return Step(register, unregister)
