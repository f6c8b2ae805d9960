# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter: a mesh in memory to an octree in memory, or on to the surface of it.

Run as a program, it does the work once and prints what `clock` does.
usage: octree.py MESH.npz LOW_X LOW_Y LOW_Z SIDE DEPTH THREADS [INTERPOLANT]
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any


class Octree:
    """`prefilter.voxelize`, and `Octree.contour` with an interpolant."""

    def __init__(
        self,
        mesh: Path,
        low: Sequence[float],
        side: float,
        depth: int,
        *,
        interpolant: str = "",
        threads: int = 1,
    ) -> None:
        """`mesh` holds positions and triangles; `low` and `side` place the root."""
        self.name = f"prefilter voxelize{' + contour ' + interpolant if interpolant else ''}"
        numbers = [*map(repr, map(float, (*low, side))), str(depth), str(threads)]
        command = [sys.executable, __file__, str(mesh), *numbers]
        self._command = pinned(command + ([interpolant] if interpolant else []), threads)

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command)


def work_on(mesh: Path, arguments: Sequence[str]) -> Callable[[], Any]:
    """Returns the work."""
    import numpy as np
    import prefilter

    loaded = dict(np.load(mesh))
    low, side = np.array(arguments[:3], float), float(arguments[3])
    depth, threads = int(arguments[4]), int(arguments[5])
    bounds = (low, low + side)

    def work() -> Any:
        octree = prefilter.voxelize(**loaded, depth=depth, bounds=bounds, threads=threads)
        if len(arguments) < 7:
            return octree.nbytes
        return octree.contour(interpolant=arguments[6], cleanup=False, threads=threads)

    return work


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
else:
    from clock import clocked

    made = clocked(work_on(Path(sys.argv[1]), sys.argv[2:]))
    print(f"{made / 2**20:.0f} MiB" if isinstance(made, int) else f"{len(made[1])} triangles")
