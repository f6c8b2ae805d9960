# SPDX-License-Identifier: GPL-3.0-or-later

"""Leftovers of killed processes: the next one removes them, but none of live processes."""

import os
import signal
import tempfile
import time

import pytest
from prefilter import _native
from prefilter.files import claims, replacing, staging

resource = pytest.importorskip("resource", reason="Windows has no such limits")
pytestmark = pytest.mark.skipif(os.name == "nt", reason="the signal is that of other systems")


def dying(work):
    """Does some work in another process, which is then killed."""
    child = os.fork()
    if not child:
        kept = work()
        os.kill(os.getpid(), signal.SIGKILL)
        del kept
    _, status = os.waitpid(child, 0)
    assert os.WTERMSIG(status) == signal.SIGKILL


def living(work):
    """Does some work in another process, and returns a function that ends it."""
    told, tells = os.pipe()
    waits, ends = os.pipe()
    child = os.fork()
    if not child:
        os.close(told)
        os.close(ends)  # So that it ends with this process.
        kept = work()
        os.write(tells, b"x")
        os.read(waits, 1)
        os._exit(0 if kept is not None else 1)
    assert os.read(told, 1)

    def end():
        os.write(ends, b"x")
        os.waitpid(child, 0)
        for one in (told, tells, waits, ends):
            os.close(one)

    return end


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def has_nameless(folder):
    staged = staging.stage_data(folder / "a", b"")
    found = not names(folder)
    staged.discard()
    return found


def stage_path(folder):
    return staging.stage_with(folder / "a.txt", lambda path: path.write_text("a"))


def stage_folder(folder):
    def write(path):
        path.write_text("a")
        path.with_name("b.txt").write_text("b")

    return staging.stage_folder(folder / "a.txt", write)


def stage_temporary(folder):
    place = claims.temporary_folder(folder)
    (place.__enter__() / "a.txt").write_text("a")
    return place


def name_data(folder):
    staged = staging.stage_data(folder / "a.txt", b"a")
    staged.name()
    return staged


STAGES = [stage_path, stage_folder, stage_temporary, name_data]


@pytest.mark.parametrize("stage", STAGES)
def test_the_next_one_removes_what_a_dead_process_left(quick_path, stage):
    dying(lambda: stage(quick_path))
    assert names(quick_path)
    replacing.recover(quick_path)
    assert names(quick_path) == []


@pytest.mark.parametrize("stage", STAGES)
def test_what_is_in_the_making_is_left_alone(quick_path, stage):
    end = living(lambda: stage(quick_path))
    before = names(quick_path)
    assert before
    replacing.recover(quick_path)
    assert names(quick_path) == before
    end()
    replacing.recover(quick_path)
    assert names(quick_path) == []


@pytest.mark.parametrize("stage", STAGES)
def test_what_this_process_makes_is_left_alone(quick_path, stage):
    staged = stage(quick_path)
    before = names(quick_path)
    replacing.recover(quick_path)
    assert names(quick_path) == before
    if stage is stage_temporary:
        staged.__exit__(None, None, None)
    else:
        staged.discard()
    assert names(quick_path) == []


def test_files_without_a_name_need_no_next_one(quick_path):
    if not has_nameless(quick_path):
        pytest.skip("files need names there")
    dying(lambda: staging.stage_data(quick_path / "a.txt", b"a"))
    assert names(quick_path) == []


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("days", [0, 2])
def test_what_other_machines_left_stays_for_a_day(quick_path, stage, days):
    """Locks of other machines may not be visible here."""
    dying(lambda: stage(quick_path))
    own = _native.random_name()[: len(".prefilter-") + _native.MACHINE_DIGITS]
    for path in list(quick_path.iterdir()):
        other = path.rename(path.with_name(path.name.replace(own, ".prefilter-ffffffff")))
        then = time.time() - 24 * 3600 * days
        os.utime(other, (then, then))
    before = names(quick_path)
    replacing.recover(quick_path)
    assert names(quick_path) == ([] if days else before)


def test_many_files_at_once(quick_path):
    """More files than a process may have open."""
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (200, limits[1]))
    try:
        files = [staging.stage_data(quick_path / f"{i}.txt", b"%d" % i) for i in range(300)]
        staging.commit_all(files)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert {path.name: path.read_text() for path in quick_path.iterdir()} == {
        f"{i}.txt": str(i) for i in range(300)
    }


def test_links_and_others_files_are_left_alone(quick_path):
    (quick_path / "kept").write_text("kept")
    (quick_path / ".prefilter-12345678").symlink_to("kept")
    (quick_path / ".prefilter-notes.txt").write_text("mine")
    before = names(quick_path)
    replacing.recover(quick_path)
    assert names(quick_path) == before


def test_temporary_folders_are_those_of_the_system(quick_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(quick_path))
    with claims.temporary_folder() as folder:
        assert folder.parent == quick_path
        assert folder.stat().st_mode & 0o777 == 0o700
    assert names(quick_path) == []
