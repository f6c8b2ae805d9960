# SPDX-License-Identifier: GPL-3.0-or-later

"""The levels that OpenImageIO's maketx makes of an image."""

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

Texels = NDArray[np.float32]

WRAP_NAMES = {"repeat": "periodic", "clamp": "clamp", "border": "black"}


def is_available() -> bool:
    """Returns whether there is a maketx to run."""
    return shutil.which("maketx") is not None


def levels(image: Texels, *, filter: str, wrap: str, sharpen: float = 0.0) -> list[Texels]:
    """Returns all levels, level 0 first, row 0 at the bottom, in floats as maketx writes them.

    `sharpen` is what its option of that name takes; 0 for none.

    Raises:
        OSError: maketx failed, or wrote something else than the levels of this image.
    """
    with tempfile.TemporaryDirectory() as name:
        source, target = Path(name) / "image.tif", Path(name) / "image.tx"
        # Rows of files are from the top.
        picture = oiio.ImageBuf(np.ascontiguousarray(image[::-1]))
        picture.specmod().attribute("compression", "none")
        if not picture.write(str(source), "float"):
            raise OSError(picture.geterror())
        command = ["maketx", "--filter", filter, "--wrap", WRAP_NAMES[wrap], "-d", "float"]
        command += ["--compression", "none"]
        if sharpen:
            command += ["--sharpen", str(sharpen)]
        subprocess.run([*command, "-o", str(target), str(source)], check=True)
        made = _read(target)
    if not np.array_equal(made[0], image):
        raise OSError("maketx: level 0 is not the image")
    return made


def _read(path: Path) -> list[Texels]:
    """Reads all levels of a file."""
    file = oiio.ImageInput.open(str(path))
    if file is None:
        raise OSError(oiio.geterror())
    made: list[Texels] = []
    while file.seek_subimage(0, len(made)):
        pixels = file.read_image(0, len(made), 0, file.spec().nchannels, "float")
        if pixels is None:
            raise OSError(file.geterror())
        made.append(np.ascontiguousarray(pixels[::-1]))
    file.close()
    return made
