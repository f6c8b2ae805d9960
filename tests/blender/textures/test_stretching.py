# SPDX-License-Identifier: GPL-3.0-or-later

"""Images whose sides are stretched to multiples of 4, where readers of their blocks need that."""

import numpy as np
import prefilter
import pytest
import scenes
from prefilter.workflows.textures import stretching
from texture_readers import read_dds, read_ktx2

READERS = {"dds": read_dds, "ktx2": read_ktx2}
NOTE = "'Paint' is stretched from 9 x 6 to 12 x 8 texels"


@pytest.fixture
def bake(bake, tmp_path):
    """Returns a function that bakes a box over no surface, and gives the outcome."""

    def run(image, name, **settings):
        options = {"filter": "box", "use_images": False, "filepath": str(tmp_path / name)}
        return bake(image, **(options | settings))

    return run


def size_of(path):
    found = READERS[path.suffix[1:]](path)
    return found.width, found.height


@pytest.mark.parametrize(
    ("name", "chosen"),
    [("a.dds", "bc1"), ("a.ktx2", "bc7"), ("a.dds", "blocks"), ("a.ktx2", "uastc")],
)
def test_blocks_that_need_it(bake, tmp_path, name, chosen):
    outcome = bake(scenes.image("Paint", scenes.noise(6, 9)), name, texture_format=chosen)
    assert size_of(tmp_path / name) == (12, 8)
    assert outcome.warnings == []
    assert [note for note in outcome.notes if note.startswith(NOTE)]


@pytest.mark.parametrize(
    ("name", "chosen"),
    [("a.dds", "auto"), ("a.ktx2", "rgba16f"), ("a.ktx2", "astc-6x6"), ("a.ktx2", "etc2-rgb")],
)
def test_formats_of_any_sides_keep_theirs(bake, tmp_path, name, chosen):
    outcome = bake(scenes.image("Paint", scenes.noise(6, 9)), name, texture_format=chosen)
    assert size_of(tmp_path / name) == (9, 6)
    assert outcome.notes == []


def test_multiples_of_4_stay_as_they_are(bake, tmp_path):
    outcome = bake(scenes.image("Paint", scenes.noise(8, 12)), "a.ktx2", texture_format="uastc")
    assert size_of(tmp_path / "a.ktx2") == (12, 8)
    assert outcome.notes == []


def test_levels_are_those_of_the_stretched_image(bake, tmp_path):
    """Linear light is filtered, with the wrap mode of the levels."""
    pixels = scenes.noise(6, 9, alpha=True)
    bake(scenes.image("Paint", pixels), "a.dds", texture_format="bc7", wrap="repeat")
    light = pixels.copy()
    light[..., 3] = np.rint(pixels[..., 3] * 255) / 255
    light[..., :3] = prefilter.to_linear(np.rint(pixels[..., :3] * 255).astype(np.float32) / 255)
    wide = prefilter.resize(light, 12, 8, wrap="repeat")
    wide = np.clip(wide, light.min((0, 1)), light.max((0, 1)))
    wide[..., :3] = prefilter.to_srgb(wide[..., :3])
    options = {"filter": "box", "wrap": "repeat", "premultiplied": False}
    texels = np.rint(wide * 255).astype(np.uint8)
    levels = prefilter.mipmaps(texels, encoding="srgb", **options)
    expected = {"format": "bc7", "encoding": "srgb", "alpha": "straight"}
    prefilter.write_dds(tmp_path / "b.dds", levels, **expected)
    assert (tmp_path / "a.dds").read_bytes() == (tmp_path / "b.dds").read_bytes()


def test_smooth_images_keep_their_positions(addon):
    """A wave over the image is the same wave over the stretched one."""
    images = addon("bridge.images")

    def wave(width, height):
        x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
        return 0.5 + 0.2 * np.sin(2 * np.pi * x) + 0.2 * np.cos(2 * np.pi * y)

    pixels = np.repeat(wave(50, 67)[..., None], 4, axis=2).astype(np.float32)
    pixels[..., 3] = 1
    picture = images.read(scenes.image("Wave", pixels, is_float=True))
    wrap = ("repeat", "repeat")
    made = stretching.stretched(picture, (52, 68), wrap, lambda _: True, lambda: None)
    assert np.abs(made.texels - wave(52, 68)[..., None]).max() < 2e-3


def test_values_stay_within_their_range(addon):
    images = addon("bridge.images")
    pixels = np.ones((7, 9, 4), np.float32)
    pixels[..., :3] = 2.0
    pixels[3, 4, :3] = 900.0
    picture = images.read(scenes.image("Sun", pixels, is_float=True))
    wrap = ("clamp", "clamp")
    made = stretching.stretched(picture, (12, 8), wrap, lambda _: True, lambda: None)
    assert made.texels.min() == 2.0
    assert made.texels.max() <= 900.0
    plain = prefilter.resize(picture.texels, 12, 8, premultiplied=True)
    assert plain.min() < 0.0


def test_normals_have_length_1_and_roughness_follows(addon, bake, tmp_path):
    images = addon("bridge.images")
    random = np.random.default_rng(1)
    vectors = random.normal((0, 0, 2), 1, (6, 10, 3))
    vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    pixels = np.ones((6, 10, 4), np.float32)
    pixels[..., :3] = (vectors + 1) / 2
    floats = scenes.image("Bumps", pixels, is_float=True, colorspace="Non-Color")
    picture, wrap = images.read(floats), ("clamp", "clamp")
    made = stretching.stretched(
        picture, (12, 8), wrap, lambda _: True, lambda: None, is_normal_map=True
    )
    lengths = np.linalg.norm(2 * made.texels - 1, axis=2)
    assert np.abs(lengths - 1).max() < 1e-5
    normal_map = scenes.image("Normals", pixels, colorspace="Non-Color")
    scenes.image("Rough", scenes.noise(6, 10, seed=3), colorspace="Non-Color")
    rough = {"roughness": "Rough", "roughness_filepath": str(tmp_path / "rough.ktx2")}
    outcome = bake(normal_map, "n.ktx2", content="normal", texture_format="uastc", **rough)
    assert size_of(tmp_path / "n.ktx2") == size_of(tmp_path / "rough.ktx2") == (12, 8)
    assert [note.split(" is")[0] for note in outcome.notes] == ["'Normals'", "'Rough'"]


def test_texels_that_are_not_finite(bake, tmp_path):
    pixels = np.ones((6, 9, 4), np.float32)
    pixels[1, 1, 0] = np.inf
    with pytest.raises(ValueError, match=r"'Sun'.*finite"):
        bake(scenes.image("Sun", pixels, is_float=True), "a.dds", texture_format="bc6h")
    assert list(tmp_path.iterdir()) == []
