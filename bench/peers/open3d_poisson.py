# SPDX-License-Identifier: GPL-3.0-or-later

"""Open3D's screened Poisson: a file of points to a file of triangles, imports not counted.

Run as a program, it does the work once and prints what `clock` does.
usage: open3d_poisson.py POINTS.ply TARGET.ply DEPTH
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

VARIABLE = "PREFILTER_OPEN3D_PYTHON"


class Open3d:
    """`create_from_point_cloud_poisson` with its defaults except the depth and one thread."""

    name = "Open3D"

    def __init__(self, points: Path, target: Path, depth: int) -> None:
        """Reads a PLY with normals, and writes one."""
        command = [interpreter(VARIABLE), __file__, str(points), str(target), str(depth)]
        self._command = pinned(command, threads=1)

    @staticmethod
    def missing() -> str:
        """Returns the missing requirement; empty if there is none."""
        if can_import(VARIABLE, "open3d"):
            return ""
        return f"Open3D, python3-open3d in Debian; {VARIABLE} names another Python that has it"

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command, {"OMP_NUM_THREADS": "1"})


def poisson(points: str, target: str, depth: int) -> Callable[[], Any]:
    """Returns the work."""
    import open3d

    def work() -> Any:
        cloud = open3d.io.read_point_cloud(points)
        surface = open3d.geometry.TriangleMesh
        mesh, _ = surface.create_from_point_cloud_poisson(cloud, depth=depth, n_threads=1)
        if not open3d.io.write_triangle_mesh(target, mesh, write_vertex_normals=False):
            raise OSError(f"Open3D wrote no '{target}'")
        return len(mesh.triangles)

    return work


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
    from .interpreters import can_import, interpreter
else:
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    from clock import clocked

    print(clocked(poisson(sys.argv[1], sys.argv[2], int(sys.argv[3]))), "triangles")
