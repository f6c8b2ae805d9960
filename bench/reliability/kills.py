# SPDX-License-Identifier: GPL-3.0-or-later

"""Whether anything is lost where a program is killed: at every call that changes names or waits
for the disk, or at random moments.

After each kill the next run in that folder, which here only recovers, must leave the earlier files
or the new ones, all of a set, and nothing else. kill_at_call.cpp plants the kills at calls. A
random moment lies between the first of several runs in a row and the time that two of them take;
Blender is ready by then.

usage: kills.py calls|random [PATTERN] [--count N] [--json FILE]
  cmake --preset bench && cmake --build build/bench --target prefilter_kill_at_call
  scripts/run python3 bench/reliability/kills.py calls
  scripts/run python3 bench/reliability/kills.py random --count 200
"""

import argparse
import contextlib
import functools
import io
import itertools
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from bench import report  # noqa: E402
from bench.reliability import writers  # noqa: E402
from bench.reliability.disk_full import Trial, contents, is_left  # noqa: E402
from bench.reliability.writers import Writer  # noqa: E402

_PROGRAM = str(Path(__file__).with_name("writers.py"))
LIBRARY = ROOT / "build" / "bench" / "libprefilter_kill_at_call.so"

Begin = Callable[[Trial, Path], "Running"]


@dataclass
class Found:
    """Counts of the states after kills.

    Attributes:
        old: Runs that left the earlier files.
        new: Runs that left the new ones.
        left: Runs whose leftovers stayed until the next run.
        others: Descriptions of any other state.
    """

    old: int = 0
    new: int = 0
    left: int = 0
    others: list[str] = field(default_factory=list)

    @property
    def count(self) -> int:
        """The number of kills."""
        return self.old + self.new + len(self.others)

    def add(self, trial: Trial, out: Path) -> None:
        """Looks at a folder, as it is after the next run."""
        from prefilter.files import replacing

        self.left += any(is_left(name) for name in contents(out))
        for folder in [out, *(path for path in out.iterdir() if path.is_dir())]:
            replacing.recover(folder)
        state = trial.state(contents(out))
        if state == "old":
            self.old += 1
        elif state == "new":
            self.new += 1
        else:
            self.others.append(state)


def command(writer: Writer, *arguments: object) -> list[str]:
    """Returns the command line that runs a writer in a process of its own."""
    words = [name_of(writer), *map(str, arguments)]
    return [*blender(), *words] if writer.is_blenders else [sys.executable, _PROGRAM, *words]


def blender(*options: str) -> list[str]:
    """Returns the command line that runs writers.py in a Blender."""
    script = ["--python-exit-code", "1", "--python", _PROGRAM, "--"]
    return ["blender", "--background", *options, *script]


def name_of(writer: Writer) -> str:
    """Returns the name of a writer in writers.py."""
    return f"{writer.kind}:{writer.name}"


def run(words: list[str], **variables: str) -> subprocess.CompletedProcess[str]:
    """Runs a program with more variables in its environment."""
    environment = {**os.environ, **variables}
    return subprocess.run(words, capture_output=True, text=True, env=environment, check=False)


def at_calls(trial: Trial, place: Path, library: Path) -> Found:
    """Kills a writer at its first call that changes names, at the second, and so on."""
    found = Found()
    for number in itertools.count(1):
        with tempfile.TemporaryDirectory(dir=place) as name:
            out = Path(name)
            trial.prepare(out)
            plan = {"LD_PRELOAD": str(library), "PREFILTER_KILL_IN": name}
            done = run(
                command(trial.writer, trial.sources, out), **plan, PREFILTER_KILL_AT=str(number)
            )
            if done.returncode == 0:
                return found
            if abs(done.returncode) not in (signal.SIGKILL, 128 + signal.SIGKILL):
                raise OSError(f"status {done.returncode}: {done.stderr[-500:]}")
            found.add(trial, out)
    raise AssertionError


def at_random(
    trial: Trial, place: Path, count: int, chance: random.Random, begin: Begin | None = None
) -> Found:
    """Kills a writer that runs again and again.

    Args:
        trial: The writer.
        place: Where folders are made.
        count: How many kills.
        chance: The generator of random moments.
        begin: Starts it; as a program of its own if None.
    """
    begin = begin or begin_program
    found = Found()
    span = _seconds(trial, place, begin)
    for _ in range(count):
        with tempfile.TemporaryDirectory(dir=place) as name:
            out = Path(name)
            trial.prepare(out)
            running = begin(trial, out)
            running.wait_for_begin()
            time.sleep(chance.uniform(0, 2 * span))
            running.kill()
            found.add(trial, out)
    return found


def _seconds(trial: Trial, place: Path, begin: Begin) -> float:
    """Returns how long one of several runs in a row takes."""
    with tempfile.TemporaryDirectory(dir=place) as name:
        out = Path(name)
        trial.prepare(out)
        running = begin(trial, out)
        running.wait_for_begin()
        began = time.monotonic()
        running.wait_for_begin()
        taken = time.monotonic() - began
        running.kill()
    return taken


