# SPDX-License-Identifier: GPL-3.0-or-later

"""Files for engines, read back by readers of their own and by OpenImageIO."""

import os

import numpy as np
import OpenImageIO as oiio
import prefilter
import pytest
import scenes
from prefilter.files import staging
from texture_readers import read_dds, read_ktx2

READERS = {"dds": read_dds, "ktx2": read_ktx2}


@pytest.fixture(params=READERS)
def kind(request):
    return request.param


@pytest.fixture
def bake(bake, tmp_path):
    """Returns a function that bakes a box over no surface, and gives the outcome."""

    def run(image, name, **settings):
        options = {"filter": "box", "use_images": False, "filepath": str(tmp_path / name)}
        return bake(image, **(options | settings))

    return run


def as_bytes(values):
    return np.rint(values * 255).astype(np.uint8)


def read_png(path):
    """Returns the pixels of a PNG file as they are stored, rows from the bottom."""
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    reader = oiio.ImageInput.open(str(path), config)
    pixels = np.asarray(reader.read_image(reader.spec().format))
    return pixels.reshape(reader.spec().height, reader.spec().width, -1)[::-1]


@pytest.mark.parametrize("alpha", [False, True])
def test_bytes_are_those_of_the_image(bake, tmp_path, kind, alpha):
    values = scenes.noise(16, 8, alpha=alpha)
    outcome = bake(scenes.image("Paint", values), f"out.{kind}")
    assert outcome.warnings == []
    assert os.listdir(tmp_path) == [f"out.{kind}"]
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert (file.format, file.width, file.height) == ("R8G8B8A8_SRGB", 8, 16)
    np.testing.assert_array_equal(file.levels[0], as_bytes(values))
    assert [level.shape[:2] for level in file.levels] == [(16, 8), (8, 4), (4, 2), (2, 1), (1, 1)]
    opaque = "opaque" if kind == "dds" else "straight"
    assert file.alpha == ("straight" if alpha else opaque)
    if not alpha:
        linear = scenes.halved(scenes.to_linear(values[..., :3]))
        error = file.levels[1][..., :3] - 255 * scenes.to_srgb(linear)
        assert np.abs(error).max() <= 0.51


def test_level_images_hold_the_same_bytes(bake, tmp_path, kind):
    bake(scenes.image("Paint", scenes.noise(8, 8, alpha=True)), f"out.{kind}", use_images=True)
    levels = READERS[kind](tmp_path / f"out.{kind}").levels
    for number in (1, 2, 3):
        np.testing.assert_array_equal(
            levels[number], as_bytes(scenes.pixels(f"Paint.mip{number:02d}"))
        )


def test_data_is_not_marked_as_srgb(bake, tmp_path, kind):
    values = scenes.noise(8, 8, alpha=True)
    bake(scenes.image("Mask", values, colorspace="Non-Color"), f"out.{kind}")
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert file.format == "R8G8B8A8_UNORM"
    assert file.alpha == ("custom" if kind == "dds" else "straight")
    np.testing.assert_array_equal(file.levels[0], as_bytes(values))
    assert np.abs(file.levels[1] - 255 * scenes.halved(values)).max() <= 0.51


def test_other_color_spaces_become_srgb(bake, tmp_path, kind):
    values = scenes.noise(8, 8)
    image = scenes.image("Paint", values, colorspace="Rec.2020")
    bake(image, f"out.{kind}")
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert file.is_srgb
    # A saturated color of Rec.2020 lies outside of Rec.709, and is clipped.
    assert not np.array_equal(file.levels[0][..., :3], as_bytes(values[..., :3]))


def test_float_image_is_scene_linear(bake, tmp_path, kind):
    values = 5 * scenes.noise(8, 8, alpha=True)
    outcome = bake(scenes.image("Light", values, is_float=True), f"out.{kind}")
    assert outcome.warnings == []
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert (file.format, file.alpha) == ("R16G16B16A16_SFLOAT", "premultiplied")
    np.testing.assert_array_equal(file.levels[0], values.astype(np.float16))
    np.testing.assert_allclose(file.levels[1], scenes.halved(values), rtol=1e-3)


