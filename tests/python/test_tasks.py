# SPDX-License-Identifier: GPL-3.0-or-later

"""Commands over many files, and a farm's tasks: the same files as from single runs."""

import json
import subprocess
import sys

import pytest
from command_files import fails, noise, run, write_picture, write_quad
from prefilter.commands.tasks import TaskPart

pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")

HALF = ("--percent", "50")
DRAWING = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 4"><path d="M0 0h{}v3z"/></svg>'


@pytest.fixture
def pictures(tmp_path):
    return [write_picture(tmp_path / f"{i}.png", noise(8, 12, seed=i)) for i in range(5)]


def folder(path, name):
    (path / name).mkdir()
    return path / name / "{name}.png"


def contents(path):
    return {file.name: file.read_bytes() for file in path.iterdir()}


@pytest.mark.parametrize("count", [1, 2, 3, 5, 7])
@pytest.mark.parametrize("tasks", [0, 1, 4, 11])
def test_parts_have_every_task_once(tasks, count):
    parts = [TaskPart(number, count).select(range(tasks)) for number in range(1, count + 1)]
    assert sorted(task for part in parts for task in part) == list(range(tasks))
    assert max(map(len, parts)) - min(map(len, parts)) <= 1


@pytest.mark.parametrize("count", [2, 5, 6])
def test_the_parts_make_what_the_whole_makes(pictures, tmp_path, capsys, count):
    whole, parts = folder(tmp_path, "whole"), folder(tmp_path, "parts")
    single = folder(tmp_path, "single").parent
    assert run("resize", *pictures, "-o", whole, *HALF) == 0
    for number in range(1, count + 1):
        assert run("resize", *pictures, "-o", parts, *HALF, "--task", f"{number}/{count}") == 0
    for path in pictures:
        assert run("resize", path, "-o", single / path.name, *HALF) == 0
    assert len(contents(single)) == 5
    assert contents(whole.parent) == contents(parts.parent) == contents(single)
    assert ("Nothing to do in part 6 of 6" in capsys.readouterr().out) == (count == 6)


def test_every_command_of_many_files(tmp_path):
    drawings = [tmp_path / name for name in ("a.svg", "b.svg")]
    for size, path in enumerate(drawings, start=2):
        path.write_text(DRAWING.format(size))
    assert run("rasterize", *drawings, "-o", folder(tmp_path, "drawn"), "--side", "40") == 0
    quads = [write_quad(tmp_path / name) for name in ("a.obj", "b.obj")]
    assert run("rasterize", *quads, "-o", folder(tmp_path, "masks"), "--uv", "--side", "8") == 0
    assert run("voxelize", *quads, "-o", tmp_path / "{name}.ply", "--depth", "3") == 0
    turned = folder(tmp_path, "turned")
    assert run("resample", tmp_path / "drawn" / "a.png", "-o", turned, "--rotate", "90") == 0
    drawn = contents(tmp_path / "drawn")
    assert drawn.keys() == {"a.png", "b.png"}
    assert drawn["a.png"] != drawn["b.png"]
    assert contents(tmp_path / "masks").keys() == drawn.keys()
    assert contents(turned.parent).keys() == {"a.png"}
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_a_list_says_what_each_task_makes(pictures, tmp_path, capsys):
    target = folder(tmp_path, "out")
    assert run("resize", *pictures[:2], "-o", target, *HALF, "--list", "--json") == 0
    assert json.loads(capsys.readouterr().out) == {
        "tasks": [
            {
                "task": number,
                "inputs": [str(path)],
                "files": [str(target.with_name(path.name))],
            }
            for number, path in enumerate(pictures[:2], start=1)
        ]
    }
    assert run("resize", *pictures[:2], "-o", target, *HALF, "--list") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines] == [
        [str(path), str(target.with_name(path.name))] for path in pictures[:2]
    ]
    assert not contents(target.parent)


def test_a_file_that_fails_stops_no_other(pictures, tmp_path, capsys):
    target = folder(tmp_path, "out")
    pictures[1].write_bytes(b"none")
    last = fails(capsys, 1, "resize", *pictures, "-o", target, *HALF)
    assert "not done: " in last
    assert "1.png" in last
    assert contents(target.parent).keys() == {"0.png", "2.png", "3.png", "4.png"}


@pytest.mark.parametrize(
    ("target", "flags", "word"),
    [
        ("out.png", (), "{name}"),
        ("{name}.png", (), "is read"),
        ("o/{name}.png", ("--task", "3/2"), "--task"),
        ("o/{name}.png", ("--task", "0/2"), "--task"),
        ("o/{name}.png", ("--task", "1"), "--task"),
        ("o/{name}.png", ("--task", "1/2", "--list"), "--task"),
        ("o/{name}.png", ("--json",), "--json"),
        ("o/{name}.png", ("--progress", "xml"), "--progress"),
    ],
)
def test_wrong_arguments(pictures, tmp_path, capsys, target, flags, word):
    (tmp_path / "o").mkdir()
    before = contents(tmp_path / "o")
    assert word in fails(capsys, 2, "resize", *pictures, "-o", tmp_path / target, *HALF, *flags)
    assert contents(tmp_path / "o") == before


def test_two_files_never_become_one(tmp_path, capsys):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
    same = [write_picture(tmp_path / name / "x.png", noise(4, 4)) for name in ("a", "b")]
    target = folder(tmp_path, "out")
    assert "both become" in fails(capsys, 2, "resize", *same, "-o", target, *HALF)


def test_four_processes_at_once_make_what_one_makes(pictures, tmp_path):
    """All write to the same folder, where each looks for others' leftovers."""
    whole, parts = folder(tmp_path, "whole"), folder(tmp_path, "parts")
    assert run("resize", *pictures, "-o", whole, *HALF) == 0
    words = ["-m", "prefilter", "resize", *map(str, pictures), "-o", str(parts), *HALF, "--task"]
    runs = [
        subprocess.Popen([sys.executable, *words, f"{number}/4"], stderr=subprocess.PIPE, text=True)
        for number in (1, 2, 3, 4)
    ]
    for one in runs:
        told = one.communicate(timeout=600)[1]
        assert one.returncode == 0, told
    assert contents(parts.parent) == contents(whole.parent)
