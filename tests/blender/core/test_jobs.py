# SPDX-License-Identifier: GPL-3.0-or-later

"""Jobs: result, error, progress and cancel."""

import threading
import time

import prefilter
import pytest


def test_result(addon):
    job = addon("core.jobs").Job(lambda progress: 6 * 7)
    assert job.result() == 42
    assert job.is_done


def test_error_is_raised_by_result(addon):
    def work(progress):
        raise ValueError("no good")

    job = addon("core.jobs").Job(work)
    with pytest.raises(ValueError, match="no good"):
        job.result()


def test_progress_and_cancel(addon):
    told, may_go_on = threading.Event(), threading.Event()

    def work(progress):
        before = progress(0.25)
        told.set()
        may_go_on.wait()
        return before, progress(0.5)

    job = addon("core.jobs").Job(work)
    assert told.wait()
    assert job.progress == 0.25
    assert not job.is_done
    job.cancel()
    may_go_on.set()
    assert job.result() == (True, False)


def test_a_pause_holds_the_work_until_it_ends(addon):
    told, reached = [], threading.Event()

    def work(progress):
        while not reached.is_set():
            progress(0.25)
        told.append(progress(0.5))

    began = time.monotonic()
    job = addon("core.jobs").Job(work)
    job.pause(is_paused=True)
    while not job.is_held:
        time.sleep(0.001)
    held_from = time.monotonic()
    reached.set()
    time.sleep(0.05)
    assert not told
    held = time.monotonic() - held_from
    job.pause(is_paused=False)
    job.result()
    assert told == [True]
    # The expected duration of a redo is that of the work, without the pause.
    assert job.seconds <= time.monotonic() - began - held


def test_a_pause_does_not_outlast_a_cancel(addon):
    def work(progress):
        while progress(0.5):
            pass
        return "stopped"

    job = addon("core.jobs").Job(work)
    job.pause(is_paused=True)
    while not job.is_held:
        time.sleep(0.001)
    job.cancel()
    assert job.result() == "stopped"


@pytest.mark.parametrize("threads", [1, 3])
def test_several_at_once(addon, threads):
    begun, told, done = [], [], {}

    def work(index, progress):
        begun.append(index)
        assert progress(0.5)
        done[index] = threading.get_ident()
        assert progress(1.0)

    works = [lambda progress, index=index: work(index, progress) for index in range(7)]
    addon("core.jobs").at_once(works, lambda fraction: told.append(fraction) or True, threads)
    assert sorted(done) == list(range(7))
    assert told == sorted(told)
    assert len(told) == 14
    assert told[-1] == 1.0
    assert (set(done.values()) == {threading.get_ident()}) == (threads == 1)


@pytest.mark.parametrize("threads", [1, 3])
def test_one_of_several_fails(addon, threads):
    begun = []

    def work(index, progress):
        begun.append(index)
        if index == 1:
            raise ValueError("no good")
        # The others end only when they are told to, however the threads are scheduled.
        while index > 1:
            addon("core.jobs").go_on(progress, 0.5)
            time.sleep(0.001)

    works = [lambda progress, index=index: work(index, progress) for index in range(50)]
    with pytest.raises(ValueError, match="no good"):
        addon("core.jobs").at_once(works, lambda _: True, threads)
    assert len(begun) < 50


def test_several_are_cancelled(addon):
    jobs = addon("core.jobs")
    works = [lambda progress: jobs.go_on(progress, 0.5)] * 9
    with pytest.raises(prefilter.Cancelled):
        jobs.at_once(works, lambda _: False, 2)
