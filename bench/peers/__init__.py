# SPDX-License-Identifier: GPL-3.0-or-later

"""The programs that the benchmarks run, each behind one interface: ours and others'.

One file a peer; to add one, write a class with the members of `Peer`. Nothing here imports numpy or
holds pixels: a program inherits the peak memory of its parent process, which therefore
has to stay small.
"""

import os
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Measurement:
    """One run.

    Attributes:
        seconds: Wall time.
        peak_mib: Peak resident memory of the whole process [MiB].
        start_mib: Resident memory when the clock was started.
        cpu_seconds: CPU time of all threads, where it was measured.
    """

    seconds: float
    peak_mib: float
    start_mib: float = 0.0
    cpu_seconds: float = 0.0


class Peer(Protocol):
    """Work that can be measured again and again."""

    name: str

    def measure(self) -> Measurement:
        """Does the work once, in a new process.

        Raises:
            OSError: The program is missing or failed.
        """
        ...


def run(command: Sequence[str]) -> tuple[float, float, str]:
    """Runs a program; returns its wall time [s], its peak memory [MiB] and its output."""
    found, printed = run_measured(command)
    return found.seconds, found.peak_mib, printed


def run_measured(
    command: Sequence[str], environment: Mapping[str, str] | None = None
) -> tuple[Measurement, str]:
    """Runs a program with these variables besides ours; returns its measurement and output.

    Raises:
        OSError: The program is missing or failed.
    """
    variables = {**os.environ, **(environment or {})}
    began = time.perf_counter()
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, env=variables
    )
    with process.stdout as stream:
        printed = stream.read()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - began
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise OSError(f"'{' '.join(command)}' ended with status {process.returncode}: {printed}")
    cpu = usage.ru_utime + usage.ru_stime
    return Measurement(seconds, usage.ru_maxrss / 1024, cpu_seconds=cpu), printed
