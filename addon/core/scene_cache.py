# SPDX-License-Identifier: GPL-3.0-or-later

"""Caches for panels, which would otherwise search the whole scene on every redraw."""

import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import bpy
from bpy.app.handlers import persistent

T = TypeVar("T")

SHARE_OF_TIME = 0.05
"""Largest fraction of the time to spend on updates while the scene keeps changing."""

_caches: list["SceneCache[Any]"] = []


class SceneCache(Generic[T]):
    """A value per view layer, computed again when a panel asks for it after a change.

    The value must not hold data-blocks, which an undo would free.
    """

    def __init__(self, compute: Callable[[bpy.types.Scene, bpy.types.Depsgraph], T]) -> None:
        """Stores the function of a scene and its evaluated dependency graph."""
        self._compute = compute
        self._values: dict[tuple[str, str], T] = {}
        self._is_stale = True
        self._next_update = 0.0
        _caches.append(self)

    def get(self, context: bpy.types.Context) -> T | None:
        """Returns the value, updated if needed; None before the graph is evaluated."""
        layer = context.view_layer
        key = (context.scene.name_full, layer.name)
        now = time.monotonic()
        if key in self._values and (not self._is_stale or now < self._next_update):
            return self._values[key]
        if layer.depsgraph is None:
            return None
        if self._is_stale:
            self._values.clear()
        self._values[key] = self._compute(context.scene, layer.depsgraph)
        self._is_stale = False
        end = time.monotonic()
        self._next_update = end + (end - now) / SHARE_OF_TIME
        return self._values[key]

    def mark_stale(self) -> None:
        """Marks the values for an update; `get` may return old ones for a while."""
        self._is_stale = True

    def clear(self) -> None:
        """Deletes the values."""
        self._values.clear()


@persistent
def _mark_stale(*_: object) -> None:
    for cache in _caches:
        cache.mark_stale()


@persistent
def clear_all(*_: object) -> None:
    """Clears all caches, as after an undo or when files have changed."""
    for cache in _caches:
        cache.clear()


_HANDLERS = (
    ("depsgraph_update_post", _mark_stale),
    ("undo_post", clear_all),
    ("redo_post", clear_all),
    ("load_pre", clear_all),
    ("load_post", clear_all),
)


def register() -> None:
    """Adds the handlers."""
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Removes the handlers."""
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    clear_all()
