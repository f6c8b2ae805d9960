# SPDX-License-Identifier: GPL-3.0-or-later

"""Evaluation of objects without armatures, which go on deforming the results."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy


@contextmanager
def at_rest(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> Iterator[None]:
    """Disables the armatures of objects, and evaluates the objects in rest position.

    Args:
        objects: The objects.
        depsgraph: The dependency graph, which is reevaluated if there is an armature.
    """
    meshes = [obj for obj in objects if obj.type == "MESH"]
    modifiers = [
        modifier
        for obj in meshes
        for modifier in obj.modifiers
        if modifier.type == "ARMATURE" and modifier.show_viewport
    ]
    parented = [obj for obj in meshes if obj.parent_type == "ARMATURE"]
    if not modifiers and not parented:
        yield
        return
    # Blender resets the matrix when the parent type changes.
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
