# SPDX-License-Identifier: GPL-3.0-or-later

"""The queue, mostly in an unseen window: waiting jobs get their turn, pause, and are canceled."""

import json
from pathlib import Path

import bpy
import pytest

SESSION = Path(__file__).with_name("queue_session.py")


def test_presses_fill_the_queue(found):
    told = found["mouse"]
    assert told["before"] is False
    assert told["drawn"] is True
    titles = ["Bake Mipmaps: First", "Bake Mipmaps: Second", "Voxelize: Ball"]
    assert [title for title, _ in told["listed"][0]] == titles
    assert [state for _, state in told["listed"][0]] == ["RUNNING", "WAITING", "WAITING"]


def test_the_mouse_pauses_and_cancels(found):
    told = found["mouse"]
    assert told["paused"] == "Paused, 50 %"
    states = [[state for _, state in listed] for listed in told["listed"][1:]]
    assert states == [
        ["RUNNING", "CANCELLED", "WAITING"],
        ["DONE", "CANCELLED", "RUNNING"],
        ["DONE", "CANCELLED", "CANCELLED"],
    ]
    assert told["levels"] == [True, False]
    assert told["ball"] == 162
    assert told["cleared"] == [[], False]


def test_nothing_stays_drawn_as_progress(found):
    """The label below took its place in Blender 4.3, until the mouse passed."""
    while_running, afterward = found["blue"]
    assert while_running > 1000
    assert afterward == 0


def test_each_is_a_step_to_undo(found):
    """The selection at the press counts, even after renaming, and for the redo too."""
    told = found["steps"]
    assert [state for _, state in told["done"]] == ["DONE", "DONE"]
    one, other, too = told["after"]
    assert other == 162
    assert one == too > 162
    assert told["redone"][:2] == [one, 162]
    assert told["redone"][2] > 2 * too
    assert told["undone_once"] == [one, 162, 162]
    assert told["undone_twice"] == [162, 162, 162]


def test_deleted_and_hidden_targets_are_named(found):
    told = found["meanwhile"]
    assert told["waits"] == "Waits for Object Mode"
    assert told["listed"] == [
        ["DONE", ""],
        ["FAILED", "object 'Gone' was deleted while this waited"],
        ["FAILED", "object 'Hidden' was hidden while this waited"],
        ["DONE", ""],
    ]
    assert told["last"] > 162


def test_a_pause_uses_little_processor_time(found):
    told = found["rest"]
    assert told["rests"] < 0.1 * told["works"]
    assert told["ball"] == 10242


def test_another_file_ends_everything(found):
    told = found["file"]
    assert told["before"] == ["RUNNING", "WAITING", "WAITING"]
    assert told["after"] == [[], True]
    assert told["next"] > 8
    assert not told["left"]


def test_blender_quits_while_work_is_paused(in_window, tmp_path):
    result = tmp_path / "result.json"
    in_window(SESSION.with_name("quit_session.py"), result)
    assert json.loads(result.read_text()) == ["RUNNING", "WAITING"]


@pytest.fixture
def queue(addon):
    """Returns the queue, which is empty again afterward."""
    module = addon("core.queue")
    yield module
    assert not module.listed()


def test_paused_work_is_passed_by(queue):
    context = bpy.context
    switches = context.window_manager.prefilter_switches
    first, second = (queue.add(context, "line", name) for name in ("first", "second"))
    other = queue.add(context, "another line", "other")
    assert [job.is_next(context) for job in (first, second, other)] == [True, False, True]
    switches.use_pause[first.switches._index] = True
    assert [job.is_next(context) for job in (first, second, other)] == [False, True, True]
    for job in (first, second, other):
        job.leave(context)


def test_the_number_of_jobs_is_limited(queue):
    jobs = [queue.add(bpy.context, "line", "job") for _ in range(32)]
    with pytest.raises(ValueError, match="32 jobs wait already"):
        queue.add(bpy.context, "line", "one more")
    for job in jobs:
        job.leave(bpy.context)
