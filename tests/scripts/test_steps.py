# SPDX-License-Identifier: GPL-3.0-or-later

"""How steps are run and counted."""

import os
import re
import subprocess
from pathlib import Path

import pytest

STEPS = Path(__file__).resolve().parents[2] / "scripts/steps.sh"


def run(program: str, folder: Path, only: str = "") -> tuple[int, str]:
    """Runs steps in a folder; returns the exit status and the output."""
    done = subprocess.run(
        ["bash", "-c", f"set -euo pipefail\n. '{STEPS}'\n{program}\nrun_steps"],
        cwd=folder,
        env={**os.environ, "PREFILTER_TEST_ONLY": only},
        timeout=600,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    return done.returncode, done.stdout


FAILING = """
good() { echo fine; }
bad() { false; echo went on; }
left_out() { skip "no such thing"; }
step "the good" good
step "the bad" bad
step "the ugly" left_out
"""


def test_steps_that_fail_or_are_skipped_are_counted(tmp_path: Path) -> None:
    status, printed = run(FAILING, tmp_path)
    assert status == 1
    assert "went on" not in printed
    assert "skipped: no such thing" in printed
    results = dict(re.findall(r"^(?:--- )(.*): (\w+) \(\d+ s\)$", printed, re.MULTILINE))
    assert results == {"the good": "passed", "the bad": "FAILED", "the ugly": "skipped"}
    assert printed.endswith("1 passed, 1 failed, 1 skipped\n")


def test_a_step_that_is_killed_has_failed(tmp_path: Path) -> None:
    program = """
killed() { kill -KILL "$(cut -d ' ' -f 4 "/proc/$BASHPID/stat")"; }
good() { sleep 0.1; }
step "the killed" killed
step "the good" good
"""
    status, printed = run(program, tmp_path)
    assert status == 1
    assert printed.endswith("1 passed, 1 failed\n")


@pytest.mark.parametrize(("only", "status"), [("bad", 1), ("good", 0), ("ugly", 0)])
def test_a_step_by_itself_has_its_result(tmp_path: Path, only: str, status: int) -> None:
    found, printed = run(FAILING, tmp_path, only)
    assert found == status
    assert "went on" not in printed
    assert len(re.findall(r"^--- ", printed, re.MULTILINE)) == 1


def test_a_step_starts_when_those_that_it_needs_have_ended(tmp_path: Path) -> None:
    program = """
nproc() { echo 2; }
first() { sleep 0.3; echo first >>order; false; }
second() { echo second >>order; }
other() { echo other >>order; }
step second second first missing
step first first
step other other
"""
    status, printed = run(program, tmp_path)
    assert (tmp_path / "order").read_text().split() == ["other", "first", "second"]
    assert status == 1
    assert printed.endswith("2 passed, 1 failed\n")


def test_no_more_run_at_once_than_there_are_processors(tmp_path: Path) -> None:
    program = """
nproc() { echo 2; }
busy() { echo began >>log; sleep 0.1; echo ended >>log; }
a() { busy; }; b() { busy; }; c() { busy; }; d() { busy; }
for name in a b c d; do step "$name" "$name"; done
"""
    assert run(program, tmp_path)[0] == 0
    log = (tmp_path / "log").read_text().split()
    running = [log[: end + 1].count("began") - log[:end].count("ended") for end in range(len(log))]
    assert len(log) == 8
    assert max(running) == 2


def test_time_of_processors_is_counted(tmp_path: Path) -> None:
    spin = "busy() { python3 -c 'import time\nwhile time.process_time() < 1.2: pass'; }"
    _, printed = run(f'{spin}\nstep "a loop" busy\nstep "nothing" true', tmp_path)
    rows = dict(re.findall(r"^passed +\d+ s +(\d+) s  (.*)$", printed, re.MULTILINE))
    assert {name: int(seconds) for seconds, name in rows.items()} == {"a loop": 1, "nothing": 0}
