# SPDX-License-Identifier: GPL-3.0-or-later

"""Gizmo for the line of a wipe, dragged in the Image editor."""

from typing import TYPE_CHECKING, Any

import bpy

from .views import View

_REACH = 6.0
"""Distance from the line at which the mouse grabs it, in pixels at a UI scale of 1."""
_PRECISE_SPEED = 0.1
_SNAP = 0.125
"""Snapping distance with Ctrl, as a share of the width."""

_active = ("", 0)
"""Settings of the view, and region, of the line under the mouse."""


def is_active(region: bpy.types.Region) -> bool:
    """Whether the mouse is on the line of a region."""
    return _active[1] == region.as_pointer()


def _point(context: bpy.types.Context, view: View[Any], *, is_on: bool) -> None:
    """Changes the mouse cursor on entering or leaving the line."""
    global _active
    here = (view.group, context.region.as_pointer())
    if is_on == (_active == here):
        return
    if is_on:
        context.window.cursor_modal_set("MOVE_X")
    else:
        context.window.cursor_modal_restore()
    _active = here if is_on else ("", 0)


class WipeGizmo:
    """A mixin: the line. Subclasses set `view`, whose settings have the position as `wipe`."""

    view: View[Any]
    if TYPE_CHECKING:
        is_highlight: bool
        is_modal: bool

    def setup(self) -> None:
        """Initializes the state of dragging."""
        self._share = self._share_before = 0.0
        self._mouse_x = 0

    def draw(self, context: bpy.types.Context) -> None:
        """Updates the mouse cursor; the view draws the line itself, on top of gizmos."""
        _point(context, self.view, is_on=self.is_highlight or self.is_modal)

    def test_select(self, context: bpy.types.Context, location: tuple[float, float]) -> int:
        """Returns 0 if the mouse is on the line, else -1."""
        line = self.view.state(context).wipe * context.region.width
        reach = _REACH * context.preferences.system.ui_scale
        return 0 if abs(location[0] - line) <= reach else -1

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts dragging."""
        self._share = self._share_before = self.view.state(context).wipe
        self._mouse_x = event.mouse_x
        return {"RUNNING_MODAL"}

    def modal(
        self, context: bpy.types.Context, event: bpy.types.Event, tweak: set[str]
    ) -> set[str]:
        """Moves the line with the mouse."""
        step = (event.mouse_x - self._mouse_x) / context.region.width
        self._mouse_x = event.mouse_x
        self._share += step * (_PRECISE_SPEED if "PRECISE" in tweak else 1.0)
        share = min(max(self._share, 0.0), 1.0)
        self.view.state(context).wipe = _snapped(share) if "SNAP" in tweak else share
        return {"RUNNING_MODAL"}

    def exit(self, context: bpy.types.Context, cancel: bool) -> None:
        """Ends dragging; restores the position if cancelled."""
        if cancel:
            self.view.state(context).wipe = self._share_before


class WipeGroup:
    """A mixin: shows the line of a view. Subclasses set `gizmo` and its `view`."""

    bl_label = "Wipe"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "WINDOW"
    bl_options = {"PERSISTENT", "SHOW_MODAL_ALL"}

    gizmo: type[bpy.types.Gizmo]
    view: View[Any]
    if TYPE_CHECKING:
        gizmos: bpy.types.Gizmos

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the editor draws the line."""
        is_there = cls.is_there(context)
        if not is_there:
            _point(context, cls.view, is_on=False)
        return is_there

    @classmethod
    def is_there(cls, context: bpy.types.Context) -> bool:
        """Whether the editor draws the line."""
        state = cls.view.state(context)
        return cls.view.here(context) is not None and getattr(state, cls.view.switch)

    def setup(self, context: bpy.types.Context) -> None:
        """Adds the line."""
        del context
        line = self.gizmos.new(self.gizmo.bl_idname)
        line.use_draw_modal = True


def _snapped(share: float) -> float:
    return round(share / _SNAP) * _SNAP
