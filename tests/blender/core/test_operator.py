# SPDX-License-Identifier: GPL-3.0-or-later

"""Operators in the background: nothing is left behind, whatever fails, and Esc is heard soon."""

import threading
import time
from types import SimpleNamespace

import prefilter
import pytest

TIMER = SimpleNamespace(type="TIMER", value="NOTHING")
ESC = SimpleNamespace(type="ESC", value="PRESS")
CLICK = SimpleNamespace(type="LEFTMOUSE", value="PRESS")
STEPS = ("read", "compute", "finish")


@pytest.fixture
def context():
    """Returns a context like Blender's at quit time, which counts removals."""
    calls = []
    manager = SimpleNamespace(
        progress_begin=lambda low, high: None,
        progress_update=lambda value: None,
        progress_end=lambda: calls.append("progress"),
        event_timer_add=lambda seconds, window: "timer",
        event_timer_remove=calls.append,
        modal_handler_add=lambda operator: None,
        windows=[],
        prefilter_switches=SimpleNamespace(use_cancel=[False] * 32, use_pause=[False] * 32),
    )
    workspace = SimpleNamespace(status_text_set=lambda text: None)
    return SimpleNamespace(window_manager=manager, window=None, workspace=workspace, calls=calls)


@pytest.fixture
def probe(addon, monkeypatch):
    """Returns a class of operators that work as told, and know how often they let go."""
    module = addon("core.operator")
    app = SimpleNamespace(background=False)
    monkeypatch.setattr(module, "bpy", SimpleNamespace(app=app))

    class Probe(module.BackgroundOperator):
        bl_idname = "prefilter.probe"
        activity = "Probing"
        options = SimpleNamespace(is_repeat=False, is_repeat_last=False)
        fails_in = ""
        error = ValueError("no good")
        discarded = 0
        use_apply = False

        def __init__(self):
            self.reports = []

        def report(self, kind, text):
            self.reports.append(text)

        def read(self, context):
            self._may_fail("read")
            return self.compute

        def compute(self, progress):
            self._may_fail("compute")

        def finish(self, context, result):
            self._may_fail("finish")
            return "done"

        def discard(self):
            self.discarded += 1

        def _may_fail(self, step):
            if self.fails_in == step:
                raise self.error

    yield Probe
    assert addon("core.runs").find("prefilter.probe") is None


class Drawing:
    """A stand-in for Blender's layout that records its calls."""

    def __init__(self):
        self.shown = []

    def split(self, **_):
        return self

    row = split

    def progress(self, *, factor, text):
        self.shown.append((text, factor))

    def prop(self, data, name, **_):
        self.shown.append(name)


def played(operator, context):
    """Runs an operator to its end, and returns its last status."""
    status = operator.invoke(context, None)
    while status <= {"RUNNING_MODAL", "PASS_THROUGH"}:
        time.sleep(0.001)
        status = operator.modal(context, TIMER)
    return status


def test_runs_to_its_end(probe, context):
    operator = probe()
    assert played(operator, context) == {"FINISHED"}
    assert (operator.reports, operator.discarded) == (["done"], 0)
    assert context.calls == ["timer", "progress"]


@pytest.mark.parametrize("in_background", [False, True])
@pytest.mark.parametrize("step", STEPS)
def test_releases_after_any_failure(probe, context, step, in_background):
    operator = probe()
    operator.fails_in = step
    ended = played(operator, context) if in_background else operator.execute(context)
    assert ended == {"CANCELLED"}
    assert operator.discarded == 1
    assert operator.reports == ["no good"]
    assert context.calls in ([], ["timer", "progress"])


@pytest.mark.parametrize("step", STEPS)
def test_releases_after_a_bug(probe, context, step):
    operator = probe()
    operator.fails_in, operator.error = step, KeyError("a bug")
    with pytest.raises(KeyError, match="a bug"):
        played(operator, context)
    assert operator.discarded == 1


def test_quitting_leaves_nothing(probe, context):
    for is_reading in (False, True):
        operator, closed = probe(), []

        def reading(context, closed=closed):
            try:
                while True:
                    yield 0.5
            finally:
                closed.append(True)

        if is_reading:
            operator.read_steps = reading
        operator.invoke(context, None)
        context.workspace = None
        operator.cancel(context)
        assert operator.discarded == 1
        assert closed == [True] * is_reading
        assert context.calls == ["timer", "progress"]
        context.calls.clear()


