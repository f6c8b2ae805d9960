# SPDX-License-Identifier: GPL-3.0-or-later

"""The operator `prefilter.resize_image`."""

import bpy
import numpy as np
import prefilter
import pytest
import scenes


def resize(**options):
    return bpy.ops.prefilter.resize_image(**options)


def test_bytes_are_filtered_as_light():
    scenes.image("Paint", scenes.noise(8, 12))
    assert resize(image="Paint", percent=50, filter="box") == {"FINISHED"}
    expected = scenes.to_srgb(scenes.halved(scenes.to_linear(scenes.pixels("Paint"))))
    made = bpy.data.images["Paint.6x4"]
    assert not made.is_float
    assert made.colorspace_settings.name == "sRGB"
    assert made.packed_file is not None
    np.testing.assert_allclose(scenes.pixels("Paint.6x4"), expected, atol=0.5 / 255 + 1e-5)


def test_floats_are_light_already():
    pixels = 5 * scenes.noise(8, 8)
    pixels[..., 3] = 1
    scenes.image("Sky", pixels, is_float=True)
    resize(image="Sky", percent=50, filter="box")
    assert bpy.data.images["Sky.4x4"].is_float
    np.testing.assert_allclose(scenes.pixels("Sky.4x4"), scenes.halved(pixels), rtol=1e-6)


@pytest.mark.parametrize("is_float", [False, True])
def test_colors_without_alpha_do_not_bleed(is_float):
    pixels = np.zeros((8, 8, 4), np.float32)
    pixels[:] = (0, 0, 0, 0) if is_float else (1, 0, 1, 0)
    pixels[:, :3] = (0, 0.2, 0, 1)
    scenes.image("Leaf", pixels, is_float=is_float, alpha_mode="PREMUL" if is_float else "STRAIGHT")
    resize(image="Leaf", percent=50, filter="box")
    found = scenes.pixels("Leaf.4x4")
    np.testing.assert_allclose(found[0, :, 3], [1, 0.5, 0, 0], atol=0.5 / 255 + 1e-6)
    assert found[0, :2, 0].max() == 0
    expected = [0.2, 0.1] if is_float else [0.2, 0.2]
    np.testing.assert_allclose(found[0, :2, 1], expected, atol=0.5 / 255 + 1e-6)


@pytest.mark.parametrize(
    ("colorspace", "alpha_mode"), [("Non-Color", "STRAIGHT"), ("sRGB", "CHANNEL_PACKED")]
)
def test_channels_of_data_are_independent(colorspace, alpha_mode):
    pixels = scenes.noise(8, 8, alpha=True)
    scenes.image("Masks", pixels, colorspace=colorspace, alpha_mode=alpha_mode)
    before = scenes.pixels("Masks")
    resize(image="Masks", percent=50, filter="box")
    made = bpy.data.images["Masks.4x4"]
    assert (made.colorspace_settings.name, made.alpha_mode) == (colorspace, alpha_mode)
    is_data = colorspace == "Non-Color"
    linear = before if is_data else scenes.to_linear(before)
    expected = scenes.halved(linear)
    expected = expected if is_data else scenes.to_srgb(expected)
    expected[..., 3] = scenes.halved(before)[..., 3]
    np.testing.assert_allclose(scenes.pixels("Masks.4x4"), expected, atol=0.5 / 255 + 1e-5)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_every_filter_is_that_of_the_package(filter, addon):
    assert set(addon("images.choices").FILTERS) == set(prefilter.RESIZE_FILTERS)
    pixels = 2 * scenes.noise(16, 12, seed=2)
    pixels[..., 3] = 1
    scenes.image("Sky", pixels, is_float=True)
    resize(
        image="Sky",
        size="pixels",
        width=7,
        height=21,
        use_aspect=False,
        filter=filter,
        wrap="repeat",
        use_constrained=True,
    )
    expected = prefilter.resize(
        pixels[..., :3], 7, 21, filter=filter, wrap="repeat", constrained=True
    )
    np.testing.assert_array_equal(scenes.pixels("Sky.7x21")[..., :3], expected)


