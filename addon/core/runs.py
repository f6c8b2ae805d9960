# SPDX-License-Identifier: GPL-3.0-or-later

"""Running operators: their progress in panels and in the status bar, with buttons to cancel."""

import time
from collections.abc import Callable

import bpy
from bpy.props import StringProperty

from . import switches
from .registration import classes, registration
from .switches import Switches
from .translations import CONTEXT, tr

TICK_SECONDS = 0.05
"""How often a running operator checks its thread."""
ASKING_SECONDS = 10.0
"""Esc asks before it discards more work than this: users often mean a menu or a search."""
_REDRAW_SECONDS = 0.25
"""How often progress is drawn: drawing the panels takes time from the work."""

# Events that do not change data: while settings are applied, the user may still turn the view.
_HARMLESS_EVENTS = frozenset(
    {
        *("MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "WINDOW_DEACTIVATE", "TIMER"),
        *("MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE"),
        *("TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "NDOF_MOTION"),
    }
)

_STATUS_UNITS = 20.0
_CONFUSES_BUTTONS = bpy.app.version < (5, 0, 0)
"""Whether Blender may confuse the button under the mouse with one of another type in a new
layout."""
_runs: dict[str, "Run"] = {}
_ended: set[str] = set()


class PREFILTER_OT_confirm_cancel(bpy.types.Operator):
    """Asks whether to discard long work."""

    bl_idname = "prefilter.confirm_cancel"
    bl_label = "Cancel"
    bl_description = "Stop and discard the result"
    bl_options = frozenset({"INTERNAL"})

    key: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens the dialog."""
        run = _runs.get(self.key)
        if run is None:
            return {"CANCELLED"}
        return context.window_manager.invoke_confirm(
            self,
            event,
            title=tr("Cancel?"),
            message=tr("{}. It has worked for {} s").format(run.status, round(run.seconds)),
            confirm_text=tr("Stop and Discard"),
            icon="QUESTION",
        )

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Presses the button that cancels."""
        run = _runs.get(self.key)
        if run is None:
            return {"CANCELLED"}
        run.switches.press_cancel(context)
        return {"FINISHED"}


class Run:
    """A running operator, and its progress as Blender shows it.

    Attributes:
        is_redo: Whether the redo panel shows the progress, too.
        switches: The Cancel and Pause buttons.
        fraction: The fraction done, as drawn.
        text: The same as text.
    """

    def __init__(
        self, context: bpy.types.Context, key: str, *, is_redo: bool, own: Switches | None = None
    ) -> None:
        """Starts the timer and the progress display.

        Args:
            context: The context of the operator; the timer belongs to its window.
            key: The identifier of the operator.
            is_redo: See `is_redo`.
            own: The buttons of the operator, if it was in the queue.

        Raises:
            ValueError: Too many jobs exist.
        """
        self.is_redo = is_redo
        self.switches = own or Switches(context)
        self.fraction = 0.0
        self.text = _percent(0.0)
        self._activity = ""
        self._key = key
        self._seconds = 0.0
        self._checked_at = time.monotonic()
        self._drawn_at = 0.0
        self._was_paused = False
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(TICK_SECONDS, window=context.window)
        _runs[key] = self
        redraw_panels(context)

    @property
    def seconds(self) -> float:
        """Working time, without pauses."""
        return self._seconds

    @property
    def status(self) -> str:
        """The activity and its progress."""
        return f"{self._activity}: {self.text}"

    def is_cancelled(self, context: bpy.types.Context) -> bool:
        """Returns whether Cancel was pressed."""
        return self.switches.is_cancelled(context)

    def is_paused(self, context: bpy.types.Context) -> bool:
        """Returns whether Pause is pressed; otherwise adds the time since the last call to
        `seconds`."""
        now = time.monotonic()
        if not self._was_paused:
            self._seconds += now - self._checked_at
        self._checked_at = now
        self._was_paused = self.switches.is_paused(context)
        return self._was_paused

    def ask_to_cancel(self) -> bool:
        """Asks whether to cancel if much work would be lost; returns whether it asked."""
        if self.seconds < ASKING_SECONDS:
            return False
        bpy.ops.prefilter.confirm_cancel("INVOKE_DEFAULT", key=self._key)
        return True

    def show(
        self, context: bpy.types.Context, activity: str, fraction: float, pause: str = ""
    ) -> None:
        """Updates the progress display, a few times a second.

        Args:
            context: The context.
            activity: The activity.
            fraction: The fraction done.
            pause: "Pausing" or "Paused"; empty while it works.
        """
        text = f"{tr(pause)}, {_percent(fraction)}" if pause else _percent(fraction)
        now = time.monotonic()
        is_same = (activity, text) == (self._activity, self.text)
        if is_same or now - self._drawn_at < _REDRAW_SECONDS:
            return
        self._activity, self.fraction, self.text, self._drawn_at = activity, fraction, text, now
        context.window_manager.progress_update(round(100 * fraction))
        context.workspace.status_text_set(_draw_status)
        redraw_panels(context)

    def end(self, context: bpy.types.Context) -> None:
        """Removes the timer and the progress display; a second call does nothing."""
        if _runs.get(self._key) is not self:
            return
        del _runs[self._key]
        _ended.add(self._key)
        self.switches.release(context)
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if not _runs:
            _clear_status(context)
        # Buttons stay disabled until they are drawn again.
        for window in context.window_manager.windows:
            for area in window.screen.areas:
                area.tag_redraw()


def find(key: str) -> Run | None:
    """Returns the run of an operator, by its identifier; None if it is not running."""
    return _runs.get(key)


def draw(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    key: str,
    more: Callable[[bpy.types.UILayout], object] | None = None,
) -> bool:
    """Draws the progress of an operator and Cancel; returns False if it is not running.

    Args:
        layout: The layout to draw into.
        context: The context.
        key: The identifier of the operator.
        more: Draws another button, at the other end from Cancel.
    """
    run = _runs.get(key)
    if run is None:
        return False
    parts = layout.split(factor=0.65, align=True)
    row = parts.row(align=True)
    if more is not None:
        more(row)
    row.progress(factor=run.fraction, text=run.text)
    run.switches.draw_cancel(parts, context)
    return True


def draw_successor(layout: bpy.types.UILayout, key: str) -> None:
    """Draws an invisible progress bar in place of one that is gone.

    Otherwise Blender would draw the first label below as a progress bar until the mouse moves.
    """
    if _CONFUSES_BUTTONS and key in _ended:
        row = layout.row()
        row.scale_y = 0.01
        row.progress(factor=0.0)


def is_over_button(context: bpy.types.Context, event: bpy.types.Event) -> bool:
    """Returns whether the mouse is over a Cancel or Pause button."""
    for area in context.window.screen.areas:
        for region in area.regions:
            x, y = event.mouse_x - region.x, event.mouse_y - region.y
            if not (0 <= x < region.width and 0 <= y < region.height):
                continue
            with context.temp_override(area=area, region=region):
                under = bpy.context.property
            if under is not None and switches.is_job_button(under[1]):
                return True
    return False


def event_result(context: bpy.types.Context, event: bpy.types.Event, *, is_free: bool) -> set[str]:
    """Returns the result of `modal` for an event that a running operator does not handle.

    Args:
        context: The context.
        event: The event.
        is_free: Whether the user may edit the scene meanwhile.
    """
    if is_free or event.type in _HARMLESS_EVENTS:
        return {"PASS_THROUGH"}
    is_click = event.type == "LEFTMOUSE" and is_over_button(context, event)
    return {"PASS_THROUGH"} if is_click else {"RUNNING_MODAL"}


register, unregister = registration(switches, classes(PREFILTER_OT_confirm_cancel))


def _percent(fraction: float) -> str:
    return f"{round(100 * fraction)} %"


def _draw_status(header: bpy.types.Header, context: bpy.types.Context) -> None:
    for run in _runs.values():
        row = header.layout.row(align=True)
        row.ui_units_x = _STATUS_UNITS
        row.progress(factor=run.fraction, text=run.status)
        run.switches.draw_cancel(row, context)
    waiting = switches.taken() - len(_runs)
    if waiting:
        header.layout.label(text=tr("{} waiting").format(waiting))
    header.layout.label(text="Esc: Cancel", text_ctxt=CONTEXT)
    header.layout.separator_spacer()


def _clear_status(context: bpy.types.Context) -> None:
    if context.workspace is not None:
        context.workspace.status_text_set(None)
    # During file loading no workspace exists, but the header does.
    header = getattr(bpy.types, "STATUSBAR_HT_header", None)
    if header is not None and header.draw is _draw_status:
        header.draw = header._draw_orig


def redraw_panels(context: bpy.types.Context) -> None:
    """Redraws the panels that show the progress of operators."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if region.type in {"UI", "HUD"} or area.type == "PROPERTIES":
                    region.tag_redraw()
