# SPDX-License-Identifier: GPL-3.0-or-later

"""Sources of results: stored with the results, and shown in their stead.

An object whose mesh was replaced keeps a copy of the original object, which is in no collection
until it is shown. New objects keep references to their sources. The property group belongs to the
subject `comparison`.
"""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

import bpy

_ENDING = ".source"


def copy_source(obj: bpy.types.Object) -> bpy.types.Object:
    """Copies an object, with the same data, into no collection."""
    copy = obj.copy()
    copy.name = f"{obj.name}{_ENDING}"
    copy.prefilter_made_of.is_copy = True
    return copy


def keep(result: bpy.types.Object, sources: Sequence[bpy.types.Object]) -> None:
    """Sets the sources of a result; its copied source keeps the earlier ones."""
    kept = result.prefilter_made_of
    kept.sources.clear()
    for obj in sources:
        kept.sources.add().obj = obj
        obj.prefilter_made_of.is_source = True
    kept.is_source_shown = False


def keep_more(result: bpy.types.Object, sources: Sequence[bpy.types.Object]) -> None:
    """Adds sources to a result that has some."""
    kept = result.prefilter_made_of
    for obj in sources if len(kept.sources) else ():
        kept.sources.add().obj = obj
        obj.prefilter_made_of.is_source = True


def sources_of(result: bpy.types.Object) -> list[bpy.types.Object]:
    """Returns the sources of a result that still exist."""
    kept = result.prefilter_made_of
    sources = [entry.obj for entry in kept.sources if entry.obj is not None]
    # Deleted objects remain in the file as long as anything refers to them.
    return [obj for obj in sources if obj.users_collection or _is_hidden_copy(obj, kept)]


def original_of(result: bpy.types.Object) -> bpy.types.Object | None:
    """Returns the original of a result, its first source; None if it is gone."""
    sources = result.prefilter_made_of.sources
    first = sources[0].obj if len(sources) else None
    return first if first is not None and first in sources_of(result) else None


def put_in_place(results: Sequence[bpy.types.Object]) -> None:
    """Moves hidden originals to their results; each result was made of the next one."""
    bpy.context.view_layer.update()
    # Blender updates no world matrix of objects in no collection.
    world = results[0].matrix_world.copy()
    for result in results:
        original = original_of(result)
        if original is None:
            return
        if result.prefilter_made_of.is_source_shown:
            world = original.matrix_world.copy()
        elif _is_copy(original, result):
            _copy_transform(original, result)
        elif not original.visible_get():
            original.matrix_world = world


@contextmanager
def evaluated(
    sources: Sequence[bpy.types.Object], context: bpy.types.Context
) -> Iterator[bpy.types.Depsgraph]:
    """Evaluates objects even if they are hidden or in no collection."""
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
    """Returns the copied sources of results, and recursively of these."""
    copies: list[bpy.types.Object] = []
    pending = list(results)
    while pending:
        result = pending.pop()
        new = [obj for obj in sources_of(result) if _is_copy(obj, result) and obj not in copies]
        copies += new
        pending += new
    return copies


def result_of(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Returns the result that shows an object as its source, or the object if it has sources."""
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
    """Shows the sources of a result in its stead, or the result; returns the shown objects."""
    sources = sources_of(result)
    shown, hidden = (sources, [result]) if source else ([result], sources)
    copy = next((obj for obj in sources if _is_copy(obj, result)), None)
    original = original_of(result)
    if copy is not None:
        _copy_transform(*((copy, result) if source else (result, copy)))
    elif original is not None:
        context.view_layer.update()
        moved, fixed = (original, result) if source else (result, original)
        moved.matrix_world = fixed.matrix_world
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
        # Hidden objects cannot be selected.
        obj.hide_set(hides)
        obj.select_set(not hides)


def forget(result: bpy.types.Object, context: bpy.types.Context) -> None:
    """Removes the copied sources of a result; other sources remain."""
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
    """Whether a source is the copy of a result's original, which is its first source."""
    return bool(obj.prefilter_made_of.is_copy) and obj == result.prefilter_made_of.sources[0].obj


def _is_hidden_copy(obj: bpy.types.Object, kept: bpy.types.PropertyGroup) -> bool:
    return bool(obj.prefilter_made_of.is_copy) and not kept.is_source_shown


def _copy_transform(obj: bpy.types.Object, like: bpy.types.Object) -> None:
    """Copies the parent and transform of another object."""
    obj.parent, obj.parent_type, obj.parent_bone = like.parent, like.parent_type, like.parent_bone
    obj.matrix_parent_inverse = like.matrix_parent_inverse
    obj.rotation_mode = like.rotation_mode
    obj.matrix_basis = like.matrix_basis
