# SPDX-License-Identifier: GPL-3.0-or-later

"""An operator that works for a while: in another thread, with progress and Esc; and its redo."""

import math
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

import bpy
import prefilter
from bpy.props import BoolProperty

from . import queue, redo, running
from .doing import Compute, Doing, read_at_once
from .jobs import Progress, Work
from .outcome import FAILURES, reason
from .parts import PartedWork
from .queue import Queued, State
from .running import TICK_SECONDS, Run
from .targets import Targets
from .translations import CONTEXT, marked, report, reported, tr

_PATIENCE_SECONDS = 0.1
"""How long an operator waits for a thread that was cancelled. Steps of other libraries, such as
compressing a file, end when they end; the thread then cleans up by itself."""
_RUNNING = marked("It is running; press Esc to cancel it")
# Said when it is called: a button that poll has disabled under the mouse stays so until the mouse
# has left it, and takes no click. A redo panel whose poll fails is gone for good.
_WAITING_TICK_SECONDS = 0.2
"""How often an operator that waits looks whether it is its turn."""
_handed_targets: list[Targets | None] = []
"""What the next operator works on that is started: that of the one whose redo it is."""


class BackgroundOperator(Doing):
    """A mixin: reads and writes on the main thread, and works in another with progress and Esc.

    A subclass has `doing`, `read` and `finish`. Called from a script, it waits. In the redo panel
    (Adjust Last Operation) a change of a setting is shown at once where the work is quick; where
    it is expected to be slow, the panel has the button Apply, which works in the background too.
    """

    use_apply: BoolProperty(
        name="Apply",
        translation_context=CONTEXT,
        description="Run again with these settings in the background. Press Esc to cancel",
        default=False,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    _parts: PartedWork
    _run: Run | None = None
    _queued: Queued | None = None
    _targets: Targets | None = None
    """What it works on; None has it work on what the context has."""
    _waiting_timer: bpy.types.Timer | None = None
    _has_begun_to_read: bool = False
    _result: Any = None
    _cancelled_at: float = math.inf
    _replaced: int = 0
    """The operator whose result this one is to replace; 0 for none."""
    _waits: float = 0.0
    """How many seconds the settings of the redo panel would take that are not applied."""
    _problem: str = ""
    """Why the settings of the redo panel cannot be applied."""

    @classmethod
    def description(
        cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties
    ) -> str:
        """Returns what the tooltip says; empty has it say the usual."""
        del context, properties
        if not (cls.line and queue.is_busy(cls.line)):
            return ""
        return f"{tr(cls.bl_description)}. {tr('This goes to the end of the queue')}"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the redo panel."""
        layout = self.layout
        run = running.find(self._key())
        applied = run if run is not None and run.is_redo else None
        column = layout.column()
        column.enabled = applied is None
        self.draw_settings(context, column)
        if applied is not None:
            percent = round(100 * applied.fraction)
            text = f"{percent} %   {tr('Esc: Cancel')}"
            layout.progress(factor=applied.fraction, text=text)
        elif self._problem:
            redo.draw_problem(layout, self._problem)
        else:
            # Always there: the panel grows upwards, and a setting would move from under the mouse.
            row = layout.row()
            row.enabled = bool(self._waits)
            text = redo.apply_text(self._waits)
            row.prop(self, "use_apply", text=text, toggle=True, icon="CHECKMARK")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Works and waits; a redo that would take long does not."""
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
        """Works in a thread, with progress and Esc to cancel."""
        del event
        if bpy.app.background:
            return self.execute(context)
        is_redo = self.use_apply and self.may_be_redone(context)
        self.use_apply = False
        waits = bool(self.line) and not is_redo and queue.is_busy(self.line)
        if self._is_running() and not waits:
            return self._fail(_RUNNING)
        if is_redo:
            self._replaced = context.active_operator.as_pointer()
        self._targets = _handed_targets.pop() if _handed_targets else None
        self._parts = PartedWork()
        try:
            self.follow_scene(context)
            self.complete_settings()
            if self.line and not is_redo:
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
        """Shows progress, and writes the result once the thread is done."""
        if self._waiting_timer is not None:
            return self._wait(context) if event.type == "TIMER" else {"PASS_THROUGH"}
        if event.type == "ESC" and event.value == "PRESS":
            is_asking = self._run is not None and self._run.ask_to_cancel()
            return {"RUNNING_MODAL"} if is_asking else self._stop(context)
        if event.type != "TIMER":
            parts = self._parts
            is_computing = parts.job is not None and parts.making is None
            is_free = is_computing and not (self._replaced or self.is_alone)
            return running.handed_on(context, event, is_free=is_free)
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
        """Stops the thread when Blender ends the operator, such as for another file."""
        try:
            if self._parts.job is not None:
                self._parts.job.cancel()
                self._parts.job.result()
        except prefilter.Cancelled:
            pass
        except FAILURES as error:
            self.report({"WARNING"}, report(reason(error)))
        finally:
            self._let_go()
            if self._queued is not None:
                self._queued.leave(context)
            self._leave(context)

    def _join_queue(self, context: bpy.types.Context) -> None:
        """Notes what the operator is about, as the selection may be another at its turn."""
        self._targets = self._targets or Targets.of(context, self.targets(context))
        name = self._targets.name
        label = tr(self.bl_label)
        title = f"{label}: {name}" if name else label
        self._queued = queue.add(context, self.line, title)

    def _wait(self, context: bpy.types.Context) -> set[str]:
        """Begins if it is its turn."""
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
        """Begins to read."""
        in_steps = type(self).reading is not Doing.reading
        try:
            with self._discarding():
                self._parts.steps = self.reading(context)
                # Blender brings back what it has undone for the redo: nothing read then may be
                # used in a later step.
                if not (self._replaced and in_steps):
                    self._read_on(context)
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

    def _read_on(self, context: bpy.types.Context) -> None:
        """Reads for a tick; what was chosen is read first."""
        with nullcontext() if self._has_begun_to_read else self._aimed(context):
            self._has_begun_to_read = True
            self._parts.read_on(TICK_SECONDS)

    @contextmanager
    def _aimed(self, context: bpy.types.Context) -> Iterator[None]:
        """Has the context say what was chosen when the button was pressed."""
        if self._targets is None:
            yield
            return
        self.aim(self._targets.found(context))
        with self._targets.selecting(context):
            yield

    def _stop(self, context: bpy.types.Context) -> set[str]:
        """Ends the reading, or has the thread end."""
        if self._parts.job is None:
            self._let_go()
            return self._end_cancelled(context)
        self._parts.job.cancel()
        self._cancelled_at = time.monotonic()
        return {"RUNNING_MODAL"}

    def _tick(self, context: bpy.types.Context) -> set[str]:
        """Goes on with what is to do: reading, waiting for the thread, writing."""
        parts = self._parts
        assert self._run is not None
        is_paused = self._cancelled_at == math.inf and self._run.is_paused(context)
        if parts.job is None:
            self._read_on(context)
        if parts.job is None:
            # Nothing else may happen meanwhile, so that the pause comes after that.
            pause = marked("Pausing") if is_paused else ""
            self._run.show(context, tr("Reading"), parts.fraction_read, pause)
            return {"RUNNING_MODAL"}
        parts.job.pause(is_paused=is_paused)
        if not parts.job.is_done:
            if time.monotonic() - self._cancelled_at > _PATIENCE_SECONDS:
                parts.job.abandon(self.releaser())
                return self._end_cancelled(context)
            pause = (marked("Paused") if parts.job.is_held else "Pausing") if is_paused else ""
            self._run.show(context, tr(self.doing), parts.job.progress, pause)
            return {"PASS_THROUGH"}
        if is_paused and parts.making is None:
            self._run.show(context, tr(self.doing), parts.job.progress, "Paused")
            return {"PASS_THROUGH"}
        return self._write_on(context)

    def _write_on(self, context: bpy.types.Context) -> set[str]:
        """Goes on once a part is computed: with the next, or with the results of all."""
        parts = self._parts
        if parts.making is None:
            self._result = parts.result()
            parts.steps = self.following(context)
            if parts.steps is not None:
                parts.job = None
                if self._cancelled_at < math.inf:
                    raise prefilter.Cancelled("cancelled")
                return {"RUNNING_MODAL"}
            parts.making = self.making()
        elif self._cancelled_at < math.inf:
            raise prefilter.Cancelled("cancelled")
        # What is made would not outlast the undo that a redo begins with.
        if not (self._replaced or parts.make_on(TICK_SECONDS)):
            return {"RUNNING_MODAL"}
        self._end_run(context)
        undoes = bool(self._replaced) and "UNDO" in self.bl_options
        with redo.in_place_of(self._replaced, context, is_undoable=undoes):
            self._finish(context, self._result)
        self._leave(context, State.DONE)
        return {"FINISHED"}

    def _work(self, context: bpy.types.Context, progress: Progress) -> set[str]:
        self._parts = PartedWork()
        try:
            with self._discarding():
                with self._parts.clock():
                    with self._aimed(context):
                        compute = self.read(context)
                    result = compute(progress)
                    while (steps := self.following(context)) is not None:
                        result = read_at_once(steps)(progress)
                self._finish(context, result)
        except FAILURES as error:
            return self._fail(error)
        return {"FINISHED"}

    def _redo(self, context: bpy.types.Context) -> set[str]:
        """Works with changed settings; CANCELLED has Blender bring back what it has undone."""
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
            done = self._work(context, deadline)
        except prefilter.Cancelled:
            self._waits = deadline.expected_seconds()
            self._note_run(self._waits, redo.past(self._key()))
            return {"CANCELLED"}
        self._waits = 0.0
        return done

    def _start_again(self, *, use_apply: bool) -> set[str]:
        """Starts another operator with the settings of this one in the background."""
        settings = self.handed_on()
        _handed_targets[:] = [self._targets] if use_apply else []
        start = getattr(bpy.ops.prefilter, self._key().partition(".")[2])
        try:
            start("INVOKE_DEFAULT", use_apply=use_apply, **settings)
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
        with self._parts.clock():
            self.report({"INFO"}, report(self.finish(context, result)))
        self._note_run(self._parts.seconds)

    @contextmanager
    def _discarding(self) -> Iterator[None]:
        try:
            yield
        except BaseException:
            self._let_go()
            raise

    def _let_go(self) -> None:
        self._parts.close()
        self.discard()

    def _end_cancelled(self, context: bpy.types.Context) -> set[str]:
        self._leave(context, State.CANCELLED)
        self.report({"INFO"}, report("{} canceled").format(report(self.doing)))
        return {"CANCELLED"}

    def _fail(self, problem: BaseException | str) -> set[str]:
        text = problem if isinstance(problem, str) else reason(problem)
        self._problem = report(text)
        self.report({"ERROR"}, self._problem)
        return {"CANCELLED"}

    @classmethod
    def _is_running(cls) -> bool:
        return running.find(cls._key()) is not None

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
    """A mixin: does `Work`. A subclass has `doing` and `read_work`."""

    work: Work | None = None

    def read_work(self, context: bpy.types.Context) -> Work:
        """Reads from Blender, and returns what is to do."""
        raise NotImplementedError

    def read(self, context: bpy.types.Context) -> Compute:
        """Reads from Blender, and returns what then runs in a thread."""
        self.work = self.read_work(context)
        return self.work.compute

    def making(self) -> Generator[None, None, None]:
        """Makes what the work then writes, if that takes long."""
        making = getattr(self.work, "making", None)
        return making() if making is not None else super().making()

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the result, and returns what to report."""
        del context, result
        assert self.work is not None
        return self.tell(self.work.write())

    def discard(self) -> None:
        """Removes what was staged."""
        self.releaser()()

    def releaser(self) -> Callable[[], None]:
        """Returns what removes what was staged."""
        return self.work.discard if self.work is not None else super().releaser()
