# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter: points to triangles by wavelets, from file to file or in memory.

Run as a program, it does the work once and prints what `clock` does.
usage: wavelets.py POINTS.ply TARGET.ply DEPTH files|memory THREADS OPTIONS
OPTIONS are keywords of `prefilter.reconstruct`, as JSON.
"""

import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any


class Wavelets:
    """`prefilter.reconstruct_file`, or `prefilter.reconstruct` between reading and writing.

    In memory neither reading nor writing is in the clock: it is for the memory that the library
    takes beyond its input.
    """

    def __init__(
        self,
        points: Path,
        target: Path,
        depth: int,
        options: Mapping[str, Any],
        *,
        name: str,
        in_memory: bool = False,
        threads: int = 1,
    ) -> None:
        """Reads a PLY with normals, and writes one; `options` are keywords of the function."""
        self.name = name
        words = ["memory" if in_memory else "files", str(threads), json.dumps(dict(options))]
        command = [sys.executable, __file__, str(points), str(target), str(depth), *words]
        self._command = pinned(command, threads)

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command)


def from_file(points: str, target: str, keywords: Mapping[str, Any]) -> Callable[[], Any]:
    """Returns the work, with reading and writing."""
    from prefilter import reconstruct_file

    return lambda: reconstruct_file(points, target, **keywords)


def in_memory(points: str, keywords: Mapping[str, Any]) -> Callable[[], Any]:
    """Returns the work alone."""
    import numpy as np
    from prefilter import reconstruct

    from bench.points import ply

    cloud, normals = (np.ascontiguousarray(part) for part in ply.read_points(Path(points)))
    return lambda: reconstruct(cloud, normals, **keywords)


def main() -> None:
    """Does the work once."""
    points, target, depth, where, threads, options = sys.argv[1:]
    keywords = {**json.loads(options), "depth": int(depth), "threads": int(threads)}
    if where == "files":
        clocked(from_file(points, target, keywords))
        return
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    made = clocked(in_memory(points, keywords))
    from bench.points import ply

    ply.write_mesh(Path(target), made[0], made[1])


if __package__:
    from . import Measurement
    from .clock import pinned, run_clocked
else:
    from clock import clocked

    main()
