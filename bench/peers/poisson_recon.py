# SPDX-License-Identifier: GPL-3.0-or-later

"""PoissonRecon by Kazhdan: a file of points to a file of triangles, all of it timed."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

from . import Measurement, run_measured
from .clock import pinned

VARIABLE = "PREFILTER_POISSONRECON"
TRIMMER = "PREFILTER_SURFACETRIMMER"
IDLE_SLEEPS = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "0"}


class PoissonRecon:
    """The program with its defaults except the depth and one thread."""

    name = "PoissonRecon"

    def __init__(
        self, points: Path, target: Path, depth: int, *, trimmed: float | None = None
    ) -> None:
        """Reads a PLY with normals, and writes one.

        Args:
            points: The file of points.
            target: The file of triangles.
            depth: The depth of the octree.
            trimmed: SurfaceTrimmer cuts off the parts sampled by this many levels more coarsely
                than half of the vertices; None leaves the surface closed.
        """
        program = os.environ[VARIABLE]
        arguments = ["--in", str(points), "--out", str(target), "--depth", str(depth)]
        self._command = pinned([program, *arguments, "--parallel", "2"], threads=1)
        self._target, self._trimmed = target, trimmed
        if trimmed is not None:
            self._command.append("--density")

    @staticmethod
    def missing(*, trimmed: bool = False) -> str:
        """Returns the missing requirement; empty if there is none."""
        for variable in (VARIABLE, TRIMMER) if trimmed else (VARIABLE,):
            if not Path(os.environ.get(variable) or os.devnull).is_file():
                return f"{variable}, the path of the built program"
        return ""

    def measure(self) -> Measurement:
        """See `Peer`."""
        found, _ = run_measured(self._command, IDLE_SLEEPS)
        if self._trimmed is None:
            return found
        level = float(self._median_density()) - self._trimmed
        files = ["--in", str(self._target), "--out", str(self._target)]
        command = [os.environ[TRIMMER], *files, "--trim", f"{level:.3f}"]
        more, _ = run_measured(pinned(command, threads=1), IDLE_SLEEPS)
        return dataclasses.replace(
            found,
            seconds=found.seconds + more.seconds,
            cpu_seconds=found.cpu_seconds + more.cpu_seconds,
            peak_mib=max(found.peak_mib, more.peak_mib),
        )

    def _median_density(self) -> str:
        """Asks a separate process, because this one's memory would count as the programs'."""
        code = (
            "import sys; import numpy as np; from pathlib import Path; "
            "from bench.points.ply import vertex_values; "
            "print(np.median(vertex_values(Path(sys.argv[1]), 'value')))"
        )
        command = [sys.executable, "-c", code, str(self._target)]
        root = Path(__file__).resolve().parents[2]
        made = subprocess.run(command, cwd=root, check=True, stdout=subprocess.PIPE, text=True)
        return made.stdout