def test_float_image_in_bytes_is_clipped_with_a_warning(bake, tmp_path, kind):
    values = 2 * scenes.noise(8, 8)
    values[..., 3] = 1
    image = scenes.image("Light", values, is_float=True)
    outcome = bake(image, f"out.{kind}", texture_format="rgba8")
    assert outcome.warnings == ["Texture Format: RGBA8 clips values of 'Light' outside 0 to 1"]
    file = READERS[kind](tmp_path / f"out.{kind}")
    expected = 255 * scenes.to_srgb(np.clip(values[..., :3], 0, 1))
    assert np.abs(file.levels[0][..., :3] - expected).max() <= 0.51


@pytest.mark.parametrize("texture_format", ["rgba16f", "rgba32f"])
def test_bytes_as_floats_are_scene_linear(bake, tmp_path, kind, texture_format):
    values = scenes.noise(8, 8)
    bake(scenes.image("Paint", values), f"out.{kind}", texture_format=texture_format)
    file = READERS[kind](tmp_path / f"out.{kind}")
    expected = scenes.to_linear(values[..., :3])
    np.testing.assert_allclose(file.levels[0][..., :3], expected, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize(("texture_format", "name"), [("bc1", "BC1_SRGB"), ("bc3", "BC3_SRGB")])
def test_blocks_of_color(bake, tmp_path, kind, texture_format, name):
    values = np.full((16, 8, 4), 0.4, np.float32)
    values[8:, :, 0] = 0.8
    values[..., 3] = 1
    outcome = bake(scenes.image("Paint", values), f"out.{kind}", texture_format=texture_format)
    assert outcome.warnings == []
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert file.format == name
    assert len(file.levels) == 5
    assert np.abs(file.levels[0] - 255 * values).max() < 3


@pytest.mark.parametrize(("texture_format", "channels"), [("bc4", 1), ("bc5", 2)])
def test_blocks_of_few_channels(bake, tmp_path, kind, texture_format, channels):
    values = np.full((8, 8, 4), (0.2, 0.6, 0.4, 1), np.float32)
    image = scenes.image("Mask", values, colorspace="Non-Color")
    outcome = bake(image, f"out.{kind}", texture_format=texture_format)
    assert "only" in outcome.warnings[0]
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert file.format == f"{texture_format.upper()}_UNORM"
    assert np.abs(file.levels[0] - 255 * values[..., :channels]).max() < 1


@pytest.mark.parametrize("texture_format", ["bc4", "bc5"])
def test_few_channels_of_srgb_are_refused(bake, tmp_path, kind, texture_format):
    image = scenes.image("Paint", scenes.noise(8, 8))
    with pytest.raises(
        ValueError, match=f"{texture_format.upper()} has no sRGB .*'Paint'.*Non-Col"
    ):
        bake(image, f"out.{kind}", texture_format=texture_format)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("options", "settings", "words"),
    [
        ({}, {}, "stores only alpha 0 and 1; 'Paint' has values in between"),
        ({"alpha_mode": "CHANNEL_PACKED"}, {}, "drops the fourth channel of 'Paint'"),
        (
            {},
            {"content": "cutout", "threshold": 0.25},
            "cuts alpha off at 0.5, not at the threshold 0.25",
        ),
        ({}, {"content": "cutout", "threshold": 0.5}, None),
    ],
)
def test_bc1_warns_about_alpha(bake, tmp_path, options, settings, words):
    image = scenes.image("Paint", scenes.noise(8, 8, alpha=True), **options)
    outcome = bake(image, "out.dds", texture_format="bc1", **settings)
    assert outcome.warnings == ([] if words is None else [f"Texture Format: BC1 {words}"])
    level = read_dds(tmp_path / "out.dds").levels[0]
    if options:
        assert np.all(level[..., 3] == 255)
    else:
        alpha = as_bytes(scenes.pixels("Paint"))[..., 3]
        np.testing.assert_array_equal(level[..., 3], np.where(alpha < 128, 0, 255))


