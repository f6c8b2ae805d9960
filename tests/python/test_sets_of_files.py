# SPDX-License-Identifier: GPL-3.0-or-later

"""Sets of files that are put into place while their program is killed."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from prefilter._border import replacing, staging

COUNT = 6

# Replaces sets again and again: every file of a set has the number of the round as its text.
WRITER = """
import sys
from pathlib import Path
from prefilter._border import staging

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

# Dies by the signal that nobody can catch, just before or after one of the calls that change files.
DYING = """
import os
import signal
import sys
from pathlib import Path
from prefilter._border import replacing, staging

count, calls = int(sys.argv[1]), 0

def counted(original):
    def call(*arguments, **keywords):
        global calls
        calls += 1
        if calls == count:
            os.kill(os.getpid(), signal.SIGKILL)
        return original(*arguments, **keywords)
    return call

folders = [Path(one) for one in sys.argv[2:]]
files = [
    staging.stage_with(folders[i % len(folders)] / f"{i}.txt", lambda path: path.write_text("new"))
    for i in range(6)
]
for name in ("replace", "link"):
    setattr(os, name, counted(getattr(os, name)))
Path.unlink = counted(Path.unlink)
replacing._end = counted(replacing._end)
replacing._begun = counted(replacing._begun)
staging.commit_all(files)
"""

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the signal is that of other systems")


def texts(*folders):
    """What the files of a set say, and how many there are of others."""
    found = [path for folder in folders for path in folder.iterdir()]
    plain = [path for path in found if not path.name.startswith(".prefilter-")]
    return sorted((path.name, path.read_text()) for path in plain), len(found) - len(plain)


def make_folders(tmp_path, count):
    folders = [tmp_path / f"folder {number}" for number in range(count)]
    for folder in folders:
        folder.mkdir()
    return folders


def environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("old", [(), range(COUNT), range(1, COUNT, 2)])
def test_a_kill_at_any_call_leaves_the_old_set_or_the_new_one(tmp_path, count, old):
    outcomes = []
    for number in range(1, 100):
        place = tmp_path / str(number)
        place.mkdir()
        folders = make_folders(place, count)
        for i in old:
            (folders[i % count] / f"{i}.txt").write_text("old")
        before, _ = texts(*folders)
        run = subprocess.run(
            [sys.executable, "-c", DYING, str(number), *map(str, folders)],
            env=environment(),
            timeout=60,
        )
        # The next one that writes there, into any of the folders.
        folder = folders[number % count]
        staging.stage_with(folder / "next.txt", lambda path: path.write_text("next")).commit()
        (folder / "next.txt").unlink()
        after, _ = texts(*folders)
        new = [(f"{i}.txt", "new") for i in range(COUNT)]
        assert after in (before, new), number
        outcomes.append(after == new)
        assert not list(place.rglob("*.set")) or count > 1
        if run.returncode == 0:
            break
        assert run.returncode == -signal.SIGKILL
    # Kills came before the first renaming, after the last, and in between.
    assert run.returncode == 0
    assert len(outcomes) > COUNT + len(old)
    assert outcomes == sorted(outcomes)
    assert not outcomes[0]
    assert outcomes[-2]


def test_kills_at_random_moments_leave_one_round(tmp_path):
    chance = random.Random(5)
    (folder,) = make_folders(tmp_path, 1)
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


def test_one_who_lives_is_left_alone(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")
    kept = [(target, replacing.second_name(target)), (tmp_path / "b.txt", None)]
    with replacing.journal(kept, []):
        target.write_text("new")
        run = subprocess.run(
            [
                *(sys.executable, "-c"),
                "import sys; from pathlib import Path; from prefilter._border import replacing;"
                "replacing.recover(Path(sys.argv[1]))",
                str(tmp_path),
            ],
            env=environment(),
            timeout=60,
        )
        assert run.returncode == 0
        assert target.read_text() == "new"
        assert len(list(tmp_path.glob("*.set"))) == 1
    assert list(tmp_path.glob("*.set")) == []


@pytest.mark.parametrize("text", ["", "{", '{"kept": [["a.txt", ".prefilter-0.txt"]]}'])
def test_journals_that_say_nothing_are_removed(tmp_path, text):
    target = tmp_path / "a.txt"
    target.write_text("text")
    (tmp_path / ".prefilter-1.set").write_text(text)
    (tmp_path / "own.set").write_text("mine")
    replacing.recover(tmp_path)
    assert texts(tmp_path) == ([("a.txt", "text"), ("own.set", "mine")], 0)


def test_a_folder_that_was_moved(tmp_path):
    (old,) = make_folders(tmp_path, 1)
    (old / "a.txt").write_text("new")
    (old / ".prefilter-0.txt").write_text("old")
    (old / ".prefilter-2.txt").write_text("unfinished")
    text = {"kept": [["a.txt", ".prefilter-0.txt"]], "written": [".prefilter-2.txt"]}
    (old / ".prefilter-1.set").write_text(json.dumps(text))
    new = old.rename(tmp_path / "elsewhere")
    replacing.recover(new)
    assert texts(new) == ([("a.txt", "old")], 0)


def test_an_empty_set(tmp_path):
    staging.commit_all([])
    assert texts(tmp_path) == ([], 0)


def test_folders_that_cannot_be_listed(tmp_path):
    replacing.recover(tmp_path / "missing")
    replacing.recover(Path(__file__))
