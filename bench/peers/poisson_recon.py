# SPDX-License-Identifier: GPL-3.0-or-later

"""PoissonRecon by Kazhdan: a file of points to a file of triangles, all in the clock."""

import os
from pathlib import Path

from . import Measurement, run_measured
from .clock import pinned

VARIABLE = "PREFILTER_POISSONRECON"
IDLE_SLEEPS = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "0"}


class PoissonRecon:
    """The program with its defaults but for the depth and one thread."""

    name = "PoissonRecon"

    def __init__(self, points: Path, target: Path, depth: int) -> None:
        """Reads a PLY with normals, and writes one."""
        program = os.environ[VARIABLE]
        arguments = ["--in", str(points), "--out", str(target), "--depth", str(depth)]
        self._command = pinned([program, *arguments, "--parallel", "2"], threads=1)

    @staticmethod
    def missing() -> str:
        """Returns what is needed and is not there; nothing where all is."""
        found = Path(os.environ.get(VARIABLE) or os.devnull).is_file()
        return "" if found else f"{VARIABLE}, the path of the built program"

    def measure(self) -> Measurement:
        """See `Peer`."""
        found, _ = run_measured(self._command, IDLE_SLEEPS)
        return found
