# SPDX-License-Identifier: GPL-3.0-or-later

"""Operators at work: how far they are, in panels and in the status bar, with buttons to cancel."""

import time
from collections.abc import Callable

import bpy
from bpy.props import StringProperty

from . import switches
from .registration import classes, registration
from .switches import Switches
from .translations import CONTEXT, tr

TICK_SECONDS = 0.05
"""How often a running operator looks at its thread."""
ASKING_SECONDS = 10.0
"""How much work Esc throws away without asking; many an Esc is meant for a menu or a search."""
_REDRAW_SECONDS = 0.25
"""How often progress is drawn: drawing the panels takes as long as some of the work."""

# While settings are applied, the view may be turned, but nothing may change.
_HARMLESS_EVENTS = frozenset(
    {
        *("MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "WINDOW_DEACTIVATE", "TIMER"),
        *("MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE"),
        *("TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "NDOF_MOTION"),
    }
)

_STATUS_UNITS = 20.0
_CONFUSES_BUTTONS = bpy.app.version < (5, 0, 0)
"""Whether Blender may take a button under the mouse for one of another type in a new layout."""
_runs: dict[str, "Run"] = {}
_ended: set[str] = set()


class PREFILTER_OT_confirm_cancel(bpy.types.Operator):
    """Asks whether long work is to be thrown away."""

    bl_idname = "prefilter.confirm_cancel"
    bl_label = "Cancel"
    bl_description = "Stop and discard the result"
    bl_options = frozenset({"INTERNAL"})

    key: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks."""
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
    """An operator at work, and what Blender shows of that.

    Attributes:
        is_redo: Whether the redo panel shows the progress, too.
        switches: The buttons.
        fraction: How much is done, as it is drawn.
        text: The same in words.
    """

    def __init__(
        self, context: bpy.types.Context, key: str, *, is_redo: bool, own: Switches | None = None
    ) -> None:
        """Begins.

        Args:
            context: Where the operator runs; its timer is for the window.
            key: The identifier of the operator.
            is_redo: See `is_redo`.
            own: The buttons of the operator, if it has some already.

        Raises:
            ValueError: There are too many buttons.
        """
        self.is_redo = is_redo
        self.switches = own or Switches(context)
        self.fraction = 0.0
        self.text = _percent(0.0)
        self._what = ""
        self._key = key
        self._seconds = 0.0
        self._looked_at = time.monotonic()
        self._drawn_at = 0.0
        self._was_paused = False
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(TICK_SECONDS, window=context.window)
        _runs[key] = self
        redraw_panels(context)

    @property
    def seconds(self) -> float:
        """How long it has worked."""
        return self._seconds

    @property
    def status(self) -> str:
        """What goes on, and how much of it is done."""
        return f"{self._what}: {self.text}"

    def is_cancelled(self, context: bpy.types.Context) -> bool:
        """Tells whether someone has pressed the button."""
        return self.switches.is_cancelled(context)

    def is_paused(self, context: bpy.types.Context) -> bool:
        """Tells whether the work is to pause; counts the time that it does not."""
        now = time.monotonic()
        if not self._was_paused:
            self._seconds += now - self._looked_at
        self._looked_at = now
        self._was_paused = self.switches.is_paused(context)
        return self._was_paused

    def ask_to_cancel(self) -> bool:
        """Asks whether to cancel, if much would be thrown away; False if there is no need."""
        if self.seconds < ASKING_SECONDS:
            return False
        bpy.ops.prefilter.confirm_cancel("INVOKE_DEFAULT", key=self._key)
        return True

    def show(self, context: bpy.types.Context, what: str, fraction: float, pause: str = "") -> None:
        """Shows what goes on, and how much of all is done; a few times a second.

        Args:
            context: The context.
            what: What goes on.
            fraction: How much is done.
            pause: "Pausing" or "Paused"; empty while it works.
        """
        text = f"{tr(pause)}, {_percent(fraction)}" if pause else _percent(fraction)
        now = time.monotonic()
        is_same = (what, text) == (self._what, self.text)
        if is_same or now - self._drawn_at < _REDRAW_SECONDS:
            return
        self._what, self.fraction, self.text, self._drawn_at = what, fraction, text, now
        context.window_manager.progress_update(round(100 * fraction))
        context.workspace.status_text_set(_draw_status)
        redraw_panels(context)

    def end(self, context: bpy.types.Context) -> None:
        """Takes everything back; another call does nothing."""
        if _runs.get(self._key) is not self:
            return
        del _runs[self._key]
        _ended.add(self._key)
        self.switches.release(context)
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if not _runs:
            _clear_status(context)
        # Buttons look as poll has last said; they take no click before they are drawn again.
        for window in context.window_manager.windows:
            for area in window.screen.areas:
                area.tag_redraw()


def find(key: str) -> Run | None:
    """Returns the run of an operator, by its identifier; None if it does not run."""
    return _runs.get(key)


def draw(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    key: str,
    more: Callable[[bpy.types.UILayout], object] | None = None,
) -> bool:
    """Draws how far an operator is, and a button that cancels it; False if it does not run.

    Args:
        layout: Where.
        context: The context.
        key: The identifier of the operator.
        more: Draws another button, away from that which cancels.
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
    """Draws what nobody sees in the place of progress that was drawn, before anything else.

    A progress bar under the mouse would live on as the first label below, until the mouse moves.
    """
    if _CONFUSES_BUTTONS and key in _ended:
        row = layout.row()
        row.scale_y = 0.01
        row.progress(factor=0.0)


def is_over_button(context: bpy.types.Context, event: bpy.types.Event) -> bool:
    """Tells whether the mouse is over a button that cancels."""
    for area in context.window.screen.areas:
        for region in area.regions:
            x, y = event.mouse_x - region.x, event.mouse_y - region.y
            if not (0 <= x < region.width and 0 <= y < region.height):
                continue
            with context.temp_override(area=area, region=region):
                under = bpy.context.property
            if under is not None and switches.is_one(under[1]):
                return True
    return False


def handed_on(context: bpy.types.Context, event: bpy.types.Event, *, is_free: bool) -> set[str]:
    """Returns what an event leads to that says nothing to an operator at work.

    Args:
        context: The context.
        event: The event.
        is_free: Whether a user may go on with other things meanwhile.
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
    # While a file is loaded there is no workspace, but the header stays.
    header = getattr(bpy.types, "STATUSBAR_HT_header", None)
    if header is not None and header.draw is _draw_status:
        header.draw = header._draw_orig


def redraw_panels(context: bpy.types.Context) -> None:
    """Has the panels drawn that show how far operators are."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if region.type in {"UI", "HUD"} or area.type == "PROPERTIES":
                    region.tag_redraw()
