# SPDX-License-Identifier: GPL-3.0-or-later

"""An operator that works in another thread, with progress, Esc to cancel, and redo."""

import math
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

import bpy
import prefilter
from bpy.props import BoolProperty

from . import queue, redo, runs
from .jobs import Progress, Work
from .operator_hooks import Compute, OperatorHooks, run_steps
from .outcome import FAILURES, reason
from .queue import QueuedJob, State
from .runs import TICK_SECONDS, Run
from .staged_work import StagedWork
from .targets import Targets
from .translations import CONTEXT, marked, report, reported, tr

_PATIENCE_SECONDS = 0.1
"""How long an operator waits for a canceled thread. Calls into other libraries, such as compressing
a file, cannot be interrupted; the thread then cleans up by itself."""
_RUNNING = marked("It is running; press Esc to cancel it")
# Reported by the call instead of by poll: a button that poll disables under the mouse stays
# disabled until the mouse leaves it, and a redo panel whose poll fails never comes back.
_WAITING_TICK_SECONDS = 0.2
"""How often an operator in the queue checks whether it is its turn."""
_handed_targets: list[Targets | None] = []
"""The targets for the next operator to start, handed on by the operator that it redoes."""


class BackgroundOperator(OperatorHooks):
    """A mixin: reads and writes on the main thread, and works in another with progress and Esc.

    A subclass has `activity`, `read` and `finish`. A call from a script blocks. In the redo panel
    (Adjust Last Operation), a changed setting is applied at once if the work is expected to be
    quick; otherwise the panel has the button Apply, which works in the background too.
    """

    use_apply: BoolProperty(
        name="Apply",
        translation_context=CONTEXT,
        description="Run again with these settings in the background. Press Esc to cancel",
        default=False,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    _staged_work: StagedWork
    _run: Run | None = None
    _queued: QueuedJob | None = None
    _targets: Targets | None = None
    """The objects or images to work on; None for those of the context."""
    _waiting_timer: bpy.types.Timer | None = None
    _has_begun_to_read: bool = False
    _result: Any = None
    _cancelled_at: float = math.inf
    _replaced: int = 0
    """Pointer of the operator whose result this one replaces; 0 for none."""
    _waits: float = 0.0
    """Expected seconds for the settings of the redo panel that are not applied yet."""
    _problem: str = ""
    """Why the settings of the redo panel cannot be applied."""

    @classmethod
    def description(
        cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties
    ) -> str:
        """Returns the tooltip; empty for the usual one."""
        del context, properties
        if not (cls.queue_name and queue.is_busy(cls.queue_name)):
            return ""
        return f"{tr(cls.bl_description)}. {tr('This goes to the end of the queue')}"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the redo panel."""
        layout = self.layout
        run = runs.find(self._key())
        redo_run = run if run is not None and run.is_redo else None
        column = layout.column()
        column.enabled = redo_run is None
        self.draw_settings(context, column)
        if redo_run is not None:
            percent = round(100 * redo_run.fraction)
            text = f"{percent} %   {tr('Esc: Cancel')}"
            layout.progress(factor=redo_run.fraction, text=text)
        elif self._problem:
            redo.draw_problem(layout, self._problem)
        else:
            # Always drawn: the panel grows upwards, so a new row would move the setting under the
            # mouse.
            row = layout.row()
            row.enabled = bool(self._waits)
            text = redo.apply_text(self._waits)
            row.prop(self, "use_apply", text=text, toggle=True, icon="CHECKMARK")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Works and blocks until done, unless it is a redo that would take long."""
        if self._is_running():
            return self._fail(_RUNNING)
        try:
            self.complete_settings()
        except ValueError as error:
            return self._fail(error)
        if self.options.is_repeat_last and self._expected_seconds() > redo.QUICK_SECONDS:
            return self._start_again(use_apply=False)
        if self.options.is_repeat:
            return self._redo(context)
        self._targets = None
        return self._work(context, lambda _: True)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts the work in a thread, or queues it."""
        del event
        if bpy.app.background:
            return self.execute(context)
        is_redo = self.use_apply and self.may_be_redone(context)
        self.use_apply = False
        waits = bool(self.queue_name) and not is_redo and queue.is_busy(self.queue_name)
        if self._is_running() and not waits:
            return self._fail(_RUNNING)
        if is_redo:
            self._replaced = context.active_operator.as_pointer()
        self._targets = _handed_targets.pop() if _handed_targets else None
        self._staged_work = StagedWork()
        try:
            self.follow_scene(context)
            self.complete_settings()
            if self.queue_name and not is_redo:
                self._join_queue(context)
        except FAILURES as error:
            return self._fail(error)
        if waits:
            timer = context.window_manager.event_timer_add
            self._waiting_timer = timer(_WAITING_TICK_SECONDS, window=context.window)
            context.window_manager.modal_handler_add(self)
            return {"RUNNING_MODAL"}
        begun = self._begin(context)
        if begun == {"RUNNING_MODAL"}:
            context.window_manager.modal_handler_add(self)
        return begun

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Shows progress, and writes the result when the thread is done."""
        if self._waiting_timer is not None:
            return self._wait(context) if event.type == "TIMER" else {"PASS_THROUGH"}
        if event.type == "ESC" and event.value == "PRESS":
            is_asking = self._run is not None and self._run.ask_to_cancel()
            return {"RUNNING_MODAL"} if is_asking else self._stop(context)
        if event.type != "TIMER":
            parts = self._staged_work
            is_computing = parts.job is not None and parts.build_steps is None
            is_free = is_computing and not (self._replaced or self.is_alone)
            return runs.event_result(context, event, is_free=is_free)
        assert self._run is not None
        if self._cancelled_at == math.inf and self._run.is_cancelled(context):
            return self._stop(context)
        try:
            with self._discarding():
                return self._tick(context)
        except prefilter.Cancelled:
            return self._end_cancelled(context)
        except FAILURES as error:
            self._leave(context, State.FAILED, reason(error))
            return self._fail(error)
        except BaseException as error:
            self._leave(context, State.FAILED, reason(error))
            raise

    def cancel(self, context: bpy.types.Context) -> None:
        """Stops the thread when Blender ends the operator, as when it loads another file."""
        try:
            if self._staged_work.job is not None:
                self._staged_work.job.cancel()
                self._staged_work.job.result()
        except prefilter.Cancelled:
            pass
        except FAILURES as error:
            self.report({"WARNING"}, report(reason(error)))
        finally:
            self._release()
            if self._queued is not None:
                self._queued.leave(context)
            self._leave(context)

    def _join_queue(self, context: bpy.types.Context) -> None:
        """Queues the operator, with its targets: the selection may have changed at its turn."""
        self._targets = self._targets or Targets.of(context, self.targets(context))
        name = self._targets.name
        label = tr(self.bl_label)
        title = f"{label}: {name}" if name else label
        self._queued = queue.add(context, self.queue_name, title)

    def _wait(self, context: bpy.types.Context) -> set[str]:
        """Starts if it is its turn."""
        assert self._queued is not None
        assert self._targets is not None
        if self._queued.switches.is_cancelled(context):
            return self._end_cancelled(context)
        if not self._queued.is_next(context) or self._is_running():
            return {"PASS_THROUGH"}
        if self._targets.mode == "OBJECT" != context.mode:
            self._queued.hold(context, marked("Waits for Object Mode"))
            return {"PASS_THROUGH"}
        self._stop_waiting(context)
        return self._begin(context)

    def _stop_waiting(self, context: bpy.types.Context) -> None:
        if self._waiting_timer is not None:
            context.window_manager.event_timer_remove(self._waiting_timer)
            self._waiting_timer = None

    def _begin(self, context: bpy.types.Context) -> set[str]:
        """Starts reading."""
        in_steps = type(self).read_steps is not OperatorHooks.read_steps
        try:
            with self._discarding():
                self._staged_work.steps = self.read_steps(context)
                # Before a redo Blender restores the data that it had undone: references read now
                # would be invalid in a later step.
                if not (self._replaced and in_steps):
                    self._continue_reading(context)
                own = self._queued.switches if self._queued is not None else None
                self._run = Run(context, self._key(), is_redo=bool(self._replaced), own=own)
        except FAILURES as error:
            self._leave(context, State.FAILED, reason(error))
            return self._fail(error)
        except BaseException as error:
            self._leave(context, State.FAILED, reason(error))
            raise
        if self._queued is not None:
            self._queued.begin(self._run)
        return {"RUNNING_MODAL"}

    def _continue_reading(self, context: bpy.types.Context) -> None:
        """Reads for one tick; the first tick sees the selection of the button press."""
        with nullcontext() if self._has_begun_to_read else self._with_targets(context):
            self._has_begun_to_read = True
            self._staged_work.continue_reading(TICK_SECONDS)

    @contextmanager
    def _with_targets(self, context: bpy.types.Context) -> Iterator[None]:
        """Overrides the selection of the context with that of the button press."""
        if self._targets is None:
            yield
            return
        self.retarget(self._targets.resolve(context))
        with self._targets.override_selection(context):
            yield

    def _stop(self, context: bpy.types.Context) -> set[str]:
        """Stops reading, or asks the thread to stop."""
        if self._staged_work.job is None:
            self._release()
            return self._end_cancelled(context)
        self._staged_work.job.cancel()
        self._cancelled_at = time.monotonic()
        return {"RUNNING_MODAL"}

    def _tick(self, context: bpy.types.Context) -> set[str]:
        """Continues with the present stage: reading, waiting for the thread, or writing."""
        parts = self._staged_work
        assert self._run is not None
        is_paused = self._cancelled_at == math.inf and self._run.is_paused(context)
        if parts.job is None:
            self._continue_reading(context)
        if parts.job is None:
            # Reading blocks all other events, so the pause begins after it.
            pause = marked("Pausing") if is_paused else ""
            self._run.show(context, tr("Reading"), parts.fraction_read, pause)
            return {"RUNNING_MODAL"}
        parts.job.pause(is_paused=is_paused)
        if not parts.job.is_done:
            if time.monotonic() - self._cancelled_at > _PATIENCE_SECONDS:
                parts.job.abandon(self.discarder())
                return self._end_cancelled(context)
            pause = (marked("Paused") if parts.job.is_held else "Pausing") if is_paused else ""
            self._run.show(context, tr(self.activity), parts.job.progress, pause)
            return {"PASS_THROUGH"}
        if is_paused and parts.build_steps is None:
            self._run.show(context, tr(self.activity), parts.job.progress, "Paused")
            return {"PASS_THROUGH"}
        return self._continue_after_job(context)

    def _continue_after_job(self, context: bpy.types.Context) -> set[str]:
        """Continues with the next part, or builds and writes the results after the last one."""
        parts = self._staged_work
        if parts.build_steps is None:
            self._result = parts.result()
            parts.steps = self.read_next_part(context)
            if parts.steps is not None:
                parts.job = None
                if self._cancelled_at < math.inf:
                    raise prefilter.Cancelled("cancelled")
                return {"RUNNING_MODAL"}
            parts.build_steps = self.build_steps()
        elif self._cancelled_at < math.inf:
            raise prefilter.Cancelled("cancelled")
        # A redo begins with an undo, which would remove results built before.
        if not (self._replaced or parts.continue_building(TICK_SECONDS)):
            return {"RUNNING_MODAL"}
        self._end_run(context)
        undoes = bool(self._replaced) and "UNDO" in self.bl_options
        with redo.in_place_of(self._replaced, context, is_undoable=undoes):
            self._finish(context, self._result)
        self._leave(context, State.DONE)
        return {"FINISHED"}

    def _work(self, context: bpy.types.Context, progress: Progress) -> set[str]:
        self._staged_work = StagedWork()
        try:
            with self._discarding():
                with self._staged_work.clock():
                    with self._with_targets(context):
                        compute = self.read(context)
                    result = compute(progress)
                    while (steps := self.read_next_part(context)) is not None:
                        result = run_steps(steps)(progress)
                self._finish(context, result)
        except FAILURES as error:
            return self._fail(error)
        return {"FINISHED"}

    def _redo(self, context: bpy.types.Context) -> set[str]:
        """Works with changed settings; CANCELLED makes Blender restore the previous result."""
        self._waits, self._problem = 0.0, ""
        if self.use_apply:
            self.use_apply = False
            self._waits = self._expected_seconds()
            return self._start_again(use_apply=True)
        self._waits = self._expected_seconds()
        if self._waits > redo.QUICK_SECONDS:
            return {"CANCELLED"}
        deadline = redo.Deadline(redo.QUICK_SECONDS)
        try:
            status = self._work(context, deadline)
        except prefilter.Cancelled:
            self._waits = deadline.expected_seconds()
            self._note_run(self._waits, redo.past(self._key()))
            return {"CANCELLED"}
        self._waits = 0.0
        return status

    def _start_again(self, *, use_apply: bool) -> set[str]:
        """Starts a second operator with the same settings in the background."""
        _handed_targets[:] = [self._targets] if use_apply else []
        start = getattr(bpy.ops.prefilter, self._key().partition(".")[2])
        try:
            start("INVOKE_DEFAULT", use_apply=use_apply, **self.restart_settings())
        except RuntimeError as error:
            self._problem = reported(error)
        finally:
            _handed_targets.clear()
        return {"CANCELLED"}

    def _expected_seconds(self) -> float:
        return redo.expected_seconds(self._key(), self.duration)

    def _note_run(self, seconds: float, earlier: redo.Past | None = None) -> None:
        load = self.load() if earlier is None else earlier.load
        redo.note(self._key(), redo.Past(seconds, load, self.duration(load)))

    def _finish(self, context: bpy.types.Context, result: Any) -> None:
        with self._staged_work.clock():
            self.report({"INFO"}, report(self.finish(context, result)))
        self._note_run(self._staged_work.seconds)

    @contextmanager
    def _discarding(self) -> Iterator[None]:
        try:
            yield
        except BaseException:
            self._release()
            raise

    def _release(self) -> None:
        self._staged_work.close()
        self.discard()

    def _end_cancelled(self, context: bpy.types.Context) -> set[str]:
        self._leave(context, State.CANCELLED)
        self.report({"INFO"}, report("{} canceled").format(report(self.activity)))
        return {"CANCELLED"}

    def _fail(self, problem: BaseException | str) -> set[str]:
        text = problem if isinstance(problem, str) else reason(problem)
        self._problem = report(text)
        self.report({"ERROR"}, self._problem)
        return {"CANCELLED"}

    @classmethod
    def _is_running(cls) -> bool:
        return runs.find(cls._key()) is not None

    def _end_run(self, context: bpy.types.Context) -> None:
        if self._run is not None:
            self._run.end(context)
            self._run = None

    def _leave(
        self, context: bpy.types.Context, state: State = State.CANCELLED, message: str = ""
    ) -> None:
        self._stop_waiting(context)
        self._end_run(context)
        if self._queued is not None:
            self._queued.end(context, state, message)


class WorkOperator(BackgroundOperator):
    """A mixin: an operator that runs a `Work`. A subclass has `activity` and `read_work`."""

    work: Work | None = None

    def read_work(self, context: bpy.types.Context) -> Work:
        """Reads from Blender, and returns the work."""
        raise NotImplementedError

    def read(self, context: bpy.types.Context) -> Compute:
        """Reads from Blender, and returns the function to run in a thread."""
        self.work = self.read_work(context)
        return self.work.compute

    def build_steps(self) -> Generator[None, None, None]:
        """Builds the results in steps, if the work can."""
        build_steps = getattr(self.work, "build_steps", None)
        return build_steps() if build_steps is not None else super().build_steps()

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the result, and returns the summary."""
        del context, result
        assert self.work is not None
        return self.report_outcome(self.work.write())

    def discard(self) -> None:
        """Deletes the staged files."""
        self.discarder()()

    def discarder(self) -> Callable[[], None]:
        """Returns a function that deletes the staged files."""
        return self.work.discard if self.work is not None else super().discarder()