def test_thread_that_does_not_start_leaves_nothing(addon, probe, context, monkeypatch):
    def no_job(work):
        raise RuntimeError("no thread")

    monkeypatch.setattr(addon("core.staged_work"), "Job", no_job)
    operator = probe()
    with pytest.raises(RuntimeError, match="no thread"):
        operator.invoke(context, None)
    assert operator.discarded == 1


def test_second_run_waits_for_the_first(probe, context):
    first, second, may_end = probe(), probe(), threading.Event()
    first.compute = lambda progress: may_end.wait()
    assert first.invoke(context, None) == {"RUNNING_MODAL"}
    assert second.invoke(context, None) == {"CANCELLED"}
    assert "press Esc" in second.reports[0]
    may_end.set()
    first.cancel(context)


def test_esc_ends_the_work_at_its_next_progress_call(addon, probe, context):
    operator, reports_after_esc, is_pressed = probe(), [], threading.Event()

    def compute(progress):
        while progress(0.5):
            if is_pressed.is_set():
                reports_after_esc.append(True)
            time.sleep(0.001)
        raise prefilter.Cancelled("cancelled")

    operator.compute = compute
    operator.invoke(context, None)
    assert operator.modal(context, ESC) == {"RUNNING_MODAL"}
    is_pressed.set()
    while operator.modal(context, TIMER) != {"CANCELLED"}:
        time.sleep(0.001)
    # One report may have been under way.
    assert len(reports_after_esc) <= 1
    assert addon("core.runs").TICK_SECONDS <= 0.05
    assert operator.reports == ["Probing canceled"]
    assert operator.discarded == 1


def test_the_button_cancels_as_esc_does(addon, probe, context):
    operator = probe()

    def compute(progress):
        while progress(0.25):
            time.sleep(0.001)
        raise prefilter.Cancelled("cancelled")

    operator.compute = compute
    operator.invoke(context, None)
    while operator._staged_work.job.progress < 0.25:
        time.sleep(0.001)
    assert operator.modal(context, TIMER) == {"PASS_THROUGH"}
    drawn = Drawing()
    runs = addon("core.runs")
    assert runs.draw(drawn, context, probe.bl_idname)
    assert drawn.shown == [("25 %", 0.25), "use_cancel"]
    assert not runs.draw(drawn, context, "prefilter.other")
    context.window_manager.prefilter_switches.use_cancel[0] = True
    while operator.modal(context, TIMER) != {"CANCELLED"}:
        time.sleep(0.001)
    assert operator.reports == ["Probing canceled"]
    assert operator.discarded == 1
    # The button comes back unpressed.
    assert played(probe(), context) == {"FINISHED"}


def test_the_button_cancels_reading(probe, context):
    operator, closed = probe(), []

    def reading(_):
        try:
            while True:
                yield 0.5
        finally:
            closed.append(True)

    operator.read_steps = reading
    operator.invoke(context, None)
    assert operator.modal(context, TIMER) == {"RUNNING_MODAL"}
    context.window_manager.prefilter_switches.use_cancel[0] = True
    assert operator.modal(context, TIMER) == {"CANCELLED"}
    assert (closed, operator.discarded) == ([True], 1)


def test_only_the_button_takes_clicks_during_reading(addon, probe, context, monkeypatch):
    operator = probe()
    operator.read_steps = lambda _: iter(lambda: 0.5, None)
    operator._release = lambda: None
    operator.invoke(context, None)
    for is_over, status in ((False, {"RUNNING_MODAL"}), (True, {"PASS_THROUGH"})):
        monkeypatch.setattr(addon("core.runs"), "is_over_button", lambda *_, x=is_over: x)
        assert operator.modal(context, CLICK) == status
    assert operator.modal(context, ESC) == {"CANCELLED"}


def test_esc_does_not_wait_for_a_step_that_cannot_stop(probe, context):
    operator, may_end, released = probe(), threading.Event(), threading.Event()
    operator.compute = lambda progress: may_end.wait()
    operator.discarder = lambda: released.set
    operator.invoke(context, None)
    job = operator._staged_work.job
    operator.modal(context, ESC)
    while operator.modal(context, TIMER) != {"CANCELLED"}:
        time.sleep(0.05)
    assert not job.is_done
    assert not released.is_set()
    may_end.set()
    job.result()
    assert released.is_set()
    assert operator.discarded == 0


