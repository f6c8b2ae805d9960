# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter from a picture file to a mip-mapped file, all of it timed."""

import sys
from pathlib import Path

from . import Measurement, run

ROOT = Path(__file__).resolve().parents[2]
IN_CPP = ROOT / "build/bench/prefilter_bake_file"
IN_PYTHON = ROOT / "bench/textures/bake_file.py"


class FileToFile:
    """A small program around the library, a process of its own each time."""

    def __init__(
        self, picture: Path, folder: Path, *, filter: str, threads: int, python: bool = False
    ) -> None:
        """Reads `picture` and the mesh of `folder`, and writes into it.

        With `python` it is the program around the Python package, else the one around the C++
        library.
        """
        self.name = f"prefilter {filter}" + (", Python" if python else "")
        self._target = folder / f"{filter}.tif"
        program = [sys.executable, str(IN_PYTHON)] if python else [str(IN_CPP)]
        mesh = folder / ("mesh.npz" if python else "mesh.bin")
        arguments = [picture, mesh, self._target, filter, threads]
        self._command = [*program, *map(str, arguments)]

    def measure(self) -> Measurement:
        """See `Peer`."""
        self._target.unlink(missing_ok=True)
        seconds, peak, _ = run(self._command)
        if not self._target.exists():
            raise OSError(f"prefilter wrote no '{self._target}'")
        return Measurement(seconds, peak)
