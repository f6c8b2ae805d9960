# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `prefilter`: behavior common to all of its subcommands."""

import os
import subprocess
import sys

import pytest
from prefilter.commands import program


def run(*arguments):
    """Runs the command in a new process."""
    return subprocess.run(
        [sys.executable, "-m", "prefilter", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def processor_seconds(*arguments):
    """Returns the processor seconds of the cheapest of a few runs; 0 on Windows."""
    durations = []
    for _ in range(3):
        before = os.times()
        subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
        after = os.times()
        user = after.children_user - before.children_user
        durations.append(user + after.children_system - before.children_system)
    return min(durations)


def test_help_names_every_command_and_starts_quickly():
    result = run("--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage: prefilter [-h]")
    for name, purpose in program.COMMANDS.items():
        assert name in result.stdout
        assert purpose in " ".join(result.stdout.split())
    # Measured, because Python's own start depends on the machine.
    own = processor_seconds("-m", "prefilter", "--help") - processor_seconds("-c", "import numpy")
    assert own < 0.2


def test_version():
    result = run("--version")
    assert (result.returncode, result.stdout.split()[0]) == (0, "prefilter")


@pytest.mark.parametrize("name", program.COMMANDS)
def test_help_of_each_command(name, capsys):
    assert program.main([name, "--help"]) == 0
    assert capsys.readouterr().out.startswith(f"usage: prefilter {name}")


@pytest.mark.parametrize("arguments", [[], ["bake"], ["mipmaps"], ["mipmaps", "--filter", "soft"]])
def test_wrong_arguments_end_with_2(arguments, capsys):
    assert program.main(arguments) == 2
    told = capsys.readouterr().err
    assert told.startswith("usage: prefilter")
    assert "prefilter" in told.splitlines()[-1]
    assert "error: " in told.splitlines()[-1]


def test_neither_pictures_nor_meshes_are_loaded_for_help():
    code = (
        "import sys; from prefilter.commands.program import main; main(['mipmaps', '--help']);"
        "print('LOADED', *sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.splitlines()[-1].split())
    assert not loaded & {"OpenImageIO", "trimesh"}


@pytest.mark.parametrize("text", ["nan", "inf", "-inf", "1e999", "9" * 400, "", "abc", "0x10"])
@pytest.mark.parametrize(
    ("command", "flags"),
    [
        ("resize", ["--percent", "--width", "--threads"]),
        ("resample", ["--rotate", "--scale-x", "--offset-y"]),
        ("rasterize", ["--side", "--density", "--margin"]),
        ("voxelize", ["--depth", "--voxel-size", "--adaptivity"]),
        ("reconstruct", ["--depth", "--trim", "--memory-limit", "--parts"]),
        ("sampling-table", ["--texels", "--ramp-weight"]),
        ("mipmaps", ["--threshold", "--quality", "--seams"]),
    ],
)
def test_odd_numbers_are_refused_in_one_line(tmp_path, capsys, command, flags, text):
    source = {"resize": "a.png", "resample": "a.png", "rasterize": "a.svg", "mipmaps": "a.png"}
    files = [tmp_path / source.get(command, "a.obj")] if command != "sampling-table" else []
    for flag in flags:
        arguments = [command, *files, "-o", tmp_path / "out", f"{flag}={text}"]
        assert program.main([str(one) for one in arguments]) in (1, 2)
        told = capsys.readouterr().err.splitlines()
        assert sum("error: " in line for line in told) == 1
        assert "error: " in told[-1]
        assert "unexpected" not in told[-1]
        assert len(told[-1]) < 700