def test_redo_that_is_slow_waits(probe, context):
    assert played(probe(), context) == {"FINISHED"}
    operator = probe()
    operator.options = SimpleNamespace(is_repeat=True, is_repeat_last=False)
    operator.duration = lambda load: 1e9
    operator.read = None
    assert operator.execute(context) == {"CANCELLED"}
    assert operator._waits > 1.0


def test_redo_that_turns_out_slow_is_cut_short_and_waits(addon, probe, context, monkeypatch):
    monkeypatch.setattr(addon("core.redo"), "QUICK_SECONDS", 0.3)
    assert played(probe(), context) == {"FINISHED"}
    operator = probe()
    operator.options = SimpleNamespace(is_repeat=True, is_repeat_last=False)

    def compute(progress):
        while progress(0.01):
            time.sleep(0.001)
        raise prefilter.Cancelled("cancelled")

    operator.compute = compute
    assert operator.execute(context) == {"CANCELLED"}
    assert operator.discarded == 1
    # The next change of a setting does not even try.
    operator.read = None
    assert operator.execute(context) == {"CANCELLED"}
    assert operator._waits > 0.3


@pytest.fixture
def in_parts(probe):
    """Returns a class of operators that work in parts, and record their calls."""

    class InParts(probe):
        parts = 3

        def __init__(self):
            super().__init__()
            self.done = []
            self.gate = threading.Event()
            self.gate.set()

        def read(self, context):
            return self._part()

        def read_next_part(self, context):
            if len(self.done) == 2 * self.parts:
                return None
            return self._steps_of_a_part()

        def _steps_of_a_part(self):
            yield 0.5
            return self._part()

        def _part(self):
            self.done.append("read")

            def compute(progress):
                self.gate.wait()
                if not progress(0.5):
                    raise prefilter.Cancelled("cancelled")
                self.done.append("compute")

            return compute

    return InParts


@pytest.mark.parametrize("in_background", [False, True])
def test_a_part_is_read_after_the_one_before_is_computed(in_parts, context, in_background):
    operator = in_parts()
    ended = played(operator, context) if in_background else operator.execute(context)
    assert ended == {"FINISHED"}
    assert operator.done == 3 * ["read", "compute"]
    assert (operator.reports, operator.discarded) == (["done"], 0)


@pytest.mark.parametrize("is_waiting", [True, False])
def test_esc_between_parts(in_parts, context, is_waiting):
    """The part that Esc comes in may end well; that after it is not begun."""
    operator = in_parts()
    operator.gate.clear()
    operator.invoke(context, None)
    if not is_waiting:
        operator.gate.set()
        while not operator._staged_work.job.is_done:
            time.sleep(0.001)
    operator.modal(context, ESC)
    operator.gate.set()
    status = {"RUNNING_MODAL"}
    while status <= {"RUNNING_MODAL", "PASS_THROUGH"}:
        time.sleep(0.001)
        status = operator.modal(context, TIMER)
    assert status == {"CANCELLED"}
    assert operator.discarded == 1
    assert operator.done == (["read"] if is_waiting else ["read", "compute"])
    assert operator.reports == ["Probing canceled"]


@pytest.mark.parametrize("is_cancelled", [False, True])
def test_results_are_made_in_steps(addon, probe, context, monkeypatch, is_cancelled):
    """Between steps only the button and Esc are handled, and Esc discards the results."""
    monkeypatch.setattr(addon("core.runs"), "is_over_button", lambda *_: False)
    operator, made = probe(), []

    def making():
        for number in range(3):
            time.sleep(0.06)
            made.append(number)
            yield

    operator.build_steps = making
    operator.invoke(context, None)
    while not made:
        assert operator.modal(context, TIMER) <= {"PASS_THROUGH", "RUNNING_MODAL"}
    assert made == [0]
    assert operator.modal(context, CLICK) == {"RUNNING_MODAL"}
    if is_cancelled:
        operator.modal(context, ESC)
    status = {"RUNNING_MODAL"}
    while status == {"RUNNING_MODAL"}:
        status = operator.modal(context, TIMER)
    assert status == ({"CANCELLED"} if is_cancelled else {"FINISHED"})
    assert made == ([0] if is_cancelled else [0, 1, 2])
    assert operator.discarded == is_cancelled
    assert operator.reports == ["Probing canceled" if is_cancelled else "done"]
