# SPDX-License-Identifier: GPL-3.0-or-later

"""Reports of commands on progress and results, for people and for programs."""

import json
import os
import re
import subprocess
import sys
import tempfile

import pytest
from command_files import noise, run, write_picture
from prefilter.commands import program

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
    """Runs of a farm in one process: a reporter of one run is gone in the next."""
    code = (
        "from prefilter.commands import program, cli_common\n"
        "def stop(): raise KeyboardInterrupt\n"
        "cli_common.use_reporter('json')\n"
        "cli_common.subtask(1, 3).__enter__()\n"
        "raise SystemExit(program.run_to_status(stop))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "prefilter: canceled\n")


OTHERS = (
    "import logging, os, sys, warnings\n"
    "from prefilter.commands import program, cli_common\n"
    "def run():\n"
    "    print('an importer')\n"
    "    os.write(1, b'a library\\n')\n"
    "    os.write(2, b'a library\\n')\n"
    "    warnings.warn('of Python')\n"
    "    logging.warning('of a reader')\n"
    "    cli_common.print_line('ours')\n"
    "    cli_common.warn(['of two\\n  lines'])\n"
    "print('before')\n"
    "status = program.run_to_status(run, is_end={})\n"
    "print('after')\n"
    "raise SystemExit(status)\n"
)


@pytest.mark.parametrize("is_end", [False, True])
@pytest.mark.parametrize("debugs", [False, True])
def test_both_streams_have_what_commands_say_alone(is_end, debugs):
    environment = os.environ | {"PYTHONUNBUFFERED": "1", "PREFILTER_DEBUG": "1" if debugs else ""}
    done = subprocess.run(
        [sys.executable, "-c", OTHERS.format(is_end)],
        capture_output=True,
        text=True,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == ("before\nours\n" if is_end else "before\nours\nafter\n")
    assert "prefilter: warning: of two lines\n" in done.stderr
    if not debugs:
        assert done.stderr.count("\n") == 1
    for line in ("an importer", "a library", "of Python", "of a reader"):
        assert (line in done.stderr) == debugs


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "cp932", "utf-8"])
def test_letters_that_a_console_lacks(tmp_path, encoding):
    write_picture(tmp_path / "\u5199\U0001f600.png", noise(8, 8))
    command = [sys.executable, "-m", "prefilter", "resize", "--percent", "50"]
    command += ["\u5199\U0001f600.png", "-o", "out.png"]
    environment = os.environ | {"PYTHONIOENCODING": encoding}
    for more in ([], ["--progress", "json"], ["--progress", "openjd"]):
        done = subprocess.run([*command, *more], cwd=tmp_path, capture_output=True, env=environment)
        assert done.returncode == 0, done.stderr
        said = done.stdout.decode(encoding)
        if more[1:] == ["json"]:
            last = [json.loads(line) for line in said.splitlines()][-1]["done"]
            assert "'\u5199\U0001f600.png'" in last
        else:
            assert ("\\U0001f600" in said) == (encoding != "utf-8")


@pytest.mark.skipif(os.name == "nt", reason="its shell has other words for that")
def test_streams_that_nobody_reads(tmp_path):
    write_picture(tmp_path / "a.png", noise(8, 8))
    words = f"'{sys.executable}' -m prefilter resize a.png -o out.png --percent 50"
    for shell in (
        f"set -o pipefail; {words} | true",
        f"set -o pipefail; {words} --progress json | true",
        f"set -o pipefail; {words} --list | true",
        f"set -o pipefail; '{sys.executable}' -m prefilter resize --help | true",
        f"{words} >&-",
        f"{words} >/dev/null 2>&-",
        f"{words} <&- >&- 2>&-",
        f"{words} --progress json <&- >&- 2>&-",
    ):
        (tmp_path / "out.png").unlink(missing_ok=True)
        done = subprocess.run(["bash", "-c", shell], cwd=tmp_path, capture_output=True, text=True)
        assert (done.returncode, done.stdout) == (0, ""), shell
        assert "Exception" not in done.stderr
        assert (tmp_path / "out.png").exists() == ("--list" not in shell and "help" not in shell)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no such device")
def test_an_output_that_is_full_is_told(tmp_path):
    write_picture(tmp_path / "a.png", noise(8, 8))
    words = f"'{sys.executable}' -m prefilter resize a.png -o out.png --percent 50 >/dev/full"
    done = subprocess.run(["bash", "-c", words], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1
    assert "error: not all that was said could be written" in done.stderr.splitlines()[-1]
    assert (tmp_path / "out.png").exists()


def test_what_nobody_foresaw_asks_for_a_report(tmp_path, monkeypatch, capsys):
    def run():
        return {}["of a bug"]

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert program.run_to_status(run) == 1
    told = capsys.readouterr().err
    (file,) = tmp_path.iterdir()
    assert told.count("\n") == 1
    assert told.startswith("prefilter: error: unexpected failure (KeyError: 'of a bug')")
    assert f"'{file}'" in told
    assert "in run" in file.read_text()
    monkeypatch.setenv("PREFILTER_DEBUG", "1")
    assert program.run_to_status(run) == 1
    assert "in run" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [file]


def test_words_of_other_libraries_are_not_ours(tmp_path, monkeypatch, capsys):
    """Their messages mean nothing to users, who can act on this package's own."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert program.run_to_status(lambda: json.loads("{")) == 1
    assert "unexpected failure (JSONDecodeError" in capsys.readouterr().err
    assert program.run_to_status(lambda: (tmp_path / "none").read_bytes()) == 1
    assert "error: No such file or directory: " in capsys.readouterr().err
