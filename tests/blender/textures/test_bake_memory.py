# SPDX-License-Identifier: GPL-3.0-or-later

"""Peak memory of the bake of a large image, in addition to Blender's."""

import re
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest
import scenes

SIDE = 2048
FORGET_PEAK = Path("/proc/self/clear_refs")


def status(field):
    """Returns a field of /proc/self/status in bytes."""
    text = Path("/proc/self/status").read_text()
    return 1024 * int(re.search(rf"^{field}:\s*(\d+) kB", text, re.MULTILINE)[1])


def picture(path):
    texels = np.random.default_rng(1).integers(0, 256, (SIDE, SIDE, 3), np.uint8)
    assert oiio.ImageBuf(texels).write(str(path))
    del texels
    return bpy.data.images.load(str(path))


@pytest.mark.skipif(not FORGET_PEAK.exists(), reason="Linux tells how much memory was used")
def test_a_file_takes_a_few_times_the_texels(bake, tmp_path):
    image = picture(tmp_path / "picture.png")
    quad = scenes.textured_quad(image)
    # The first bake loads libraries.
    bake(image, [quad], filepath=str(tmp_path / "out.exr"), use_images=False)
    FORGET_PEAK.write_text("5")
    before = status("VmRSS")
    bake(image, [quad], filepath=str(tmp_path / "out.exr"), use_images=False)
    # Three bytes of a texel, sixteen of the floats that Blender gives out of its own four, and a
    # system with 25 floats for each texel of level 1 and a third more for all others.
    assert (status("VmHWM") - before) / SIDE**2 < 50


def test_unloaded_pixels_are_freed(bake, tmp_path):
    image = picture(tmp_path / "picture.png")
    quad = scenes.textured_quad(image)
    assert not image.has_data
    bake(image, [quad], filepath=str(tmp_path / "out.exr"), use_images=False)
    assert not image.has_data
    assert tuple(image.size) == (SIDE, SIDE)
    assert image.has_data
    bake(image, [quad], filter="box", filepath=str(tmp_path / "out.exr"), use_images=False)
    assert image.has_data


def test_changed_pixels_stay(bake, tmp_path):
    image = picture(tmp_path / "picture.png")
    quad = scenes.textured_quad(image)
    image.pixels[0] = 1.0
    bake(image, [quad], filter="box", filepath=str(tmp_path / "out.exr"), use_images=False)
    assert image.is_dirty
    assert image.pixels[0] == 1.0
