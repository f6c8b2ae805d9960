# SPDX-License-Identifier: GPL-3.0-or-later

"""Texture files, read back by OpenImageIO."""

import tempfile

import numpy as np
import OpenImageIO as oiio
import pytest
import scenes
from prefilter.workflows import openimageio
from prefilter.workflows.files import target_files


def written(bake, tmp_path, file_name, values, **options):
    """Bakes with a box over no surface, and returns the file's path."""
    made = scenes.image("Paint", values, **options)
    path = tmp_path / file_name
    bake(made, filter="box", use_images=False, filepath=str(path))
    return path


def read_levels(path):
    """Returns the levels of a file, rows from the bottom, with their specs."""
    reader = oiio.ImageInput.open(str(path))
    levels, specs = [], []
    while reader.seek_subimage(0, len(levels)):
        spec = reader.spec()
        pixels = reader.read_image(0, len(levels), 0, spec.nchannels, "float")
        levels.append(np.asarray(pixels).reshape(spec.height, spec.width, -1)[::-1])
        specs.append(oiio.ImageSpec(spec))
    assert not reader.seek_subimage(1, 0)
    reader.close()
    return levels, specs


@pytest.mark.parametrize("file_name", ["out.exr", "out.tif", "out.TX"])
def test_every_level_in_tiles(bake, tmp_path, file_name):
    path = written(bake, tmp_path, file_name, scenes.noise(32, 128))
    levels, specs = read_levels(path)
    sizes = [level.shape for level in levels]
    assert sizes == [(max(1, 32 >> i), 128 >> i, 3) for i in range(8)]
    assert {(spec.tile_width, spec.tile_height) for spec in specs} == {(64, 64)}
    assert specs[0].get_string_attribute("textureformat") == "Plain Texture"
    assert specs[0].get_string_attribute("wrapmodes") == "periodic,periodic"
    assert str(specs[0].format) == ("half" if file_name == "out.exr" else "uint8")


def test_tiff_keeps_encoded_bytes(bake, tmp_path):
    values = scenes.noise(16, 16)
    levels, specs = read_levels(written(bake, tmp_path, "out.tif", values))
    # OpenImageIO 3.1 has another name for it.
    space = specs[0].get_string_attribute("oiio:ColorSpace")
    assert space in {"sRGB", "srgb_rec709_scene"}
    np.testing.assert_allclose(levels[0], values[..., :3], atol=1e-6)
    linear = scenes.halved(scenes.to_linear(values[..., :3]))
    np.testing.assert_allclose(levels[1], scenes.to_srgb(linear), atol=0.51 / 255)


def test_exr_is_scene_linear(bake, tmp_path):
    values = scenes.noise(16, 16)
    levels, _ = read_levels(written(bake, tmp_path, "out.exr", values))
    linear = scenes.to_linear(values[..., :3])
    np.testing.assert_allclose(levels[0], linear, rtol=1e-3, atol=1e-6)
    np.testing.assert_allclose(levels[2], scenes.halved(scenes.halved(linear)), rtol=1e-3)


def test_straight_alpha_becomes_associated(bake, tmp_path):
    values = scenes.noise(8, 8, alpha=True)
    levels, _ = read_levels(written(bake, tmp_path, "out.exr", values))
    associated = np.concatenate(
        [scenes.to_linear(values[..., :3]) * values[..., 3:], values[..., 3:]], axis=2
    )
    np.testing.assert_allclose(levels[0], associated, rtol=1e-3, atol=1e-6)
    np.testing.assert_allclose(levels[1], scenes.halved(associated), rtol=2e-3, atol=1e-5)
    levels, _ = read_levels(written(bake, tmp_path, "out.tif", values))
    np.testing.assert_allclose(levels[0][..., :3], values[..., :3] * values[..., 3:], atol=0.003)


def test_independent_channels_stay_as_they_are(bake, tmp_path):
    values = 3 * scenes.noise(8, 8, alpha=True)
    options = {"is_float": True, "alpha_mode": "CHANNEL_PACKED"}
    levels, _ = read_levels(written(bake, tmp_path, "out.exr", values, **options))
    np.testing.assert_allclose(levels[0], values, rtol=1e-3)
    np.testing.assert_allclose(levels[1], scenes.halved(values), rtol=1e-3)


