"""An operator that works for a while: in another thread, with progress and Esc."""

from collections.abc import Callable, Iterable
from typing import Any, ClassVar

import bpy
import prefilter

from .jobs import Job, Progress
from .outcome import FAILURES, Outcome

Work = Callable[[Progress], Any]
TICK_SECONDS = 0.1
"""How often a running operator looks at its thread."""


class BackgroundOperator:
    """A mixin: reads and writes on the main thread, and works in another with progress and Esc.

    A subclass has `doing`, `read` and `finish`. Called from a script, it waits.
    """

    doing: ClassVar[str]
    """What the status bar says that goes on."""

    _running: ClassVar[set[str]] = set()
    _job: Job[Any] | None = None

    def read(self, context: bpy.types.Context) -> Work:
        """Reads from Blender, and returns what then runs in a thread."""
        raise NotImplementedError

    def finish(self, context: bpy.types.Context, result: Any) -> str:
        """Writes a result to Blender, and returns what to report."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the operator does not run already."""
        del context
        if cls.bl_idname in BackgroundOperator._running:
            cls.poll_message_set("It is running; press Esc to cancel it")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Works and waits."""
        try:
            work = self.read(context)
            self.report({"INFO"}, self.finish(context, work(lambda _: True)))
        except FAILURES as error:
            return self._fail(error)
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Works in a thread, with progress and Esc to cancel."""
        del event
        if bpy.app.background:
            return self.execute(context)
        try:
            work = self.read(context)
        except FAILURES as error:
            return self._fail(error)
        self._start(work)
        return self._enter(context)

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Shows progress, and writes the result once the thread is done."""
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if not self._job.is_done:
            self._show(context, self.doing, self._job.progress)
            return {"PASS_THROUGH"}
        self._leave(context)
        try:
            self.report({"INFO"}, self.finish(context, self._job.result()))
        except prefilter.Cancelled:
            self.report({"INFO"}, f"{self.doing} cancelled")
            return {"CANCELLED"}
        except FAILURES as error:
            return self._fail(error)
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Stops the thread when Blender ends the operator, such as for another file."""
        try:
            if self._job is not None:
                self._job.cancel()
                self._job.result()
        except prefilter.Cancelled:
            pass
        except FAILURES as error:
            self.report({"WARNING"}, str(error))
        finally:
            self.discard()
            self._leave(context)

    def discard(self) -> None:
        """Lets go of what was read and made, when `finish` is not to come."""

    def tell(self, outcome: Outcome) -> str:
        """Reports what is good to know beside the summary, and returns that."""
        self.warn(outcome.warnings)
        for note in outcome.notes:
            self.report({"INFO"}, note)
        return outcome.summary

    def warn(self, warnings: Iterable[str]) -> None:
        """Reports what was left out, and the like."""
        for warning in warnings:
            self.report({"WARNING"}, warning)

    def _fail(self, error: BaseException) -> set[str]:
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _key(self) -> str:
        return type(self).bl_idname

    def _start(self, work: Work) -> None:
        self._job = Job(work)

    def _enter(self, context: bpy.types.Context) -> set[str]:
        BackgroundOperator._running.add(self._key())
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(TICK_SECONDS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _show(self, context: bpy.types.Context, what: str, fraction: float) -> None:
        percent = round(100 * fraction)
        context.window_manager.progress_update(percent)
        context.workspace.status_text_set(f"{what}: {percent} %   Esc: Cancel")

    def _leave(self, context: bpy.types.Context) -> None:
        BackgroundOperator._running.discard(self._key())
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
