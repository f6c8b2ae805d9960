# SPDX-License-Identifier: GPL-3.0-or-later

"""Image in memory to levels in memory, timed alone, in a new Python each time.

Run as a program, it does the work once and prints what `clock` does.
usage: in_memory.py prefilter|openimageio FOLDER FILTER THREADS
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any


class InMemory:
    """A library's function on the picture and the mesh that `scene.py` left in a folder."""

    def __init__(self, library: str, folder: Path, *, filter: str, threads: int) -> None:
        """`library` is a key of `_LIBRARIES`."""
        self.name = f"{library} {filter}, in memory"
        self._command = [sys.executable, __file__, library, str(folder), filter, str(threads)]

    def measure(self) -> "Measurement":
        """See `Peer`."""
        return run_clocked(self._command)


def _prefilter(folder: Path, filter: str, threads: int) -> Callable[[], Any]:
    """Triangles and an image -> levels down to 1 x 1, in scene-linear floats."""
    import numpy as np
    import prefilter

    image = np.load(folder / "linear.npy")
    mesh = dict(np.load(folder / "mesh.npz"))

    def work() -> Any:
        surface = prefilter.Surface(**mesh)
        return prefilter.mipmaps(image, surface, filter=filter, threads=threads)

    return work


def _openimageio(folder: Path, filter: str, threads: int) -> Callable[[], Any]:
    """Each level from the one before, as maketx does it, in floats."""
    import numpy as np
    import OpenImageIO as oiio

    pixels = np.load(folder / "linear.npy")
    height, width, channels = pixels.shape
    image = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, "float"))
    image.set_pixels(oiio.ROI(), pixels)

    def work() -> Any:
        levels = [image]
        while (size := (levels[-1].spec().width, levels[-1].spec().height)) != (1, 1):
            roi = oiio.ROI(0, max(1, size[0] // 2), 0, max(1, size[1] // 2), 0, 1, 0, channels)
            level = oiio.ImageBufAlgo.resize(levels[-1], filter, 0.0, roi, threads)
            if level.has_error:
                raise OSError(level.geterror())
            levels.append(level)
        return levels

    return work


_LIBRARIES = {"prefilter": _prefilter, "openimageio": _openimageio}


if __package__:
    from . import Measurement
    from .clock import run_clocked
else:
    from clock import clocked

    library, folder, filter, threads = sys.argv[1:]
    clocked(_LIBRARIES[library](Path(folder), filter, int(threads)))
