# SPDX-License-Identifier: GPL-3.0-or-later

"""Operators at work: how far they are, in panels and in the status bar, with buttons to cancel."""

import time

import bpy
from bpy.props import BoolProperty, CollectionProperty, StringProperty

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

_SWITCH = "use_cancel"
_STATUS_UNITS = 20.0
_runs: dict[str, "Run"] = {}


class PREFILTER_PG_run(bpy.types.PropertyGroup):
    """The button that cancels an operator, whose identifier is the name.

    It is a property as Blender tells over which property the mouse is, but not over which operator.
    """

    use_cancel: BoolProperty(
        name="Cancel",
        translation_context=CONTEXT,
        description="Stop and discard the result. Esc does the same",
    )


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
            message=tr("{}. It has worked for {} s").format(run.text, round(run.seconds)),
            confirm_text=tr("Stop and Discard"),
            icon="QUESTION",
        )

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Presses the button that cancels."""
        switch = _switch(context.window_manager, self.key)
        if switch is None:
            return {"CANCELLED"}
        switch.use_cancel = True
        return {"FINISHED"}


class Run:
    """An operator at work, and what Blender shows of that."""

    def __init__(self, context: bpy.types.Context, key: str, *, is_redo: bool) -> None:
        """Begins.

        Args:
            context: Where the operator runs; its timer is for the window.
            key: The identifier of the operator.
            is_redo: Whether the redo panel shows the progress, too.
        """
        self.is_redo = is_redo
        self.fraction = 0.0
        self.text = ""
        self._key = key
        self._began = time.monotonic()
        self._drawn_at = 0.0
        manager = context.window_manager
        switch = _switch(manager, key)
        if switch is None:
            switch = manager.prefilter_runs.add()
            switch.name = key
        switch.use_cancel = False
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(TICK_SECONDS, window=context.window)
        _runs[key] = self
        _redraw_panels(context)

    def is_cancelled(self, context: bpy.types.Context) -> bool:
        """Tells whether someone has pressed the button."""
        switch = _switch(context.window_manager, self._key)
        return switch is not None and switch.use_cancel

    @property
    def seconds(self) -> float:
        """How long it has worked."""
        return time.monotonic() - self._began

    def ask_to_cancel(self) -> bool:
        """Asks whether to cancel, if much would be thrown away; False if there is no need."""
        if self.seconds < ASKING_SECONDS:
            return False
        bpy.ops.prefilter.confirm_cancel("INVOKE_DEFAULT", key=self._key)
        return True

    def show(self, context: bpy.types.Context, what: str, fraction: float) -> None:
        """Shows what goes on, and how much of all is done; a few times a second."""
        percent = round(100 * fraction)
        text = f"{what}: {percent} %"
        now = time.monotonic()
        if text == self.text or now - self._drawn_at < _REDRAW_SECONDS:
            return
        self.fraction, self.text, self._drawn_at = fraction, text, now
        context.window_manager.progress_update(percent)
        context.workspace.status_text_set(_draw_status)
        _redraw_panels(context)

    def end(self, context: bpy.types.Context) -> None:
        """Takes everything back; another call does nothing."""
        if _runs.get(self._key) is not self:
            return
        del _runs[self._key]
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


def draw(layout: bpy.types.UILayout, context: bpy.types.Context, key: str) -> bool:
    """Draws how far an operator is, and a button that cancels it; False if it does not run."""
    run = _runs.get(key)
    if run is None:
        return False
    parts = layout.split(factor=0.65, align=True)
    parts.progress(factor=run.fraction, text=f"{round(100 * run.fraction)} %")
    _draw_switch(parts, context, key)
    return True


def is_over_button(context: bpy.types.Context, event: bpy.types.Event) -> bool:
    """Tells whether the mouse is over a button that cancels."""
    for area in context.window.screen.areas:
        for region in area.regions:
            x, y = event.mouse_x - region.x, event.mouse_y - region.y
            if not (0 <= x < region.width and 0 <= y < region.height):
                continue
            with context.temp_override(area=area, region=region):
                under = bpy.context.property
            if under is not None and under[1].rpartition(".")[2] == _SWITCH:
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


def register() -> None:
    """Registers the buttons."""
    _register_classes()
    bpy.types.WindowManager.prefilter_runs = CollectionProperty(type=PREFILTER_PG_run)


def unregister() -> None:
    """Removes them."""
    del bpy.types.WindowManager.prefilter_runs
    _unregister_classes()


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (PREFILTER_PG_run, PREFILTER_OT_confirm_cancel)
)


def _switch(manager: bpy.types.WindowManager, key: str) -> PREFILTER_PG_run | None:
    return manager.prefilter_runs.get(key)


def _draw_switch(layout: bpy.types.UILayout, context: bpy.types.Context, key: str) -> None:
    # Loading a file may have removed it.
    switch = _switch(context.window_manager, key)
    if switch is not None:
        layout.prop(switch, _SWITCH, icon="X", toggle=True)


def _draw_status(header: bpy.types.Header, context: bpy.types.Context) -> None:
    for key, run in _runs.items():
        row = header.layout.row(align=True)
        row.ui_units_x = _STATUS_UNITS
        row.progress(factor=run.fraction, text=run.text)
        _draw_switch(row, context, key)
    header.layout.label(text="Esc: Cancel")
    header.layout.separator_spacer()


def _clear_status(context: bpy.types.Context) -> None:
    if context.workspace is not None:
        context.workspace.status_text_set(None)
    # While a file is loaded there is no workspace, but the header stays.
    header = getattr(bpy.types, "STATUSBAR_HT_header", None)
    if header is not None and header.draw is _draw_status:
        header.draw = header._draw_orig


def _redraw_panels(context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if region.type in {"UI", "HUD"} or area.type == "PROPERTIES":
                    region.tag_redraw()