def test_float_image_as_tiff(bake, tmp_path):
    values = 5 * scenes.noise(8, 8)
    values[..., 3] = 1
    levels, specs = read_levels(written(bake, tmp_path, "out.tif", values, is_float=True))
    assert str(specs[0].format) == "float"
    np.testing.assert_allclose(levels[1], scenes.halved(values[..., :3]), rtol=1e-5)


def use_for_temporary_files(folder, monkeypatch):
    """Makes a folder and uses it for temporary files."""
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))


@pytest.mark.parametrize("name", ["a;b", "a%%b"])
def test_odd_folder_of_temporary_files(bake, tmp_path, monkeypatch, name):
    use_for_temporary_files(tmp_path / name, monkeypatch)
    levels, _ = read_levels(written(bake, tmp_path, "out;%.tif", scenes.noise(8, 8)))
    assert len(levels) == 4
    assert sorted(path.name for path in tmp_path.rglob("*")) == [name, "out;%.tif"]


@pytest.mark.parametrize("name", ["a;b", "a%%b"])
def test_odd_folder_of_the_file(bake, tmp_path, monkeypatch, name):
    folder = tmp_path / name
    folder.mkdir()
    levels, _ = read_levels(written(bake, folder, "out.tif", scenes.noise(8, 8)))
    assert len(levels) == 4
    use_for_temporary_files(tmp_path / f"next {name}", monkeypatch)
    with pytest.raises(OSError, match=rf"'.*next {name}' and '.*{name}'.*without ';'"):
        written(bake, folder, "next.tif", scenes.noise(8, 8))
    assert [path.name for path in folder.iterdir()] == ["out.tif"]


def test_level_file_that_cannot_be_read(bake, addon, tmp_path, monkeypatch):
    module = openimageio

    class Lost:
        def write(self, path):
            return True

    original = module._buffer
    monkeypatch.setattr(
        module,
        "_buffer",
        lambda level, alpha: Lost() if level.size == 3 else original(level, alpha),
    )
    with pytest.raises(OSError, match=r"cannot read level 3 back from '.*3\.tif'"):
        written(bake, tmp_path, "out.tif", scenes.noise(8, 8))
    assert list(tmp_path.iterdir()) == []


def test_link_and_mode_are_kept(bake, tmp_path):
    (tmp_path / "real").mkdir()
    real = tmp_path / "real" / "out.exr"
    real.write_bytes(b"before")
    real.chmod(0o600)
    link = tmp_path / "link.exr"
    link.symlink_to("real/out.exr")
    written(bake, tmp_path, "link.exr", scenes.noise(8, 8))
    assert link.is_symlink()
    assert len(read_levels(real)[0]) == 4
    assert real.stat().st_mode & 0o777 == 0o600
    assert [path.name for path in real.parent.iterdir()] == ["out.exr"]


def test_texture_cache_finds_the_levels(bake, tmp_path):
    path = written(bake, tmp_path, "out.exr", scenes.noise(64, 64))
    buffer = oiio.ImageBuf(str(path), 0, 3)
    assert (buffer.spec().width, buffer.spec().height) == (8, 8)


def test_nothing_is_left_beside_the_file(bake, tmp_path):
    written(bake, tmp_path, "out.exr", scenes.noise(8, 8))
    written(bake, tmp_path, "out.exr", scenes.noise(8, 8))
    assert [path.name for path in tmp_path.iterdir()] == ["out.exr"]


def test_missing_module_says_what_to_install(bake, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "OpenImageIO", None)
    with pytest.raises(OSError, match=r"no OpenImageIO for Python.*python3-openimageio"):
        written(bake, tmp_path, "out.tif", scenes.noise(8, 8))
    assert list(tmp_path.iterdir()) == []


def test_targets_that_cannot_be_written(addon, tmp_path):
    check = target_files.check_target
    with pytest.raises(ValueError, match=r"'\.jpg'.*\.exr"):
        check(str(tmp_path / "out.jpg"))
    with pytest.raises(OSError, match="no folder"):
        check(str(tmp_path / "none" / "out.exr"))
    (tmp_path / "folder.exr").mkdir()
    with pytest.raises(OSError, match="is a folder"):
        check(str(tmp_path / "folder.exr"))
    kept = tmp_path / "kept.exr"
    kept.write_bytes(b"kept")
    kept.chmod(0o444)
    with pytest.raises(OSError, match=r"kept\.exr.*read-only"):
        check(str(kept))
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(OSError, match="folder is read-only"):
            check(str(tmp_path / "out.exr"))
    finally:
        tmp_path.chmod(0o755)
