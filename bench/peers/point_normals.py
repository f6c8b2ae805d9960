# SPDX-License-Identifier: GPL-3.0-or-later

"""Normals of points by our own function and by Open3D's, timed alone.

Run as a program, it does the work once and prints what `clock` does.
usage: point_normals.py prefilter|open3d POINTS.npy NORMALS.npy NEIGHBORS
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

VARIABLE = "PREFILTER_OPEN3D_PYTHON"


class PointNormals:
    """A library's estimate and its orientation, on one thread."""

    def __init__(self, library: str, points: Path, normals: Path, neighbors: int) -> None:
        """Reads an array of points, and writes one of normals."""
        self.name = library
        python = sys.executable if library == "prefilter" else interpreter(VARIABLE)
        command = [python, __file__, library, str(points), str(normals), str(neighbors)]
        self._command = pinned(command, threads=1)

    @staticmethod
    def missing() -> str:
        """Returns Open3D's missing requirement; empty if there is none."""
        if can_import(VARIABLE, "open3d"):
            return ""
        return f"Open3D, python3-open3d in Debian; {VARIABLE} names another Python that has it"

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command, {"OMP_NUM_THREADS": "1"})


def _prefilter(points: Any, neighbors: int) -> Callable[[], Any]:
    import prefilter

    return lambda: prefilter.estimate_normals(points, neighbours=neighbors, threads=1)


def _open3d(points: Any, neighbors: int) -> Callable[[], Any]:
    """Open3D's normals, oriented with as many neighbors as the planes use."""
    import numpy as np
    import open3d

    def work() -> Any:
        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
        cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(neighbors))
        cloud.orient_normals_consistent_tangent_plane(neighbors)
        return np.asarray(cloud.normals)

    return work


LIBRARIES = {"prefilter": _prefilter, "open3d": _open3d}


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
    from .interpreters import can_import, interpreter
else:
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    import numpy as np
    from clock import clocked

    library, source, target, count = sys.argv[1:]
    np.save(target, clocked(LIBRARIES[library](np.load(source), int(count))))
