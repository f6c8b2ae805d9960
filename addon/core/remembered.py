# SPDX-License-Identifier: GPL-3.0-or-later

"""What panels know of a scene without looking at all of it whenever they are drawn."""

import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import bpy
from bpy.app.handlers import persistent

T = TypeVar("T")

SHARE_OF_TIME = 0.05
"""What drawing may spend on looking while a scene changes all the time."""

_all: list["Remembered[Any]"] = []


class Remembered(Generic[T]):
    """What was found in a view layer; looked up again after a change, once a panel asks.

    No datablocks are to be kept in it, as an undo would end them.
    """

    def __init__(self, look: Callable[[bpy.types.Scene, bpy.types.Depsgraph], T]) -> None:
        """Takes what looks at a scene by its evaluated dependency graph."""
        self._look = look
        self._found: dict[tuple[str, str], T] = {}
        self._is_stale = True
        self._look_again_at = 0.0
        _all.append(self)

    def get(self, context: bpy.types.Context) -> T | None:
        """Returns what was found last or is found now; None before the graph is evaluated."""
        layer = context.view_layer
        key = (context.scene.name_full, layer.name)
        now = time.monotonic()
        if key in self._found and (not self._is_stale or now < self._look_again_at):
            return self._found[key]
        if layer.depsgraph is None:
            return None
        if self._is_stale:
            self._found.clear()
        self._found[key] = self._look(context.scene, layer.depsgraph)
        self._is_stale = False
        end = time.monotonic()
        self._look_again_at = end + (end - now) / SHARE_OF_TIME
        return self._found[key]

    def mark_stale(self) -> None:
        """Lets it look again soon."""
        self._is_stale = True

    def forget(self) -> None:
        """Lets it look again before it says anything."""
        self._found.clear()


@persistent
def _mark_stale(*_: object) -> None:
    for one in _all:
        one.mark_stale()


@persistent
def forget_all(*_: object) -> None:
    """Lets everything be looked up again before panels say anything, as after files changed."""
    for one in _all:
        one.forget()


_HANDLERS = (
    ("depsgraph_update_post", _mark_stale),
    ("undo_post", forget_all),
    ("redo_post", forget_all),
    ("load_pre", forget_all),
    ("load_post", forget_all),
)


def register() -> None:
    """Adds the handlers."""
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Removes the handlers."""
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    forget_all()
