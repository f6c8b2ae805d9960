"""The objects that a bake looks at: for the bake, and cheaply for panels."""

import time
from collections.abc import Sequence

import bpy
from bpy.app.handlers import persistent

from ..bridge import users
from ..core.wording import counted, listed
from .choices import TEXTURE_SPACE_FILTERS

_SHARE_OF_TIME = 0.05  # What drawing may spend on looking for users while a scene changes.

_Found = dict[int, list[str]]
_found: dict[tuple[str, str], _Found] = {}
_is_stale = True
_look_again_at = 0.0


def objects_to_read(
    context: bpy.types.Context, image: bpy.types.Image, choice: str
) -> tuple[list[bpy.types.Object], list[str]]:
    """Returns the objects that a bake of an image looks at, and warnings of those left out.

    Args:
        context: The context.
        image: The image.
        choice: A key of `choices.OBJECTS`.
    """
    if choice == "selected":
        objects = context.view_layer.objects
        return [obj for obj in objects if obj.select_get() or obj.mode == "EDIT"], []
    return users_of(image, context)


def users_of(
    image: bpy.types.Image, context: bpy.types.Context
) -> tuple[list[bpy.types.Object], list[str]]:
    """Returns the visible objects that use an image, and a warning if there are hidden ones."""
    shown = users.shown_images(context.evaluated_depsgraph_get()).get(image, [])
    hidden = users.hidden_users(image, context.view_layer, shown)
    names = listed(obj.name for obj in hidden)
    return shown, [f"image '{image.name}': left out, as they are hidden: {names}"] if hidden else []


def why_none(context: bpy.types.Context, image: bpy.types.Image, choice: str) -> str:
    """Returns why no object can be read for an image; empty where one can, or may."""
    if _names(context, image, choice) != []:
        return ""
    kind = "selected" if choice == "selected" else "visible"
    return f"No {kind} object uses '{image.name}'"


def what_is_read(
    context: bpy.types.Context, image: bpy.types.Image, choice: str, filters: Sequence[str]
) -> str:
    """Returns what a bake would read, such as "3 objects, 2048 x 2048".

    Args:
        context: The context.
        image: The image.
        choice: A key of `choices.OBJECTS`.
        filters: Keys of `choices.FILTERS`.
    """
    if image.source == "TILED":
        parts = [counted(image.tiles, "tile")]
    else:
        parts = ["{} x {}".format(*image.size)]
    names = _names(context, image, choice)
    if names is not None and not TEXTURE_SPACE_FILTERS.issuperset(filters):
        parts.insert(0, counted(names, "object"))
    return ", ".join(parts)


def _names(context: bpy.types.Context, image: bpy.types.Image, choice: str) -> list[str] | None:
    """Returns the names of the objects to read; None before a view layer is evaluated."""
    found = _looked_up(context)
    if found is None:
        return None
    names = found.get(image.session_uid, [])
    if choice != "selected":
        return names
    objects = map(context.view_layer.objects.get, names)
    return [
        obj.name for obj in objects if obj is not None and (obj.select_get() or obj.mode == "EDIT")
    ]


def _looked_up(context: bpy.types.Context) -> _Found | None:
    """Returns the users of all images, by session_uid, as of the last change or shortly before."""
    global _is_stale, _look_again_at
    layer = context.view_layer
    key = (context.scene.name_full, layer.name)
    now = time.monotonic()
    if key in _found and (not _is_stale or now < _look_again_at):
        return _found[key]
    if layer.depsgraph is None:
        return None
    if _is_stale:
        _found.clear()
    shown = users.shown_images(layer.depsgraph)
    _found[key] = {
        image.session_uid: [obj.name for obj in objects] for image, objects in shown.items()
    }
    _is_stale = False
    end = time.monotonic()
    _look_again_at = end + (end - now) / _SHARE_OF_TIME
    return _found[key]


@persistent
def _mark_stale(*_: object) -> None:
    global _is_stale
    _is_stale = True


@persistent
def _forget(*_: object) -> None:
    _found.clear()


_HANDLERS = (
    ("depsgraph_update_post", _mark_stale),
    ("undo_post", _forget),
    ("redo_post", _forget),
    ("load_pre", _forget),
    ("load_post", _forget),
)


def register() -> None:
    """Adds the handlers."""
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Removes the handlers."""
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    _forget()