class Running:
    """A writer that runs again and again, and prints a line at each start."""

    def __init__(self, number: int, said: IO[str], wait: Callable[[], object]) -> None:
        """Takes the process's number, its output, and a function that waits for its end."""
        self._number, self._said, self._wait = number, said, wait

    def wait_for_begin(self) -> None:
        """Waits until it begins; raises OSError where it has ended."""
        for line in self._said:
            if line.strip() == "begins":
                return
        raise OSError("the writer has ended")

    def kill(self) -> None:
        """Kills it."""
        os.kill(self._number, signal.SIGKILL)
        self._wait()


def begin_program(trial: Trial, out: Path) -> Running:
    """Starts a writer in a program of its own."""
    process = subprocess.Popen(
        command(trial.writer, trial.sources, out, writers.MANY),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    said = process.stdout

    def wait() -> None:
        process.wait()
        said.close()

    return Running(process.pid, said, wait)


def begin_copy(trial: Trial, out: Path) -> Running:
    """Starts a writer in a copy of this process, which must not have used threads."""
    reads, writes = os.pipe()
    child = os.fork()
    if not child:
        os.close(reads)  # So that it ends with this process.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        try:
            while os.write(writes, b"begins\n"):
                trial.writer.run(trial.sources, out)
        finally:
            os._exit(1)
    os.close(writes)
    said = os.fdopen(reads)

    def wait() -> None:
        os.waitpid(child, 0)
        said.close()

    return Running(child, said, wait)


class Copies:
    """A Blender that has one thread, and runs writers in copies of itself."""

    def __init__(self) -> None:
        """Starts it."""
        self._program = subprocess.Popen(
            [*blender("--threads", "1"), "copies"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )

    def begin(self, trial: Trial, out: Path) -> Running:
        """Starts a writer."""
        asks, says = self._program.stdin, self._program.stdout
        assert asks is not None
        assert says is not None
        asks.write("\t".join([name_of(trial.writer), str(trial.sources), str(out)]) + "\n")
        asks.flush()
        number = next(line for line in says if line.startswith("number ")).split()[1]
        return Running(int(number), says, lambda: next(x for x in says if x == "ended\n"))


@functools.cache
def the_blender() -> Copies:
    """Starts it once."""
    return Copies()


def begin_quickly(writer: Writer) -> Begin:
    """Returns a function that starts a writer, whose imports are done once in advance."""
    if writer.is_blenders:
        return the_blender().begin
    import prefilter
    from prefilter.commands import program

    with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()):
        program.make_parser()
    for name in prefilter.__all__:
        getattr(prefilter, name)
    return begin_copy


class Apart(Trial):
    """A trial whose first run, too, is in a process of its own: no thread is left in this one."""

    def first_status(self, out: Path) -> int:
        """Runs it once."""
        return run(command(self.writer, self.sources, out)).returncode

    def is_whole(self, name: str, data: bytes) -> bool:
        """Reads it in a copy of this process."""
        child = os.fork()
        if not child:
            os._exit(0 if super().is_whole(name, data) else 1)
        return not os.waitpid(child, 0)[1]


def main() -> None:
    """Kills every writer."""
    parser = argparse.ArgumentParser()
    parser.add_argument("way", choices=("calls", "random"))
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--count", type=int, default=10)
    report.add_json_option(parser)
    options = parser.parse_args()
    if options.way == "calls" and not LIBRARY.exists():
        raise SystemExit(f"{LIBRARY} is to be built first")
    chance, told, rows = random.Random(1), report.Report(), []
    kills, bad = 0, 0
    with tempfile.TemporaryDirectory() as name:
        sources, place = Path(name) / "sources", Path(name)
        sources.mkdir()
        writers.make_sources(sources)
        has_blender = shutil.which("blender") is not None and not run(scene(sources)).returncode
        kinds = ("package", "command", *(("blender",) if has_blender else ()))
        for writer in writers.chosen(options.pattern, kinds, sources, told):
            trial = Apart(writer, sources, place)
            if options.way == "calls":
                found = at_calls(trial, place, LIBRARY)
            else:
                begin = begin_quickly(writer)
                found = at_random(trial, place, options.count, chance, begin)
            cells = [found.count, found.old, found.new, found.left, len(found.others)]
            rows.append([f"{writer.kind}: {writer.name}", *map(str, cells)])
            print("  ".join(rows[-1]), *sorted(set(found.others))[:5], flush=True)
            kills += found.count
            bad += len(found.others)
    head = ["Writer", "Kills", "Old files", "New files", "Names until the next run", "Others"]
    told.table("After kills", head, rows, options.way)
    told.verdict(not bad, f"{kills} kills: the old files or the new ones, and nothing else")
    told.finish(options.json)


def scene(sources: Path) -> list[str]:
    """Returns the command line that makes the scene."""
    return [*blender(), "scene", str(sources)]


if __name__ == "__main__":
    main()
