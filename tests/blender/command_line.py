"""The command, in a Blender of its own."""

import subprocess
from pathlib import Path

import bpy

ARGUMENTS = ["--background", "--command", "prefilter"]


def run(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs `prefilter ARGUMENTS`."""
    return subprocess.run(
        [bpy.app.binary_path, *ARGUMENTS, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=cwd,
        check=False,
    )


def assert_fails(result: subprocess.CompletedProcess[str], *words: str, status: int = 1) -> None:
    """Asserts that a run ended with an error of one line that has all of the words."""
    assert result.returncode == status, result.stderr
    assert "Traceback" not in result.stdout + result.stderr
    last = result.stderr.strip().splitlines()[-1]
    assert "error: " in last
    for word in words:
        assert word in last
