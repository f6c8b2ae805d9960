# SPDX-License-Identifier: GPL-3.0-or-later

"""The picture of weights, and the copy whose unused texels are filled."""

import bpy
import numpy as np
import pytest
import scenes

LEFT = [((0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0))]


def half_used(pixels, **options):
    """Makes an object that uses the left half of an image."""
    image = scenes.image("Paint", pixels, **options)
    obj = scenes.quads("Half", LEFT)
    obj.data.materials.append(scenes.material("Half", image))
    bpy.context.scene.prefilter_bake.wrap = "clamp"
    return image


def lightness(srgb):
    """Returns CIE L*, which knows nothing of OKLab."""
    luminance = scenes.to_linear(np.asarray(srgb)) @ np.array([0.2126, 0.7152, 0.0722])
    return 116 * np.cbrt(np.maximum(luminance, 0.009)) - 16


def test_colors_are_ordered_and_even(addon):
    octaves = np.linspace(-4, 4, 65)
    colors = addon("textures.view.weights").colors(2.0**octaves)
    found = lightness(colors)
    steps = np.diff(found)
    assert steps.min() > 0
    assert steps.max() < 2.5 * np.median(steps)
    assert found[-1] - found[0] > 60
    inner = colors[(octaves > -3.9) & (octaves < 3.9)]
    assert inner.min() > 0
    assert inner.max() < 1


def test_colors_end_where_the_legend_does(addon):
    colors = addon("textures.view.weights").colors
    np.testing.assert_array_equal(colors(16.0), colors(1e9))
    np.testing.assert_array_equal(colors(1 / 16), colors(1e-30))


def test_picture_of_weights(addon):
    half_used(scenes.noise(64, 64))
    assert bpy.ops.prefilter.show_weights(image="Paint") == {"FINISHED"}
    picture = scenes.pixels("Paint.weights")
    twice = addon("textures.view.weights").colors(2.0)
    np.testing.assert_allclose(picture[:, :32, :3], np.broadcast_to(twice, (64, 32, 3)), atol=0.003)
    hatched = picture[:, 32:, :3]
    assert len(np.unique(hatched.reshape(-1, 3), axis=0)) == 2
    assert np.ptp(hatched, axis=-1).max() == 0
    mean = np.array(addon("textures.view.weights").unused_color())
    np.testing.assert_allclose(hatched.mean(axis=(0, 1)), mean, atol=0.01)


def test_says_how_much_is_used(capfd):
    half_used(scenes.noise(16, 16))
    bpy.ops.prefilter.show_weights(image="Paint")
    assert "50.0% of the texels hold some of the surface" in capfd.readouterr().out


def test_legend_has_its_colors(addon):
    panel = addon("textures.panels.inspection")
    assert len(panel._swatches) == 6
    for key, _ in panel._swatches:
        assert panel._icons[key].icon_size[:] == (16, 16)


def test_filled_copy_keeps_used_texels():
    pixels = scenes.noise(16, 16)
    pixels[:, :10, :3] = np.arange(10)[None, :, None] / 255
    pixels[:, 10:] = (1, 0, 1, 1)
    half_used(pixels)
    before = scenes.pixels("Paint").copy()
    assert bpy.ops.prefilter.fill_unused(image="Paint") == {"FINISHED"}
    filled = scenes.pixels("Paint.filled")
    # The tent of texel 8 reaches the surface's edge; that of texel 9 does not.
    np.testing.assert_array_equal(filled[:, :9], before[:, :9])
    assert filled[:, 9:, :3].max() <= 8 / 255 + 1e-6
    assert filled[:, 9:, :3].min() > 0
    np.testing.assert_array_equal(scenes.pixels("Paint"), before)


@pytest.mark.parametrize("alpha", [False, True])
def test_filled_float_image_keeps_its_bits(alpha):
    pixels = 3 * np.random.default_rng(3).random((8, 8, 4)).astype(np.float32)
    pixels[..., 3] = pixels[..., 3] / 3 if alpha else 1
    half_used(pixels, is_float=True)
    before = scenes.pixels("Paint").copy()
    bpy.ops.prefilter.fill_unused(image="Paint")
    filled = scenes.pixels("Paint.filled")
    assert bpy.data.images["Paint.filled"].is_float
    np.testing.assert_array_equal(filled[:, :5], before[:, :5])
    assert not np.array_equal(filled[:, 5:], before[:, 5:])


def test_copy_can_take_the_place_of_the_image():
    half_used(scenes.noise(8, 8))
    node = bpy.data.materials["Half"].node_tree.nodes
    bpy.ops.prefilter.fill_unused(image="Paint", use_in_place=True)
    shown = [found.image.name for found in node if found.type == "TEX_IMAGE"]
    assert shown == ["Paint.filled"]
    assert "Paint" in bpy.data.images


def test_copy_is_baked_like_the_image():
    """PAM reads used texels only, so the copy has the same levels."""
    half_used(scenes.noise(16, 16))
    bpy.ops.prefilter.bake_mipmaps(image="Paint", wrap="clamp")
    bpy.ops.prefilter.fill_unused(image="Paint", use_in_place=True)
    bpy.ops.prefilter.bake_mipmaps(image="Paint.filled", wrap="clamp")
    for number in (1, 2, 3):
        np.testing.assert_array_equal(
            scenes.pixels(f"Paint.filled.mip{number:02d}"), scenes.pixels(f"Paint.mip{number:02d}")
        )


def test_bad_mesh_is_named():
    image = scenes.image("Paint", scenes.noise(4, 4))
    quad = scenes.textured_quad(image)
    quad.data.vertices[0].co.x = float("nan")
    for operator in ("show_weights", "fill_unused", "plot_error", "preview_levels"):
        with pytest.raises(RuntimeError, match=r"object 'Quad': .*positions"):
            getattr(bpy.ops.prefilter, operator)(image="Paint")
    assert [found.name for found in bpy.data.images] == ["Paint"]


def test_pictures_know_their_image(addon):
    image = half_used(scenes.noise(8, 8))
    bpy.ops.prefilter.show_weights(image="Paint")
    bpy.ops.prefilter.fill_unused(image="Paint")
    derived = addon("bridge.derived")
    assert derived.pictured(bpy.data.images["Paint.weights"]) == image
    assert derived.source_of(bpy.data.images["Paint.filled"]) == image
    assert derived.pictured(bpy.data.images["Paint.filled"]) is None
    assert derived.source_of(image) is None
    assert derived.source_of(None) is None
    filled = bpy.data.images["Paint.filled"]
    bpy.data.images.remove(image)
    assert derived.source_of(filled) is None


def test_undo_takes_the_copy_back():
    half_used(scenes.noise(8, 8))
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.prefilter.fill_unused(image="Paint", use_in_place=True)
    assert "Paint.filled" in bpy.data.images
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert [image.name for image in bpy.data.images] == ["Paint"]
    nodes = bpy.data.materials["Half"].node_tree.nodes
    assert [node.image.name for node in nodes if node.type == "TEX_IMAGE"] == ["Paint"]
    np.testing.assert_allclose(scenes.pixels("Paint"), scenes.noise(8, 8), atol=1e-6)
