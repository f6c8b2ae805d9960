# SPDX-License-Identifier: GPL-3.0-or-later

"""Sets of files whose program is killed while it commits them."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from prefilter.files import replacing, staging

COUNT = 6

# Replaces sets again and again: every file of a set has the number of the round as its text.
WRITER = """
import sys
from pathlib import Path
from prefilter.files import staging

folders = [Path(one) for one in sys.argv[2:]]
for number in range(int(sys.argv[1]), 1 << 30):
    files = [
        staging.stage_with(
            folders[i % len(folders)] / f"{i}.txt", lambda path: path.write_text(str(number))
        )
        for i in range(6)
    ]
    staging.commit_all(files)
    print(number, flush=True)
"""

# Dies by the signal that nobody can catch, just before one of the calls that change files.
DYING = """
import os
import signal
import sys
from pathlib import Path
from prefilter.files import claims, staging

count, stage, calls = int(sys.argv[1]), sys.argv[2], 0

def counted(original):
    def call(*arguments, **keywords):
        global calls
        calls += 1
        if calls == count:
            os.kill(os.getpid(), signal.SIGKILL)
        return original(*arguments, **keywords)
    return call

for name in ("replace", "link", "unlink", "fsync", "mkdir", "rmdir"):
    setattr(os, name, counted(getattr(os, name)))
for name in ("write_journal", "clear_journal", "end"):
    setattr(claims.Claim, name, counted(getattr(claims.Claim, name)))
folders = [Path(one) for one in sys.argv[3:]]
targets = [folders[i % len(folders)] / f"{i}.txt" for i in range(6)]
if stage == "folder":
    def write(path):
        for target in targets:
            path.with_name(target.name).write_text("new")
    staging.stage_folder(targets[0], write).commit()
elif stage == "data":
    staging.commit_all([staging.stage_data(target, b"new") for target in targets])
else:
    staging.commit_all(
        [staging.stage_with(target, lambda path: path.write_text("new")) for target in targets]
    )
