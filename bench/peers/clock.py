# SPDX-License-Identifier: GPL-3.0-or-later

"""CPU time, wall time and memory of one piece of work alone, in a new process.

`clocked` is for the process that works, `run_clocked` for the one that started it. Neither holds
pixels or meshes: see this package's docstring.
"""

import json
import os
import re
import resource
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

MARK = "CLOCKED "


def clocked(work: Callable[[], Any]) -> Any:
    """Does the work and prints its time and memory; returns the work's result.

    CPU time is of all threads of the process.
    """
    Path("/proc/self/clear_refs").write_text("5")  # Forgets the peak of loading.
    start = status("VmRSS")
    began, cpu_began = time.perf_counter(), cpu_seconds()
    made = work()
    seconds, cpu = time.perf_counter() - began, cpu_seconds() - cpu_began
    found = {
        "seconds": seconds,
        "cpu_seconds": cpu,
        "peak_mib": status("VmHWM"),
        "start_mib": start,
    }
    print(MARK + json.dumps(found), flush=True)
    return made


def cpu_seconds() -> float:
    """Returns the processor time used so far, in user and in system mode."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def status(field: str) -> float:
    """Returns a field of /proc/self/status in MiB."""
    text = Path("/proc/self/status").read_text()
    return int(re.search(rf"^{field}:\s*(\d+) kB", text, re.MULTILINE)[1]) / 1024


def pinned(command: Sequence[str], threads: int) -> list[str]:
    """Returns the command, bound to as many processors, which limits TBB to as many threads."""
    processors = sorted(os.sched_getaffinity(0))[:threads]
    return ["taskset", "--cpu-list", ",".join(map(str, processors)), *command]


def run_clocked(
    command: Sequence[str], environment: Mapping[str, str] | None = None
) -> "Measurement":
    """Runs a program that calls `clocked` once, with these variables besides ours."""
    _, printed = run_measured(command, environment)
    lines = [line for line in printed.splitlines() if line.startswith(MARK)]
    if len(lines) != 1:
        raise OSError(f"'{' '.join(command)}' told no time: {printed}")
    return Measurement(**json.loads(lines[0].removeprefix(MARK)))


if __package__:
    from . import Measurement, run_measured
