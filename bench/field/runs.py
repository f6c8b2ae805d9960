# SPDX-License-Identifier: GPL-3.0-or-later

"""The entry points that ship, each run in its own process with limits of time and memory."""

import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from bench.field.kinds import CLOUD, DRAWING, MESH, MODEL, PICTURE

_IN_BLENDER = Path(__file__).with_name("in_blender.py")
_COMMAND = (sys.executable, "-m", "prefilter")
_BLENDER = ("blender", "--background", "--python-exit-code", "1")
_POLL_SECONDS = 0.02


@dataclass(frozen=True)
class EntryPoint:
    """A command or an operator at its defaults.

    Attributes:
        name: Its name in tables.
        kinds: The kinds of files that it takes.
        extension: The result's file name extension.
        arguments: Makes the command line of the paths of input and result.
        needs_blender: Whether it runs in Blender.
    """

    name: str
    kinds: tuple[str, ...]
    extension: str
    arguments: Callable[[Path, Path], list[str]]
    needs_blender: bool = False

    def result_extension(self, source: Path) -> str:
        """Returns the extension of the result: pictures of light stay pictures of light."""
        is_light = self.extension == ".png" and source.suffix.lower() in (".exr", ".hdr")
        return ".exr" if is_light else self.extension


def _command(*arguments: str) -> Callable[[Path, Path], list[str]]:
    return lambda source, target: [
        *_COMMAND,
        arguments[0],
        str(source),
        "-o",
        str(target),
        *arguments[1:],
    ]


def _operator(name: str) -> Callable[[Path, Path], list[str]]:
    return lambda source, target: [
        *(*_BLENDER, "--python", str(_IN_BLENDER)),
        *("--", name, str(source), str(target)),
    ]


ENTRY_POINTS = (
    EntryPoint("voxelize", (MESH, MODEL), ".ply", _command("voxelize")),
    EntryPoint("reconstruct", (CLOUD,), ".ply", _command("reconstruct")),
    # Commands that require a size have no default for it.
    EntryPoint("resize", (PICTURE,), ".png", _command("resize", "--percent", "50")),
    EntryPoint(
        "mipmaps",
        (PICTURE,),
        ".ktx2",
        lambda source, target: [*_COMMAND, "mipmaps", str(source), "-o", str(target)],
    ),
    EntryPoint("rasterize", (DRAWING,), ".png", _command("rasterize")),
    EntryPoint(
        "bake --all",
        (MODEL,),
        ".glb",
        lambda source, target: [
            *(*_BLENDER, "--command", "prefilter", "bake", str(source)),
            *("--all", "--output", str(target)),
        ],
        needs_blender=True,
    ),
    EntryPoint("Voxelize (operator)", (MESH,), ".ply", _operator("voxelize"), needs_blender=True),
    EntryPoint(
        "Reconstruct (operator)", (CLOUD,), ".ply", _operator("reconstruct"), needs_blender=True
    ),
)


@dataclass
class Run:
    """The outcome of running an entry point on a file.

    Attributes:
        entry_point: The entry point's name.
        source: The input.
        target: Where the result should be.
        status: The exit status; negative for a signal, None after a time limit.
        seconds: Processor time.
        mebibytes: Peak memory.
        output: Standard output and standard error.
        findings: The faults that the checks found.
    """

    entry_point: str
    source: Path
    target: Path
    status: int | None = None
    seconds: float = 0.0
    mebibytes: float = 0.0
    output: str = ""
    findings: list[str] = field(default_factory=list)

    @property
    def has_result(self) -> bool:
        """Whether a result exists."""
        return self.status == 0 and self.target.exists()


def run(
    entry_point: EntryPoint, source: Path, target: Path, *, most_seconds: float, most_mebibytes: int
) -> Run:
    """Runs an entry point on a copy of a file, in an empty folder."""
    done = Run(entry_point.name, source, target)
    target.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        with tempfile.TemporaryFile() as output:
            process = subprocess.Popen(
                entry_point.arguments(source, target),
                stdout=output,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                cwd=scratch,
                start_new_session=True,
                preexec_fn=lambda: _limit_memory(most_mebibytes),
            )
            done.status, usage = _wait(process, most_seconds)
            output.seek(0)
            done.output = output.read().decode(errors="replace")
        if left := sorted(path.name for path in Path(scratch).iterdir()):
            done.findings.append(f"left files in the current folder: {', '.join(left)}")
    done.seconds = usage.ru_utime + usage.ru_stime
    done.mebibytes = usage.ru_maxrss / 1024
    return done


def _limit_memory(most_mebibytes: int) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (most_mebibytes << 20, most_mebibytes << 20))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _wait(
    process: subprocess.Popen[bytes], most_seconds: float
) -> tuple[int | None, resource.struct_rusage]:
    """Waits for a process; ends it where it takes longer than it may."""
    end = time.monotonic() + most_seconds
    while True:
        number, status, usage = os.wait4(process.pid, os.WNOHANG)
        if number:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage
        if time.monotonic() > end:
            os.killpg(process.pid, signal.SIGKILL)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            return None, usage
        time.sleep(_POLL_SECONDS)


def available(entry_point: EntryPoint) -> bool:
    """Tells whether the program of an entry point is installed."""
    return not entry_point.needs_blender or shutil.which("blender") is not None
