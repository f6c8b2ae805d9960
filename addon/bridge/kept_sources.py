# SPDX-License-Identifier: GPL-3.0-or-later

"""What objects were made of: kept with them, and shown in their place.

An object that got a mesh of its own in place keeps a copy of what it was, which is in no
collection until it is shown. Others keep the objects that they were made of. The group of
properties is that of the subject `comparison`.
"""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

import bpy

_ENDING = ".source"


def copied(obj: bpy.types.Object) -> bpy.types.Object:
    """Returns a copy of an object as it is, with the same data, that is in no collection."""
    made = obj.copy()
    made.name = f"{obj.name}{_ENDING}"
    made.prefilter_made_of.is_copy = True
    return made


def keep(result: bpy.types.Object, sources: Sequence[bpy.types.Object]) -> None:
    """Keeps what an object was made of; what was kept before is then kept by its copy."""
    kept = result.prefilter_made_of
    kept.sources.clear()
    for obj in sources:
        kept.sources.add().obj = obj
        obj.prefilter_made_of.is_source = True
    kept.is_source_shown = False


def keep_more(result: bpy.types.Object, sources: Sequence[bpy.types.Object]) -> None:
    """Keeps more of what an object was made of, where something is kept."""
    kept = result.prefilter_made_of
    for obj in sources if len(kept.sources) else ():
        kept.sources.add().obj = obj
        obj.prefilter_made_of.is_source = True


def sources_of(result: bpy.types.Object) -> list[bpy.types.Object]:
    """Returns what an object was made of and that is still there."""
    kept = result.prefilter_made_of
    found = [entry.obj for entry in kept.sources if entry.obj is not None]
    # Objects that were deleted stay in the file for as long as something knows them.
    return [obj for obj in found if obj.users_collection or _is_hidden_copy(obj, kept)]


def original_of(result: bpy.types.Object) -> bpy.types.Object | None:
    """Returns what an object was, which is the first of what it was made of; None if it is gone."""
    sources = result.prefilter_made_of.sources
    first = sources[0].obj if len(sources) else None
    return first if first is not None and first in sources_of(result) else None


def put_in_place(results: Sequence[bpy.types.Object]) -> None:
    """Puts what objects were where they are, unless it is seen; each was made of the next."""
    bpy.context.view_layer.update()
    # What is in no collection has no place in the world that Blender knows.
    world = results[0].matrix_world.copy()
    for result in results:
        original = original_of(result)
        if original is None:
            return
        if result.prefilter_made_of.is_source_shown:
            world = original.matrix_world.copy()
        elif _is_copy(original, result):
            _place(original, result)
        elif not original.visible_get():
            original.matrix_world = world


@contextmanager
def evaluated(
    sources: Sequence[bpy.types.Object], context: bpy.types.Context
) -> Iterator[bpy.types.Depsgraph]:
    """Has Blender evaluate objects, hidden or not, and in no collection too."""
    root = context.scene.collection
    linked = [obj for obj in sources if not obj.visible_get() and obj.name not in root.objects]
    for obj in linked:
        root.objects.link(obj)
    hidden = [(obj, obj.hide_get(), obj.hide_viewport) for obj in sources]
    for obj in sources:
        obj.hide_set(False)
        obj.hide_viewport = False
    context.view_layer.update()
    try:
        yield context.evaluated_depsgraph_get()
    finally:
        for obj, is_hidden, is_off in hidden:
            obj.hide_set(is_hidden)
            obj.hide_viewport = is_off
        for obj in linked:
            root.objects.unlink(obj)


def copies_of(results: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Returns the copies of what objects were, and of what these were."""
    found: list[bpy.types.Object] = []
    todo = list(results)
    while todo:
        one = todo.pop()
        copies = [obj for obj in sources_of(one) if _is_copy(obj, one) and obj not in found]
        found += copies
        todo += copies
    return found


def result_of(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Returns what was made of an object, or the object itself if that keeps its sources."""
    if obj is None:
        return None
    if obj.prefilter_made_of.is_source:
        for other in bpy.data.objects:
            kept = other.prefilter_made_of
            if kept.is_source_shown and any(entry.obj == obj for entry in kept.sources):
                return other
    return obj if len(obj.prefilter_made_of.sources) and sources_of(obj) else None


def show(
    result: bpy.types.Object, context: bpy.types.Context, *, source: bool
) -> list[bpy.types.Object]:
    """Shows what an object was made of in its place, or the object again; returns what is shown."""
    sources = sources_of(result)
    shown, hidden = (sources, [result]) if source else ([result], sources)
    copy = next((obj for obj in sources if _is_copy(obj, result)), None)
    original = original_of(result)
    if copy is not None:
        _place(*((copy, result) if source else (result, copy)))
    elif original is not None:
        context.view_layer.update()
        moved, there = (original, result) if source else (result, original)
        moved.matrix_world = there.matrix_world
    if source and copy is not None:
        for collection in result.users_collection:
            collection.objects.link(copy)
    is_active = context.view_layer.objects.active in {*hidden, None}
    for obj in hidden:
        if obj == copy:
            for collection in obj.users_collection:
                collection.objects.unlink(obj)
        else:
            _hide(obj, context, hides=True)
    for obj in shown:
        _hide(obj, context, hides=False)
    if is_active and shown[0].visible_get():
        context.view_layer.objects.active = shown[0]
    result.prefilter_made_of.is_source_shown = source
    return shown


def _hide(obj: bpy.types.Object, context: bpy.types.Context, *, hides: bool) -> None:
    obj.hide_render = hides
    if obj.name in context.view_layer.objects:
        # What is hidden cannot be selected.
        obj.hide_set(hides)
        obj.select_set(not hides)


def forget(result: bpy.types.Object, context: bpy.types.Context) -> None:
    """Removes the copies of what an object was; other sources stay as they are."""
    kept = result.prefilter_made_of
    if kept.is_source_shown:
        show(result, context, source=False)
    copies = copies_of([result])
    kept.sources.clear()
    for obj in copies:
        data = obj.data
        bpy.data.objects.remove(obj)
        if data.users == 0:
            bpy.data.meshes.remove(data)


def _is_copy(obj: bpy.types.Object, result: bpy.types.Object) -> bool:
    """Tells whether a source is the copy of what an object was, which is its first one."""
    return bool(obj.prefilter_made_of.is_copy) and obj == result.prefilter_made_of.sources[0].obj


def _is_hidden_copy(obj: bpy.types.Object, kept: bpy.types.PropertyGroup) -> bool:
    return bool(obj.prefilter_made_of.is_copy) and not kept.is_source_shown


def _place(obj: bpy.types.Object, like: bpy.types.Object) -> None:
    """Puts an object where another one is."""
    obj.parent, obj.parent_type, obj.parent_bone = like.parent, like.parent_type, like.parent_bone
    obj.matrix_parent_inverse = like.matrix_parent_inverse
    obj.rotation_mode = like.rotation_mode
    obj.matrix_basis = like.matrix_basis