def test_odd_sides_are_reported_for_blocks(bake, tmp_path, kind):
    image = scenes.image("Paint", scenes.noise(6, 9))
    outcome = bake(image, f"out.{kind}", texture_format="bc3", use_multiples_of_4=False)
    assert outcome.warnings == [
        "Texture Format: BC3 of 9 x 6 texels: readers need sides divisible by 4"
    ]
    assert len(READERS[kind](tmp_path / f"out.{kind}").levels) == 4


def test_values_beyond_half_floats(bake, tmp_path, kind):
    image = scenes.image("Light", np.full((4, 4, 4), 1e6, np.float32), is_float=True)
    (tmp_path / f"out.{kind}").write_bytes(b"kept")
    with pytest.raises(ValueError, match="'rgba32f' is needed"):
        bake(image, f"out.{kind}")
    assert os.listdir(tmp_path) == [f"out.{kind}"]
    assert (tmp_path / f"out.{kind}").read_bytes() == b"kept"
    bake(image, f"out.{kind}", texture_format="rgba32f")
    assert np.all(READERS[kind](tmp_path / f"out.{kind}").levels[0][..., 0] == 1e6)


def test_a_png_for_each_level(bake, tmp_path):
    values = scenes.noise(8, 4, alpha=True)
    outcome = bake(scenes.image("Paint", values), "out.png", use_images=True)
    assert sorted(os.listdir(tmp_path)) == [f"out.{number:02d}.png" for number in range(4)]
    assert "out.00.png' and so on" in outcome.summary
    np.testing.assert_array_equal(read_png(tmp_path / "out.00.png"), as_bytes(values))
    for number in (1, 2, 3):
        expected = as_bytes(scenes.pixels(f"Paint.mip{number:02d}"))
        np.testing.assert_array_equal(read_png(tmp_path / f"out.{number:02d}.png"), expected)
    spec = oiio.ImageBuf(str(tmp_path / "out.01.png")).spec()
    assert spec.get_string_attribute("oiio:ColorSpace") in {"sRGB", "srgb_rec709_scene"}


def test_png_of_floats_has_16_bits_and_straight_alpha(bake, tmp_path):
    values = np.zeros((4, 4, 4), np.float32)
    values[..., :3], values[..., 3] = 0.1, 0.5
    values[0] = 0
    bake(scenes.image("Light", values, is_float=True), "out.png")
    pixels = read_png(tmp_path / "out.00.png")
    assert pixels.dtype == np.uint16
    assert np.all(pixels[0] == 0)
    expected = 65535 * np.append(scenes.to_srgb(np.full(3, 0.2)), 0.5)
    assert np.abs(pixels[1:] - expected).max() <= 1


def test_failure_leaves_no_png_and_no_other(bake, addon, tmp_path, monkeypatch):
    image = scenes.image("Paint", scenes.noise(8, 8))
    bake(image, "out.png")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    module = staging
    original, calls = module.stage_bytes, []

    def fail_at_the_third(target, write):
        def write_some(file):
            write(file)
            if len(calls) == 3:
                raise OSError("no space")

        calls.append(target)
        return original(target, write_some)

    monkeypatch.setattr(module, "stage_bytes", fail_at_the_third)
    other = scenes.image("Other", scenes.noise(16, 16, seed=5))
    with pytest.raises(OSError, match="no space"):
        bake(other, "out.png")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_read_only_level_file_is_left_alone(bake, tmp_path):
    level = tmp_path / "out.02.png"
    level.write_bytes(b"kept")
    level.chmod(0o444)
    with pytest.raises(OSError, match=r"out\.02\.png' is read-only"):
        bake(scenes.image("Paint", scenes.noise(8, 8)), "out.png")
    assert os.listdir(tmp_path) == ["out.02.png"]


def test_read_only_file_is_left_alone(bake, tmp_path, kind):
    path = tmp_path / f"out.{kind}"
    path.write_bytes(b"kept")
    path.chmod(0o444)
    with pytest.raises(OSError, match="is read-only"):
        bake(scenes.image("Paint", scenes.noise(8, 8)), path.name)
    assert path.read_bytes() == b"kept"


