# SPDX-License-Identifier: GPL-3.0-or-later

"""MeshLab's screened Poisson: a file of points to a file of triangles, imports not counted.

Run as a program, it does the work once and prints what `clock` does.
usage: meshlab_poisson.py POINTS.ply TARGET.ply DEPTH
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

VARIABLE = "PREFILTER_MESHLAB_PYTHON"


class MeshLab:
    """The filter of pymeshlab with its defaults except the depth and one thread."""

    name = "pymeshlab"

    def __init__(self, points: Path, target: Path, depth: int) -> None:
        """Reads a PLY with normals, and writes one."""
        command = [interpreter(VARIABLE), __file__, str(points), str(target), str(depth)]
        self._command = pinned(command, threads=1)

    @staticmethod
    def missing() -> str:
        """Returns the missing requirement; empty if there is none."""
        if can_import(VARIABLE, "pymeshlab"):
            return ""
        return f"pymeshlab of PyPI; {VARIABLE} names another Python that has it"

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command, {"OMP_NUM_THREADS": "1"})


def poisson(points: str, target: str, depth: int) -> Callable[[], Any]:
    """Returns the work."""
    import pymeshlab

    def work() -> Any:
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(points)
        meshes.generate_surface_reconstruction_screened_poisson(depth=depth, threads=1)
        meshes.save_current_mesh(
            target, save_vertex_normal=False, save_vertex_color=False, save_vertex_quality=False
        )
        return meshes.current_mesh().face_number()

    return work


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
    from .interpreters import can_import, interpreter
else:
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    from clock import clocked

    print(clocked(poisson(sys.argv[1], sys.argv[2], int(sys.argv[3]))), "triangles")