"""

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the signal is that of other systems")


def texts(*folders):
    """Names and texts of the files of a set, and the number of other files."""
    found = [path for folder in folders for path in folder.iterdir()]
    plain = [path for path in found if not path.name.startswith(".prefilter-")]
    return sorted((path.name, path.read_text()) for path in plain), len(found) - len(plain)


def make_folders(quick_path, count):
    folders = [quick_path / f"folder {number}" for number in range(count)]
    for folder in folders:
        folder.mkdir()
    return folders


def die(number, stage, *folders):
    """Writes a set in a process killed at a call; returns whether it reached that call."""
    child = os.fork()
    if not child:
        sys.argv[1:] = [str(number), stage, *map(str, folders)]
        try:
            exec(DYING, {})
        finally:
            os._exit(0 if sys.exc_info()[0] is None else 1)
    _, status = os.waitpid(child, 0)
    assert status in (0, signal.SIGKILL)
    return status != 0


def write_next(folder):
    staging.stage_data(folder / "next.txt", b"next").commit()
    (folder / "next.txt").unlink()


def environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


@pytest.mark.parametrize(
    ("stage", "count"), [("data", 1), ("data", 2), ("path", 1), ("path", 2), ("folder", 1)]
)
@pytest.mark.parametrize("old", [(), range(1, COUNT, 2), range(COUNT)])
def test_a_kill_at_any_call_leaves_the_old_set_or_the_new_one(quick_path, stage, count, old):
    outcomes = []
    for number in range(1, 200):
        place = quick_path / str(number)
        place.mkdir()
        folders = make_folders(place, count)
        for i in old:
            (folders[i % count] / f"{i}.txt").write_text("old")
        before, _ = texts(*folders)
        killed = die(number, stage, *folders)
        # The next one that writes there, into any of the folders first.
        for folder in (folders[number % count], *folders):
            write_next(folder)
            after, _ = texts(*folders)
            new = [(f"{i}.txt", "new") for i in range(COUNT)]
            assert after in (before, new), number
        assert not list(place.rglob(".prefilter-*"))
        outcomes.append(after == new)
        if not killed:
            break
    # Kills came before the first renaming, after the last, and in between.
    assert not killed
    assert len(outcomes) > COUNT + len(old)
    assert outcomes == sorted(outcomes)
    assert not outcomes[0]
    assert outcomes[-2]


def test_kills_at_random_moments_leave_one_round(quick_path):
    chance = random.Random(5)
    (folder,) = make_folders(quick_path, 1)
    last = 0
    for _ in range(12):
        writer = subprocess.Popen(
            [sys.executable, "-c", WRITER, str(last + 1), str(folder)],
            env=environment(),
            stdout=subprocess.PIPE,
            text=True,
        )
        writer.stdout.readline()
        time.sleep(chance.uniform(0, 0.05))
        writer.kill()
        told = writer.stdout.read().split()
        writer.wait()
        replacing.recover(folder)
        found, _ = texts(folder)
        assert [name for name, _ in found] == [f"{i}.txt" for i in range(COUNT)]
        rounds = {int(text) for _, text in found}
        assert len(rounds) == 1
        (last,) = rounds
        if told:
            assert last in (int(told[-1]), int(told[-1]) + 1)


def test_one_who_lives_is_left_alone(quick_path):
    target = quick_path / "a.txt"
    target.write_text("old")
    new = quick_path / "new"
    new.write_text("new")
    with replacing.restored_on_failure([(new, target), (new, quick_path / "b.txt")]):
        new.rename(target)
        run = subprocess.run(
            [
                *(sys.executable, "-c"),
                "import sys; from pathlib import Path; from prefilter.files import replacing;"
                "replacing.recover(Path(sys.argv[1]))",
                str(quick_path),
            ],
            env=environment(),
            timeout=600,
        )
        assert run.returncode == 0
        assert target.read_text() == "new"
        assert len(list(quick_path.glob("*.set"))) == 1
    assert list(quick_path.glob("*.set")) == []


@pytest.mark.parametrize("text", ["", "{", '{"kept": [["a.txt", ".prefilter-1-0.txt", [4, 5]]]}'])
def test_journals_that_say_nothing_are_removed(quick_path, text):
    target = quick_path / "a.txt"
    target.write_text("text")
    (quick_path / ".prefilter-1.set").write_text(text)
    (quick_path / "own.set").write_text("mine")
    replacing.recover(quick_path)
    assert texts(quick_path) == ([("a.txt", "text"), ("own.set", "mine")], 0)


def left_by_a_dead_process(folder):
    """A set of which one file was replaced, and the other is new."""
    entries = []
    for number, name in enumerate("ab"):
        (folder / f"{name}.txt").write_text("new")
        found = (folder / f"{name}.txt").stat()
        kept = None if number else ".prefilter-1-0.txt"
        entries.append([f"{name}.txt", kept, [found.st_size, found.st_mtime_ns]])
    (folder / ".prefilter-1-0.txt").write_text("old")
    (folder / ".prefilter-1.set").write_text(json.dumps({"kept": entries}))


def test_a_folder_that_was_moved(quick_path):
    (old,) = make_folders(quick_path, 1)
    left_by_a_dead_process(old)
    new = old.rename(quick_path / "elsewhere")
    replacing.recover(new)
    assert texts(new) == ([("a.txt", "old")], 0)


def test_what_others_have_written_since_stays(quick_path):
    left_by_a_dead_process(quick_path)
    for name in ("a.txt", "b.txt"):
        (quick_path / name).write_text("newer")
    replacing.recover(quick_path)
    assert texts(quick_path) == ([("a.txt", "newer"), ("b.txt", "newer")], 0)


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("stage", ["data", "path"])
def test_files_are_on_the_disk_before_they_replace_others(quick_path, monkeypatch, count, stage):
    events = []
    fsync, replace = os.fsync, os.replace

    def told_fsync(descriptor):
        events.append(("on the disk", os.fstat(descriptor).st_ino))
        fsync(descriptor)

    def told_replace(new, target):
        events.append(("replaces", os.stat(new).st_ino))
        replace(new, target)

    monkeypatch.setattr(os, "fsync", told_fsync)
    monkeypatch.setattr(os, "replace", told_replace)
    targets = [quick_path / f"{i}.txt" for i in range(count)]
    if stage == "data":
        files = [staging.stage_data(target, b"new") for target in targets]
    else:
        files = [staging.stage_with(t, lambda path: path.write_text("new")) for t in targets]
    staging.commit_all(files)
    for target in targets:
        number = target.stat().st_ino
        assert events.index(("on the disk", number)) < events.index(("replaces", number))
    folder = ("on the disk", quick_path.stat().st_ino)
    last = max(i for i, (what, _) in enumerate(events) if what == "replaces")
    assert folder in events[last:]
    # The journal is on disk before the files that it names are replaced.
    assert count == 1 or folder in events[: events.index(("replaces", targets[0].stat().st_ino))]


def test_an_empty_set(quick_path):
    staging.commit_all([])
    assert texts(quick_path) == ([], 0)


def test_folders_that_cannot_be_listed(quick_path):
    replacing.recover(quick_path / "missing")
    replacing.recover(Path(__file__))
