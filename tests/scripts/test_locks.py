# SPDX-License-Identifier: GPL-3.0-or-later

"""No two processes change a build folder at once: Ninja's files would be damaged."""

import subprocess
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
LIBRARY = f"""
. '{CHECKOUT}/scripts/lib.sh'
build_dir=$PWD log=$PWD/log
slowly() {{ echo "began $1" >>"$log"; sleep 0.1; echo "ended $1" >>"$log"; }}
ninja() {{ slowly compiling; }}
cmake() {{ slowly configuring; }}
configure_release() {{ configure release NAME=VALUE; }}
"""


@pytest.mark.parametrize(
    "command", ["compile release", "configure release A=B", "build_packages cp311"]
)
def test_a_build_folder_is_changed_by_one_process_at_a_time(tmp_path: Path, command: str) -> None:
    started = [
        subprocess.Popen(["bash", "-c", LIBRARY + each], cwd=tmp_path)
        for each in (command, command, "build_packages cp311")
    ]
    assert [process.wait(timeout=600) for process in started] == [0, 0, 0]
    log = (tmp_path / "log").read_text().splitlines()
    assert len(log) >= 6
    for began, ended in zip(log[::2], log[1::2], strict=True):
        assert (began.split()[0], ended.split()[0]) == ("began", "ended")
        assert began.split()[1] == ended.split()[1]


def test_folders_are_locked_each_by_itself(tmp_path: Path) -> None:
    started = [
        subprocess.Popen(["bash", "-c", f"{LIBRARY}\nninja() {{ {work} }}\n{each}"], cwd=tmp_path)
        for each, work in (
            ("compile release", "until [[ -e other ]]; do sleep 0.02; done;"),
            ("compile sanitize", "touch other;"),
        )
    ]
    assert [process.wait(timeout=600) for process in started] == [0, 0]


def test_what_fails_under_a_lock_fails_the_program_and_leaves_the_lock(tmp_path: Path) -> None:
    failing = (
        "ninja() { return 3; }\nconfigure_release() { :; }\nbuild_packages cp311\necho went on"
    )
    done = subprocess.run(
        ["bash", "-c", LIBRARY + failing], cwd=tmp_path, timeout=600, capture_output=True, text=True
    )
    assert done.returncode != 0
    assert "went on" not in done.stdout
    free = f"flock --nonblock '{tmp_path}/.release.lock' true"
    assert subprocess.run(["bash", "-c", free], timeout=600).returncode == 0