def test_normal_map_and_its_roughness(bake, tmp_path, kind):
    normal = np.full((8, 8, 4), (0.5, 0.5, 1, 1), np.float32)
    normal[:, ::2, 0] = 0.7
    image = scenes.image("Bump", normal, colorspace="Non-Color")
    scenes.image(
        "Rough", np.full((8, 8, 4), (0.5, 0.5, 0.5, 1), np.float32), colorspace="Non-Color"
    )
    bake(
        image,
        f"bump.{kind}",
        content="normal",
        roughness="Rough",
        roughness_filepath=str(tmp_path / f"rough.{kind}"),
        texture_format="bc5",
    )
    assert READERS[kind](tmp_path / f"bump.{kind}").format == "BC5_UNORM"
    rough = READERS[kind](tmp_path / f"rough.{kind}")
    assert rough.format == "BC4_UNORM"
    assert rough.levels[-1][0, 0, 0] > rough.levels[0][0, 0, 0] + 1


def test_bc7_keeps_soft_alpha(bake, tmp_path, kind):
    values = np.full((16, 8, 4), (0.2, 0.6, 0.4, 1), np.float32)
    values[:, 4:] = (0.7, 0.1, 0.3, 0.5)
    outcome = bake(scenes.image("Paint", values), f"out.{kind}", texture_format="bc7")
    assert outcome.warnings == []
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert (file.format, file.alpha) == ("BC7_SRGB", "straight")
    assert np.abs(file.levels[0] - 255 * values).max() < 2


def test_bc1_rgb_leaves_alpha_out(bake, tmp_path, kind):
    image = scenes.image("Paint", scenes.noise(8, 8, alpha=True))
    outcome = bake(image, f"out.{kind}", texture_format="bc1-rgb")
    assert outcome.warnings == ["Texture Format: BC1 RGB drops the fourth channel of 'Paint'"]
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert file.format == {"dds": "BC1_SRGB", "ktx2": "BC1_RGB_SRGB"}[kind]
    assert np.all(file.levels[0][..., 3:] == 255)


def test_bc6h_is_scene_linear(bake, tmp_path, kind):
    values = np.full((8, 8, 4), (20, 0.5, 0.01, 1), np.float32)
    image = scenes.image("Light", values, is_float=True)
    outcome = bake(image, f"out.{kind}", texture_format="bc6h")
    assert outcome.warnings == []
    file = READERS[kind](tmp_path / f"out.{kind}")
    assert file.format == "BC6H_UFLOAT"
    for level in file.levels:
        np.testing.assert_allclose(level, values[: len(level), : len(level), :3], rtol=0.02)


def test_bc6h_warns_about_negative_values(bake, tmp_path):
    dark = np.full((4, 4, 4), (-0.5, 1, 1, 0.5), np.float32)
    outcome = bake(scenes.image("Dark", dark, is_float=True), "a.dds", texture_format="bc6h")
    assert outcome.warnings == [
        "Texture Format: BC6H drops the fourth channel of 'Dark'",
        "Texture Format: BC6H clips values of 'Dark' below 0",
    ]
    outcome = bake(scenes.image("Paint", scenes.noise(4, 4)), "b.dds", texture_format="bc6h")
    assert outcome.warnings == [
        "Texture Format: BC6H is for float images; BC7 is closer to 'Paint'"
    ]
    wild = np.full((4, 4, 4), 1e6, np.float32)
    with pytest.raises(ValueError, match=r"half floats of format 'bc6h'.*'rgba32f' is needed"):
        bake(scenes.image("Wild", wild, is_float=True), "c.dds", texture_format="bc6h")
    assert sorted(os.listdir(tmp_path)) == ["a.dds", "b.dds"]


def test_every_format_but_the_smallest_can_be_chosen(addon):
    offered = addon("textures.choices").TEXTURE_FORMATS.keys() - {"auto", "blocks"}
    assert offered == prefilter.TEXEL_FORMATS.keys() - {"r8", "rg8"}
