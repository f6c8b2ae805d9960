# SPDX-License-Identifier: GPL-3.0-or-later

"""OpenEXR files of all levels, read back by OpenImageIO."""

import io

import numpy as np
import prefilter
import pytest
from prefilter.textures import exr

oiio = pytest.importorskip("OpenImageIO")

NAMES = {1: "Y", 2: "YA", 3: "RGB", 4: "RGBA"}


def pyramid(height, width, channels, *, seed=1):
    random = np.random.default_rng(seed)
    levels = [random.random((height, width, channels), np.float32)]
    while levels[-1].shape[:2] != (1, 1):
        height, width = max(1, height // 2), max(1, width // 2)
        levels.append(random.random((height, width, channels), np.float32))
    return levels


def read_back(path):
    """The levels of a file, row 0 at the bottom, in the order of R, G, B, A, and their specs."""
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


@pytest.mark.parametrize("format", ["half", "float"])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize(("height", "width"), [(1, 1), (5, 3), (64, 64), (65, 200), (130, 1)])
def test_floats_come_back(tmp_path, format, channels, height, width):
    levels = pyramid(height, width, channels)
    path = tmp_path / "texture.exr"
    prefilter.write_exr(path, levels, format=format, alpha="premultiplied")
    found, specs = read_back(path)
    assert [level.shape for level in found] == [level.shape for level in levels]
    for level, back, spec in zip(levels, found, specs, strict=True):
        assert "".join(spec.channelnames) == NAMES[channels]
        assert str(spec.format) == format
        assert (spec.tile_width, spec.tile_height) == (64, 64)
        assert spec.get_string_attribute("compression") == "zip"
        expected = level if format == "float" else level.astype(np.float16).astype(np.float32)
        np.testing.assert_array_equal(back, expected)


def test_halves_of_all_kinds(tmp_path):
    bits = np.arange(1 << 16, dtype=np.uint16).view(np.float16).astype(np.float32)
    finite = bits[np.isfinite(bits)]
    between = (finite[1:] + finite[:-1]) / 2
    few = np.float32([0.0, -0.0, 65504, 65519.9, 65520, 1e30, -1e30, 2**-24, 2**-25, 2**-26, 1e-45])
    near = np.nextafter(between, np.float32(np.inf)), np.nextafter(between, np.float32(-np.inf))
    values = np.concatenate([finite, between, *near, few])
    side = int(len(values) ** 0.5) + 1
    image = np.zeros(side * side, np.float32)
    image[: len(values)] = values
    levels = pyramid(side, side, 1)
    levels[0] = image.reshape(side, side, 1)
    path = tmp_path / "texture.exr"
    prefilter.write_exr(path, levels)
    expected = levels[0].clip(-65504, 65504).astype(np.float16).astype(np.float32)
    np.testing.assert_array_equal(read_back(path)[0][0], expected)


def test_infinite_and_missing_values(tmp_path):
    levels = pyramid(2, 2, 1)
    levels[0][..., 0] = [[np.inf, -np.inf], [np.nan, 1]]
    path = tmp_path / "texture.exr"
    prefilter.write_exr(path, levels)
    found = read_back(path)[0][0][..., 0]
    np.testing.assert_array_equal(found, [[65504, -65504], [np.nan, 1]])
    prefilter.write_exr(path, levels, format="float")
    np.testing.assert_array_equal(read_back(path)[0][0], levels[0])


@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("alpha", ["straight", "premultiplied", "independent"])
@pytest.mark.parametrize("channels", [2, 3, 4])
def test_bytes(tmp_path, encoding, alpha, channels):
    floats = pyramid(100, 70, channels)
    stored = np.random.default_rng(2).integers(0, 256, floats[0].shape, np.uint8)
    path = tmp_path / "texture.exr"
    prefilter.write_exr(path, [stored, *floats[1:]], encoding=encoding, alpha=alpha)
    values = stored / np.float64(255)
    if encoding == "srgb":
        colors = values[..., :3] if channels > 2 else values[..., :1]
        low, high = colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4
        decoded = np.where(colors <= 0.04045, low, high)
        if channels == 2:
            # Both channels of two-channel images are decoded, as in `mipmaps`.
            decoded = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
        values[..., : decoded.shape[2]] = decoded
    if alpha == "straight" and channels in (2, 4):
        values[..., :-1] *= values[..., -1:]
    found = read_back(path)[0]
    np.testing.assert_allclose(found[0], values, rtol=2**-11 * 1.01, atol=2**-25 * 1.01)
    if alpha == "straight" and channels == 4:
        floats[1][..., :3] *= floats[1][..., 3:]
    if alpha != "straight" or channels != 2:
        np.testing.assert_array_equal(found[1], floats[1].astype(np.float16).astype(np.float32))


def test_alpha_is_clipped_where_it_is_alpha(tmp_path):
    levels = [3 * level - 1 for level in pyramid(8, 8, 4)]
    path = tmp_path / "texture.exr"
    prefilter.write_exr(path, levels, alpha="premultiplied")
    found = read_back(path)[0][0]
    np.testing.assert_array_equal(found[..., 3], np.float16(levels[0][..., 3].clip(0, 1)))
    np.testing.assert_array_equal(found[..., :3], np.float16(levels[0][..., :3]))
    prefilter.write_exr(path, levels, alpha="independent")
    np.testing.assert_array_equal(read_back(path)[0][0], np.float16(levels[0]))


def test_texts(tmp_path):
    path = tmp_path / "texture.exr"
    long = "prefilter:" + 40 * "x"
    texts = {"wrapmodes": "periodic,clamp", "Software": "a test", long: "\u00e9"}
    prefilter.write_exr(path, pyramid(4, 4, 3), attributes=texts)
    spec = read_back(path)[1][0]
    for name, text in texts.items():
        assert spec.get_string_attribute(name) == text


def test_any_number_of_threads_writes_the_same(tmp_path):
    levels = pyramid(300, 700, 3)
    files = []
    for threads in (1, 2, 7):
        path = tmp_path / f"{threads}.exr"
        prefilter.write_exr(path, levels, threads=threads)
        files.append(path.read_bytes())
    assert files[0] == files[1] == files[2]


def test_flat_levels_are_small(tmp_path):
    levels = [np.full_like(level, 0.25) for level in pyramid(1024, 1024, 3)]
    path = tmp_path / "texture.exr"
    prefilter.write_exr(path, levels)
    assert path.stat().st_size < 1 << 16
    np.testing.assert_array_equal(read_back(path)[0][0], levels[0])


def test_progress_and_canceling(tmp_path):
    path = tmp_path / "texture.exr"
    path.write_bytes(b"before")
    levels = pyramid(700, 700, 3)
    seen = []
    prefilter.write_exr(path, levels, progress=lambda done: seen.append(done) or True)
    assert seen == sorted(seen)
    assert seen[0] == 0
    assert seen[-1] == 1
    path.write_bytes(b"before")
    with pytest.raises(prefilter.Cancelled):
        prefilter.write_exr(path, levels, progress=lambda done: done < 0.3)
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("size", [(1, 1), (63, 64), (65, 130), (200, 3)])
@pytest.mark.parametrize("format", ["half", "float"])
def test_pictures_of_one_level(tmp_path, size, format):
    for channels in range(1, 5):
        pixels = np.random.default_rng(1).random((*size, channels), np.float32)
        path = tmp_path / f"{channels}.exr"
        points = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
        exr.write_exr_picture(path, pixels, format=format, chromaticities=points)
        reader = oiio.ImageInput.open(str(path))
        assert not reader.seek_subimage(0, 1)
        reader.close()
        buffer = oiio.ImageBuf(str(path))
        expected = pixels.astype(np.float16) if format == "half" else pixels
        found = buffer.get_pixels(oiio.FLOAT)
        np.testing.assert_array_equal(found[::-1], expected.astype(np.float32))
        assert np.allclose(buffer.spec().getattribute("chromaticities"), points)


def test_chromaticities_that_are_none():
    with pytest.raises(ValueError, match="chromaticities: found"):
        prefilter.write_exr(io.BytesIO(), [np.ones((1, 1, 3))], chromaticities=[0.3, 0.3])
