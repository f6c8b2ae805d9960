# SPDX-License-Identifier: GPL-3.0-or-later

"""Replacement of meshes in Sculpt Mode.

Sculpt strokes can be undone only on the mesh that they were made on, and Python cannot record the
replacement of a mesh in that undo stack. So the whole state is pushed before the replacement, and
undo returns to it first.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ..core.translations import tr


def obstacle(obj: bpy.types.Object) -> str:
    """Returns why the mesh of a sculpted object cannot be replaced; empty if it can."""
    if any(modifier.type == "MULTIRES" for modifier in obj.modifiers):
        return tr("Multires: apply the modifier first, or leave Sculpt Mode")
    if obj.use_dynamic_topology_sculpting:
        return tr("Turn off Dyntopo first")
    return ""


def note_before(message: str) -> None:
    """Pushes the present state as an undo step."""
    if not bpy.app.background:
        bpy.ops.ed.undo_push(message=message)


@contextmanager
def left() -> Iterator[None]:
    """Leaves Sculpt Mode, and enters it again at the end."""
    bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="SCULPT")
