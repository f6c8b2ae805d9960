# SPDX-License-Identifier: GPL-3.0-or-later

"""How commands tell of progress and results, to people and to programs."""

import json
import os
import re
import subprocess
import sys

import pytest
from command_files import noise, run, write_picture

pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")


@pytest.fixture
def pictures(tmp_path):
    (tmp_path / "out").mkdir()
    found = [write_picture(tmp_path / f"{i}.png", noise(8, 12, seed=i)) for i in range(4)]
    return [*found, "-o", tmp_path / "out" / "{name}.png", "--percent", "50"]


def rises_to(values, end):
    assert values == sorted(set(values))
    assert values[0] < end / 2
    assert values[-1] == end


def test_open_job_description_reads_progress_status_and_failure(pictures, tmp_path, capsys):
    assert run("resize", *pictures, "--progress", "openjd") == 0
    told = capsys.readouterr()
    rises_to([float(one) for one in re.findall(r"^openjd_progress: (\S+)$", told.out, re.M)], 100)
    assert len(re.findall(r"^openjd_status: Resized '", told.out, re.M)) == 4
    assert not told.err
    (tmp_path / "1.png").write_bytes(b"none")
    assert run("resize", *pictures, "--progress", "openjd") == 1
    told = capsys.readouterr()
    (failure,) = re.findall(r"^openjd_fail: (.+)$", told.out, re.M)
    assert told.err.splitlines()[-1] == f"prefilter: error: {failure}"


def test_programs_get_an_object_a_line(pictures, tmp_path, capsys):
    (tmp_path / "1.png").write_bytes(b"none")
    assert run("resize", *pictures, "--progress", "json") == 1
    told = capsys.readouterr()
    lines = [json.loads(line) for line in told.out.splitlines()]
    rises_to([line["progress"] for line in lines if "progress" in line], 1)
    done = [line for line in lines if "done" in line]
    assert [line["files"] for line in done] == [
        [str(tmp_path / "out" / f"{i}.png")] for i in (0, 2, 3)
    ]
    (warning,) = [line["warning"] for line in lines if "warning" in line]
    assert "1.png" in warning
    assert lines[-1]["error"].startswith("not done: ")
    assert [line.split(": ")[1] for line in told.err.splitlines()] == ["warning", "error"]


def test_people_get_a_line_each_quarter_of_all_files(pictures, capsys):
    assert run("resize", *pictures) == 0
    percents = re.findall(r"^prefilter: +(\d+) %$", capsys.readouterr().err, re.M)
    assert percents == ["0", "25", "50", "75", "100"]


def test_a_program_that_ends_early_says_so(tmp_path):
    """As from a farm: what the voice of one run says is gone in the next."""
    code = (
        "from prefilter._command import program, telling\n"
        "def stop(): raise KeyboardInterrupt\n"
        "telling.speak('json')\n"
        "telling.share(1, 3).__enter__()\n"
        "raise SystemExit(program.ended(stop))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "prefilter: canceled\n")


def test_output_is_kept_apart_from_what_others_print():
    code = (
        "import os\n"
        "from prefilter._command import telling, voices\n"
        "print('before')\n"
        "with voices.output_apart():\n"
        "    print('an importer')\n"
        "    os.write(1, b'a library\\n')\n"
        "    telling.say('ours')\n"
        "print('Blender quits')\n"
    )
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == "before\nours\n"
    assert set(done.stderr.splitlines()) == {"an importer", "a library", "Blender quits"}
