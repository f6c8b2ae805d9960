# SPDX-License-Identifier: GPL-3.0-or-later

"""Sculpt Mode: what is in the way of another mesh there, and how an object gets one.

Blender's strokes can be undone only onto the mesh that they were made on, and Python cannot note
that a mesh is replaced. So the state before is noted as a whole, and undo comes back to that first.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ..core.translations import tr


def obstacle(obj: bpy.types.Object) -> str:
    """Returns why the mesh of an object that is sculpted cannot be replaced; empty if it can."""
    if any(modifier.type == "MULTIRES" for modifier in obj.modifiers):
        return tr("Multires: apply the modifier first, or leave Sculpt Mode")
    if obj.use_dynamic_topology_sculpting:
        return tr("Turn off Dyntopo first")
    return ""


def note_before(message: str) -> None:
    """Makes the present state a step to undo to."""
    if not bpy.app.background:
        bpy.ops.ed.undo_push(message=message)


@contextmanager
def left() -> Iterator[None]:
    """Has the active object leave Sculpt Mode, and enter it again in the end."""
    bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="SCULPT")
