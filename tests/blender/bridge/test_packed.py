# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of packed images, written beside the .blend file."""

import bpy
import cycles_scenes as cycles
import numpy as np
import pytest
import scenes
from cycles_scenes import packed_picture, smooth, udim


def test_packed_bytes_are_written_beside_the_blend(addon, tmp_path):
    unpack = addon("bridge.packed").unpack
    first, data = packed_picture(tmp_path, "leaf.png", smooth(16, 16, 4))
    first.name, first.alpha_mode = "Leaf", "CHANNEL_PACKED"
    first.colorspace_settings.name = "Non-Color"
    before = scenes.pixels("Leaf")
    with pytest.raises(OSError, match=r"'Leaf' is packed; save the \.blend file first"):
        unpack(first)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    folder = tmp_path / "textures"
    folder.mkdir()
    (folder / "Leaf.png").write_bytes(b"of another")
    assert unpack(first) == [folder / "Leaf.001.png"]
    assert (folder / "Leaf.001.png").read_bytes() == data
    assert (folder / "Leaf.png").read_bytes() == b"of another"
    assert first.packed_file is None
    assert first.filepath == "//textures/Leaf.001.png"
    assert (first.alpha_mode, first.colorspace_settings.name) == ("CHANNEL_PACKED", "Non-Color")
    np.testing.assert_array_equal(scenes.pixels("Leaf"), before)
    # The same bytes are not written twice.
    first.pack()
    assert unpack(first) == [folder / "Leaf.001.png"]
    assert sorted(path.name for path in folder.iterdir()) == ["Leaf.001.png", "Leaf.png"]


@pytest.mark.parametrize(
    ("ending", "kind"), [(".png", "uint8"), (".exr", "half"), (".tif", "uint8"), (".jpg", "uint8")]
)
def test_extensions_match_the_packed_data(addon, tmp_path, ending, kind):
    image = cycles.write_picture(tmp_path / f"paint{ending}", smooth(16, 16, 3), kind)
    image.pack()
    image.name, image.filepath = "A b.png", ""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert addon("bridge.packed").unpack(image) == [tmp_path / "textures" / f"A_b{ending}"]


def test_packed_tiles_are_unpacked(addon, tmp_path):
    image = udim(tmp_path)
    image.name = "Skin"
    image.pack()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    names = [path.name for path in addon("bridge.packed").unpack(image)]
    assert names == ["Skin.1001.exr", "Skin.1002.exr"]
    assert image.filepath == "//textures/Skin.<UDIM>.exr"
    for number in (1001, 1002):
        data = (tmp_path / "textures" / f"Skin.{number}.exr").read_bytes()
        assert data == (tmp_path / f"paint.{number}.exr").read_bytes()
