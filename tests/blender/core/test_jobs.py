"""Jobs: result, error, progress and cancel."""

import threading

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
        may_go_on.wait(10)
        return before, progress(0.5)

    job = addon("core.jobs").Job(work)
    assert told.wait(10)
    assert job.progress == 0.25
    assert not job.is_done
    job.cancel()
    may_go_on.set()
    assert job.result() == (True, False)
