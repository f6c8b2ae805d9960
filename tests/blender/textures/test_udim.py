# SPDX-License-Identifier: GPL-3.0-or-later

"""UDIM images: a bake of each tile, over the part of the surface that lies in it."""

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest
import scenes
from texture_readers import read_dds

LEFT = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def write_png(path, pixels):
    height, width = pixels.shape[:2]
    writer = oiio.ImageOutput.create(str(path))
    assert writer.open(str(path), oiio.ImageSpec(width, height, pixels.shape[2], "uint8"))
    assert writer.write_image(np.ascontiguousarray(pixels[::-1]))
    writer.close()


@pytest.fixture
def tiles(tmp_path):
    """Two tiles of different sizes, 1001 and 1012, side by side on one strip of four squares."""
    values = {1001: scenes.noise(8, 8, seed=2), 1012: scenes.noise(4, 16, seed=3)}
    for number, pixels in values.items():
        write_png(tmp_path / f"skin.{number}.png", pixels[..., :3])
    image = bpy.data.images.load(str(tmp_path / "skin.1001.png"))
    image.source = "TILED"
    image.filepath = str(tmp_path / "skin.<UDIM>.png")
    image.tiles.new(1012)
    image.name = "Skin"
    strip = scenes.quads("Strip", [LEFT, np.add(LEFT, (1, 1))], sizes=[1, 2])
    strip.data.materials.append(scenes.material("Skin", image))
    return image, strip, values


def reference(bake, values, name):
    """The levels of the tile as an image of its own."""
    image = scenes.image(name, values)
    quad = scenes.textured_quad(image, f"{name} quad")
    bake(image, [quad], wrap="clamp")
    return name


def test_tiles_are_baked_like_images(bake, tiles):
    image, strip, values = tiles
    outcome = bake(image, [strip])
    names = [f"Skin.1001.mip{i:02d}" for i in (1, 2, 3)] + [
        f"Skin.1012.mip{i:02d}" for i in (1, 2, 3, 4)
    ]
    assert outcome.images == names
    assert outcome.warnings == []
    for number, pixels in values.items():
        alone = reference(bake, pixels, f"Alone{number}")
        for level in (1, 2, 3):
            np.testing.assert_array_equal(
                scenes.pixels(f"Skin.{number}.mip{level:02d}"),
                scenes.pixels(f"{alone}.mip{level:02d}"),
            )
    assert len(bpy.data.images) == 1 + 7 + 2 + 7


def test_packed_tiles(bake, tiles, tmp_path):
    image, strip, values = tiles
    image.pack()
    for number in values:
        (tmp_path / f"skin.{number}.png").unlink()
    bake(image, [strip], filter="box")
    linear = scenes.to_linear(values[1012][..., :3])
    expected = scenes.to_srgb(scenes.halved(linear))
    found = scenes.pixels("Skin.1012.mip01")[..., :3]
    np.testing.assert_allclose(found, expected, atol=0.51 / 255)


@pytest.mark.parametrize("name", ["out.exr", "out.<UDIM>.exr"])
def test_a_file_a_tile(bake, tiles, tmp_path, name):
    image, strip, _ = tiles
    bake(image, [strip], filepath=str(tmp_path / name), use_images=False)
    sizes = {}
    for path in tmp_path.glob("out*"):
        spec = oiio.ImageBuf(str(path)).spec()
        sizes[path.name] = (spec.width, spec.height)
    assert sizes == {"out.1001.exr": (8, 8), "out.1012.exr": (16, 4)}


def test_files_for_engines(bake, tiles, tmp_path):
    image, strip, values = tiles
    for name in ("out.dds", "out.png"):
        bake(image, [strip], filepath=str(tmp_path / name), use_images=False)
    for number, pixels in values.items():
        file = read_dds(tmp_path / f"out.{number}.dds")
        np.testing.assert_array_equal(file.levels[0], np.rint(255 * pixels))
    found = sorted(path.name for path in tmp_path.glob("out*.png"))
    assert found == [f"out.1001.{i:02d}.png" for i in range(4)] + [
        f"out.1012.{i:02d}.png" for i in range(5)
    ]


def test_tiles_without_surface_are_left_out(bake, tiles):
    image, _, _ = tiles
    only = scenes.quads("Only", [LEFT])
    only.data.materials.append(scenes.material("Skin", image))
    outcome = bake(image, [only])
    assert outcome.warnings == ["tile 1012 is left out: no surface lies in it"]
    assert outcome.images == [f"Skin.1001.mip{i:02d}" for i in (1, 2, 3)]
    away = scenes.quads("Away", [np.add(LEFT, (5, 0))])
    away.data.materials.append(only.active_material)
    with pytest.raises(ValueError, match="no surface lies in its tiles, '1001', '1012'"):
        bake(image, [away])


def test_missing_file_leaves_nothing(bake, tiles, tmp_path):
    image, strip, _ = tiles
    (tmp_path / "skin.1012.png").unlink()
    with pytest.raises(ValueError, match=r"image 'Skin', tile 1012: there is no file '.*1012.png'"):
        bake(image, [strip], filepath=str(tmp_path / "out.exr"))
    assert [i.name for i in bpy.data.images] == ["Skin"]
    assert list(tmp_path.glob("out*")) == []


def test_failure_in_the_second_tile_leaves_nothing(bake, tiles, tmp_path):
    image, strip, _ = tiles
    folder = tmp_path / "out"
    folder.mkdir()
    blocked = folder / "out.1012.exr"
    blocked.write_bytes(b"keep")
    blocked.chmod(0o444)
    with pytest.raises(OSError, match=r"out\.1012\.exr' is read-only"):
        bake(image, [strip], filepath=str(folder / "out.exr"))
    assert [i.name for i in bpy.data.images] == ["Skin"]
    assert [path.name for path in folder.iterdir()] == ["out.1012.exr"]


def test_files_of_tiles_are_all_written_or_none(bake, addon, tiles, tmp_path, monkeypatch):
    image, strip, _ = tiles
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "out.1001.exr").write_bytes(b"before")
    staging = addon("bridge.files.staging")
    replace = staging.os.replace

    def fail_once(source, target):
        if target.name == "out.1012.exr":
            raise PermissionError("no rename")
        replace(source, target)

    monkeypatch.setattr(staging.os, "replace", fail_once)
    with pytest.raises(OSError, match="no rename"):
        bake(image, [strip], filepath=str(folder / "out.exr"))
    assert [i.name for i in bpy.data.images] == ["Skin"]
    assert [path.name for path in folder.iterdir()] == ["out.1001.exr"]
    assert (folder / "out.1001.exr").read_bytes() == b"before"


def test_the_operator_takes_tiles(tiles):
    assert bpy.ops.prefilter.bake_mipmaps(image="Skin") == {"FINISHED"}
    assert "Skin.1012.mip04" in bpy.data.images
