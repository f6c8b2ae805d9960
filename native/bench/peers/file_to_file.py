"""Prefilter from a picture file to a mip-mapped file, all in the clock."""

import sys
from pathlib import Path

from . import Measurement, run

PROGRAM = Path(__file__).resolve().parents[1] / "bake_file.py"


class FileToFile:
    """bake_file.py, a process of its own each time, Python's start included."""

    def __init__(self, picture: Path, folder: Path, *, filter: str, threads: int) -> None:
        """Reads `picture` and mesh.npz of `folder`, and writes into it."""
        self.name = f"prefilter {filter}"
        self._target = folder / f"{filter}.tif"
        self._command = [sys.executable, str(PROGRAM), str(picture), str(folder / "mesh.npz")]
        self._command += [str(self._target), filter, str(threads)]

    def measure(self) -> Measurement:
        """See `Peer`."""
        self._target.unlink(missing_ok=True)
        seconds, peak, _ = run(self._command)
        if not self._target.exists():
            raise OSError(f"prefilter wrote no '{self._target}'")
        return Measurement(seconds, peak)
