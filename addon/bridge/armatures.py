# SPDX-License-Identifier: GPL-3.0-or-later

"""Objects without what armatures do to them, which goes on doing it to what is made of them."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy


@contextmanager
def at_rest(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> Iterator[None]:
    """Has Blender evaluate objects as they are before armatures deform them.

    Args:
        objects: The objects.
        depsgraph: The dependency graph, which is evaluated anew if there is an armature.
    """
    meshes = [obj for obj in objects if obj.type == "MESH"]
    modifiers = [
        one
        for obj in meshes
        for one in obj.modifiers
        if one.type == "ARMATURE" and one.show_viewport
    ]
    parented = [obj for obj in meshes if obj.parent_type == "ARMATURE"]
    if not modifiers and not parented:
        yield
        return
    # Blender forgets the matrix where the type changes.
    matrices = [obj.matrix_parent_inverse.copy() for obj in parented]

    def switch(*, deforms: bool) -> None:
        for modifier in modifiers:
            modifier.show_viewport = deforms
        for obj, matrix in zip(parented, matrices, strict=True):
            obj.parent_type = "ARMATURE" if deforms else "OBJECT"
            obj.matrix_parent_inverse = matrix
            obj.update_tag(refresh={"DATA"})
        depsgraph.update()

    switch(deforms=False)
    try:
        yield
    finally:
        switch(deforms=True)
