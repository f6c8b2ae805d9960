# SPDX-License-Identifier: GPL-3.0-or-later

"""An operator that works for a while: in another thread, with progress and Esc; and its redo."""

import math
import textwrap
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

import bpy
import prefilter
from bpy.props import BoolProperty

from . import running
from .jobs import Job, Progress, Work
from .outcome import FAILURES, Outcome
from .running import TICK_SECONDS, Run

Compute = Callable[[Progress], Any]
T = TypeVar("T")
QUICK_SECONDS = 1.0
"""Work up to this long is redone at once when a user changes a setting; longer work waits for
Apply, as it would freeze Blender."""

_PATIENCE_SECONDS = 0.1
"""How long an operator waits for a thread that was cancelled. Steps of other libraries, such as
compressing a file, end when they end; the thread then cleans up by itself."""
_LINE_LENGTH = 44
"""What fits into a redo panel."""
_RUNNING = "It is running; press Esc to cancel it"
# Said when it is called: a button that poll has disabled under the mouse stays so until the mouse
# has left it, and takes no click. A redo panel whose poll fails is gone for good.

# While settings are applied, the view may be turned, but nothing may change.
_HARMLESS_EVENTS = frozenset(
    {
        *("MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "WINDOW_DEACTIVATE", "TIMER"),
        *("MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE"),
        *("TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "NDOF_MOTION"),
    }
)


@dataclass(frozen=True)
class _Past:
    """How long the last run of an operator took, to tell how long a redo will."""

    seconds: float
    load: Any
    effort: float


def read_at_once(steps: Generator[float, None, T]) -> T:
    """Does all steps of a reading, and returns what it does."""
    while True:
        try:
            next(steps)
        except StopIteration as done:
            return done.value


class BackgroundOperator:
    """A mixin: reads and writes on the main thread, and works in another with progress and Esc.

    A subclass has `doing`, `read` and `finish`. Called from a script, it waits. In the redo panel
    (Adjust Last Operation) a change of a setting is shown at once where the work is quick; where
    it is expected to be slow, the panel has the button Apply, which works in the background too.
    """

    doing: str
    """What the status bar says that goes on."""
    use_apply: BoolProperty(
        name="Apply",
        description="Run again with these settings in the background. Press Esc to cancel",
        default=False,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    _past: ClassVar[dict[str, _Past]] = {}
    _job: Job[Any] | None = None
    _run: Run | None = None
    _cancelled_at: float = math.inf
    _steps: Generator[float, None, Compute] | None = None
    _replaced: int = 0
    """The operator whose result this one is to replace; 0 for none."""
    _waits: float = 0.0
    """How many seconds the settings of the redo panel would take that are not applied."""
    _problem: str = ""
    """Why the settings of the redo panel cannot be applied."""

    def read(self, context: bpy.types.Context) -> Compute:
        """Reads from Blender, and returns what then runs in a thread."""
        raise NotImplementedError

    def reading(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Does what `read` does in steps, where it may take long, and yields the fraction done.

        It may then run after the operator's own result is in place.
        """
        return self.read(context)
        yield

    def following(self, context: bpy.types.Context) -> Generator[float, None, Compute] | None:
        """Returns what reads the next part of the work, as `reading` does the first; None at the
        end. A part is read once that before it is computed."""
        del context
        return None

    def finish(self, context: bpy.types.Context, result: Any) -> str:
        """Writes the result of the last part to Blender, and returns what to report."""
        raise NotImplementedError

    def discard(self) -> None:
        """Lets go of what was read and made, however little that is, when `finish` fails or is
        not to come."""

    def releaser(self) -> Callable[[], None]:
        """Returns what does `discard` in another thread, when the operator is gone already."""
        return lambda: None

    def load(self) -> Any:
        """Returns what `effort` needs to know about what was read and computed."""

    def effort(self, load: Any) -> float:
        """Returns how long the present settings take, in a unit of the operator's own.

        Args:
            load: What `load` returned after an earlier run on the same input.
        """
        del load
        return 1.0

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings in the redo panel."""
        del context
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in self._setting_names():
            layout.prop(self, name)

    @classmethod
    def may_be_redone(cls, context: bpy.types.Context) -> bool:
        """Returns whether the operator is the one that Adjust Last Operation adjusts.

        Blender polls it in the state that its result has left, and undoes that afterwards: what was
        selected may be hidden or gone. A poll has to let it pass; `read` says what is amiss.
        """
        last = context.active_operator
        return last is not None and last.bl_idname == cls.bl_rna.identifier

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
            layout.progress(factor=applied.fraction, text=f"{percent} %   Esc: Cancel")
        elif self._problem:
            for i, line in enumerate(textwrap.wrap(self._problem, _LINE_LENGTH)):
                layout.label(text=line, icon="BLANK1" if i else "ERROR")
        else:
            # Always there: the panel grows upwards, and a setting would move from under the mouse.
            row = layout.row()
            row.enabled = bool(self._waits)
            text = f"Apply (about {_spoken(self._waits)})" if self._waits else "Applied"
            row.prop(self, "use_apply", text=text, toggle=True, icon="CHECKMARK")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Works and waits; a redo that would take long does not."""
        if self._is_running():
            return self._fail(_RUNNING)
        try:
            self.complete_settings()
        except ValueError as error:
            return self._fail(error)
        if self.options.is_repeat_last and self._expected_seconds() > QUICK_SECONDS:
            return self._start_again(use_apply=False)
        if self.options.is_repeat:
            return self._redo(context)
        return self._work(context, lambda _: True)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Works in a thread, with progress and Esc to cancel."""
        del event
        if bpy.app.background:
            return self.execute(context)
        if self._is_running():
            return self._fail(_RUNNING)
        if self.use_apply and self.may_be_redone(context):
            self._replaced = context.active_operator.as_pointer()
        self.use_apply = False
        self._steps = self.reading(context)
        self._seconds = 0.0
        in_steps = type(self).reading is not BackgroundOperator.reading
        try:
            self.complete_settings()
            # Blender brings back what it has undone for the redo: nothing read then may be used
            # in a later step.
            if not (self._replaced and in_steps):
                with self._discarding():
                    self._go_on_reading()
        except FAILURES as error:
            return self._fail(error)
        return self._enter(context)

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Shows progress, and writes the result once the thread is done."""
        if event.type == "ESC" and event.value == "PRESS":
            return self._stop(context)
        if event.type != "TIMER":
            return self._handed_on(context, event)
        assert self._run is not None
        if self._cancelled_at == math.inf and self._run.is_cancelled(context):
            return self._stop(context)
        try:
            with self._discarding():
                return self._tick(context)
        except prefilter.Cancelled:
            return self._end_cancelled(context)
        except FAILURES as error:
            self._leave(context)
            return self._fail(error)
        except BaseException:
            self._leave(context)
            raise

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
            self._let_go()
            self._leave(context)

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

    def complete_settings(self) -> None:
        """Sets the settings that the caller has left, where they are not as declared."""

    def _stop(self, context: bpy.types.Context) -> set[str]:
        """Ends the reading, or has the thread end."""
        if self._job is None:
            self._let_go()
            return self._end_cancelled(context)
        self._job.cancel()
        self._cancelled_at = time.monotonic()
        return {"RUNNING_MODAL"}

    def _tick(self, context: bpy.types.Context) -> set[str]:
        """Goes on with what is to do: reading, waiting for the thread, writing."""
        if self._job is None:
            self._go_on_reading()
        if self._job is None:
            self._show(context, "Reading", self._fraction_read)
            return {"RUNNING_MODAL"}
        if not self._job.is_done:
            if time.monotonic() - self._cancelled_at > _PATIENCE_SECONDS:
                self._job.abandon(self.releaser())
                return self._end_cancelled(context)
            self._show(context, self.doing, self._job.progress)
            return {"PASS_THROUGH"}
        result = self._job.result()
        self._seconds += self._job.seconds
        self._steps = self.following(context)
        if self._steps is not None:
            self._job = None
            if self._cancelled_at < math.inf:
                raise prefilter.Cancelled("cancelled")
            return {"RUNNING_MODAL"}
        self._leave(context)
        with self._in_place_of_last(context):
            self._finish(context, result)
        return {"FINISHED"}

    def _work(self, context: bpy.types.Context, progress: Progress) -> set[str]:
        self._seconds = 0.0
        try:
            with self._discarding():
                with self._clock():
                    result = self.read(context)(progress)
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
        if self._waits > QUICK_SECONDS:
            return {"CANCELLED"}
        deadline = _Deadline(QUICK_SECONDS)
        try:
            done = self._work(context, deadline)
        except prefilter.Cancelled:
            self._waits = deadline.expected_seconds()
            self._note_run(self._waits, BackgroundOperator._past.get(self._key()))
            return {"CANCELLED"}
        self._waits = 0.0
        return done

    def _start_again(self, *, use_apply: bool) -> set[str]:
        """Starts another operator with the settings of this one in the background."""
        settings = {name: getattr(self, name) for name in self._setting_names()}
        start = getattr(bpy.ops.prefilter, self._key().partition(".")[2])
        try:
            start("INVOKE_DEFAULT", use_apply=use_apply, **settings)
        except RuntimeError as error:
            self._problem = str(error).removeprefix("Error: ").strip()
        return {"CANCELLED"}

    def _expected_seconds(self) -> float:
        past = BackgroundOperator._past.get(self._key())
        if past is None:
            return 0.0
        try:
            return past.seconds * self.effort(past.load) / past.effort
        except ValueError:  # Settings that are refused: the work says why, at once.
            return 0.0

    def _note_run(self, seconds: float, earlier: _Past | None = None) -> None:
        load = self.load() if earlier is None else earlier.load
        BackgroundOperator._past[self._key()] = _Past(seconds, load, self.effort(load))

    def _go_on_reading(self) -> None:
        """Reads for a tick's time; starts the thread once everything is read."""
        assert self._steps is not None
        end = time.monotonic() + TICK_SECONDS
        with self._clock():
            try:
                while time.monotonic() < end:
                    self._fraction_read = next(self._steps)
            except StopIteration as done:
                self._steps = None
                self._job = Job(done.value)

    def _finish(self, context: bpy.types.Context, result: Any) -> None:
        with self._clock():
            self.report({"INFO"}, self.finish(context, result))
        self._note_run(self._seconds)

    @contextmanager
    def _in_place_of_last(self, context: bpy.types.Context) -> Iterator[None]:
        """Undoes the operator that is replaced; brings that back where nothing replaces it."""
        is_undone = False
        if self._replaced:
            last = context.active_operator
            if last is None or last.as_pointer() != self._replaced:
                raise ValueError("Not applied: something else has changed meanwhile")
            if "UNDO" in self.bl_options:
                bpy.ops.ed.undo()
                is_undone = True
        try:
            yield
        except BaseException:
            if is_undone:
                bpy.ops.ed.redo()
            raise

    @contextmanager
    def _clock(self) -> Iterator[None]:
        began = time.monotonic()
        try:
            yield
        finally:
            self._seconds += time.monotonic() - began

    @contextmanager
    def _discarding(self) -> Iterator[None]:
        try:
            yield
        except BaseException:
            self._let_go()
            raise

    def _let_go(self) -> None:
        if self._steps is not None:
            self._steps.close()
        self.discard()

    def _handed_on(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Returns what an event leads to that says nothing to the operator."""
        is_free = self._job is not None and not self._replaced
        if is_free or event.type in _HARMLESS_EVENTS:
            return {"PASS_THROUGH"}
        is_click = event.type == "LEFTMOUSE" and running.is_over_button(context, event)
        return {"PASS_THROUGH"} if is_click else {"RUNNING_MODAL"}

    def _end_cancelled(self, context: bpy.types.Context) -> set[str]:
        self._leave(context)
        self.report({"INFO"}, f"{self.doing} canceled")
        return {"CANCELLED"}

    def _fail(self, error: object) -> set[str]:
        self._problem = str(error)
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    @classmethod
    def _is_running(cls) -> bool:
        return running.find(cls._key()) is not None

    @classmethod
    def _key(cls) -> str:
        return cls.bl_idname

    def _setting_names(self) -> list[str]:
        properties = self.properties.bl_rna.properties
        return [item.identifier for item in properties if not (item.is_hidden or item.is_readonly)]

    def _enter(self, context: bpy.types.Context) -> set[str]:
        self._run = Run(context, self._key(), is_redo=bool(self._replaced))
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _show(self, context: bpy.types.Context, what: str, fraction: float) -> None:
        assert self._run is not None
        self._run.show(context, what, fraction)

    def _leave(self, context: bpy.types.Context) -> None:
        if self._run is not None:
            self._run.end(context)
            self._run = None


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


class _Deadline:
    """Progress that says to stop after some time."""

    def __init__(self, seconds: float) -> None:
        self._began = time.monotonic()
        self._seconds = seconds
        self._fraction = 0.0

    def __call__(self, fraction: float) -> bool:
        self._fraction = fraction
        return time.monotonic() - self._began < self._seconds

    def expected_seconds(self) -> float:
        """Returns how long all of the work would take, as far as that can be told."""
        passed = time.monotonic() - self._began
        return max(passed / max(self._fraction, 0.1), 2.0 * self._seconds)


def _spoken(seconds: float) -> str:
    return f"{max(seconds, 1.0):.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