def test_least_squares_of_bytes_stay_in_range():
    pixels = scenes.noise(32, 32).round()
    scenes.image("Paint", pixels)
    resize(image="Paint", percent=25, filter="least-squares")
    expected = prefilter.resize(pixels[..., :3], 8, 8, filter="least-squares", constrained=True)
    np.testing.assert_allclose(
        scenes.pixels("Paint.8x8")[..., :3],
        prefilter.to_srgb(expected),
        atol=0.5 / 255 + 1e-6,
    )


def test_alpha_of_floats_stays_in_range():
    pixels = np.zeros((32, 32, 4), np.float32)
    pixels[8:24, 8:24] = 1
    scenes.image("Cut", pixels, is_float=True, alpha_mode="PREMUL")
    resize(image="Cut", percent=150, filter="lanczos3")
    found = scenes.pixels("Cut.48x48")
    assert (found[..., 3].min(), found[..., 3].max()) == (0, 1)
    assert found[..., 0].max() > 1


def test_sizes():
    scenes.image("Paint", scenes.noise(8, 12))
    for options, size in (
        ({"percent": 150.0}, (18, 12)),
        ({"percent": 1.0}, (1, 1)),
        ({"size": "pixels", "width": 30}, (30, 20)),
        ({"size": "pixels", "width": 5, "height": 9, "use_aspect": False}, (5, 9)),
        ({"percent": 100.0}, (12, 8)),
    ):
        resize(image="Paint", **options)
        assert tuple(bpy.data.images["Paint.{}x{}".format(*size)].size) == size
    np.testing.assert_array_equal(scenes.pixels("Paint.12x8"), scenes.pixels("Paint"))


def test_the_copy_of_a_size_is_replaced_and_others_stay():
    scenes.image("Paint", scenes.noise(8, 8))
    resize(image="Paint", percent=50)
    first = scenes.pixels("Paint.4x4")
    node = scenes.image_node(
        bpy.data.node_groups.new("Group", "ShaderNodeTree"), bpy.data.images["Paint.4x4"]
    )
    resize(image="Paint", percent=25)
    resize(image="Paint", percent=50, filter="box")
    assert sorted(image.name for image in bpy.data.images) == ["Paint", "Paint.2x2", "Paint.4x4"]
    assert node.image == bpy.data.images["Paint.4x4"]
    assert not np.array_equal(scenes.pixels("Paint.4x4"), first)


def test_the_copy_can_take_the_place_of_the_image():
    quad = scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    before = scenes.pixels("Paint")
    resize(image="Paint", percent=50, use_in_place=True)
    nodes = quad.active_material.node_tree.nodes
    shown = [node.image.name for node in nodes if node.type == "TEX_IMAGE"]
    assert shown == ["Paint.4x4"]
    np.testing.assert_array_equal(scenes.pixels("Paint"), before)


def tiled():
    bpy.data.images.new("Tiles", 8, 8, tiled=True)
    return "Tiles"


def without_file():
    image = bpy.data.images.new("Lost", 8, 8)
    image.source = "FILE"
    image.filepath = "/nowhere/lost.png"
    return "Lost"


def not_finite():
    pixels = scenes.noise(8, 8)
    pixels[3, 4, 1] = np.nan
    scenes.image("Broken", pixels, is_float=True)
    return "Broken"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: "Paint", "found no image named 'Paint'; this file has 'Other'"),
        (lambda: "", "no name is given"),
        (tiled, "'Tiles': has UDIM tiles"),
        (without_file, "'Lost': found no pixels .*is its file missing"),
        (not_finite, "row 3, column 4 holds nan"),
    ],
)
def test_bad_input(make, words):
    scenes.image("Other", scenes.noise(4, 4))
    name = make()
    before = [image.name for image in bpy.data.images]
    with pytest.raises(RuntimeError, match=words):
        resize(image=name)
    assert [image.name for image in bpy.data.images] == before
