# SPDX-License-Identifier: GPL-3.0-or-later

"""The package's commands `resize` and `resample` write the same bytes as Blender's commands."""

import re

import numpy as np
import OpenImageIO as oiio
import pytest
from command_line import run
from prefilter.commands import program

CORNERS = ("0.1", "0", "1", "0.1", "0.9", "0.9", "0", "1")


def without_time(path):
    """Returns the bytes of a file, without the time that OpenImageIO puts into it."""
    return re.sub(rb"\d{4}:\d\d:\d\d \d\d:\d\d:\d\d", b"", path.read_bytes())


@pytest.fixture(params=["photo.png", "gray.png", "light.exr"])
def photo(tmp_path, request):
    """Writes a picture with alpha, one without color, and one of floats."""
    channels = 1 if request.param.startswith("gray") else 4
    values = np.random.default_rng(3).random((18, 24, channels), np.float32)
    if request.param.endswith(".png"):
        values = np.rint(values * 255).astype(np.uint8)
    spec = oiio.ImageSpec(24, 18, channels, str(values.dtype))
    if request.param.endswith(".png"):
        spec.attribute("oiio:UnassociatedAlpha", 1)
    path = tmp_path / request.param
    writer = oiio.ImageOutput.create(str(path))
    assert writer.open(str(path), spec)
    assert writer.write_image(values)
    writer.close()
    return path


@pytest.mark.parametrize("ending", ["png", "exr"])
@pytest.mark.parametrize(
    "arguments",
    [
        ("resize", "--percent", "40"),
        ("resize", "--width", "31", "--filter", "least-squares", "--wrap", "repeat"),
        ("resize", "--height", "9", "--data"),
        ("resample", "--rotate", "30", "--scale", "0.5"),
        (
            "resample",
            "--size",
            "image",
            "--corners",
            *["0.1", "0", "1", "0.1", "0.9", "0.9", "0", "1"],
        ),
    ],
    ids=" ".join,
)
def test_same_bytes(photo, tmp_path, arguments, ending):
    name, *flags = arguments
    ours, theirs = tmp_path / f"ours.{ending}", tmp_path / f"theirs.{ending}"
    assert program.main([name, str(photo), str(ours), *flags]) == 0
    result = run(name, photo, theirs, *flags)
    assert result.returncode == 0, result.stderr
    assert without_time(ours) == without_time(theirs)
