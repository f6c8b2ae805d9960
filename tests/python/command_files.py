# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures and meshes as files, for tests of the command."""

from pathlib import Path

import numpy as np
import pytest
from prefilter.commands import program


def run(*arguments: object) -> int:
    """Runs the command in this process."""
    return program.main([str(argument) for argument in arguments])


def fails(capsys: pytest.CaptureFixture[str], status: int, *arguments: object) -> str:
    """Runs a command that must fail with `status`; returns its single error line."""
    capsys.readouterr()
    assert run(*arguments) == status
    told = capsys.readouterr().err
    assert "Traceback" not in told
    last = told.strip().splitlines()[-1]
    assert "error: " in last
    return last


def noise(height: int, width: int, channels: int = 3, seed: int = 1) -> np.ndarray:
    """Returns bytes, rows from the top."""
    return np.random.default_rng(seed).integers(0, 256, (height, width, channels), np.uint8)


def write_picture(path: Path, pixels: np.ndarray, *, is_straight: bool = True) -> Path:
    """Writes pixels, rows from the top, without conversion."""
    oiio = pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, str(pixels.dtype).replace("float32", "float"))
    if is_straight:
        spec.attribute("oiio:UnassociatedAlpha", 1)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(pixels), output.geterror()
    output.close()
    return path


def write_quad(path: Path, *, has_uvs: bool = True) -> Path:
    """Writes a bent quad as an .obj file: its halves have different areas."""
    pytest.importorskip("trimesh", reason="scripts/decoders.txt is not installed")
    uvs = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" if has_uvs else ""
    face = "f 1/1 2/2 3/3 4/4" if has_uvs else "f 1 2 3 4"
    path.write_text(f"o Quad\nv 0 0 0\nv 3 0 0\nv 3 1 2\nv 0 1 0\n{uvs}{face}\n")
    return path
