# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels for renderers that interpolate the encoded texels of 8-bit sRGB images."""

import bpy
import numpy as np
import prefilter
import pytest
import scenes

QUAD = prefilter.Surface(
    np.array([(x, y, 0.0) for x, y in scenes.UNIT_SQUARE]),
    np.array([(0, 1, 2), (0, 2, 3)]),
    np.array([[scenes.UNIT_SQUARE[i] for i in corners] for corners in ((0, 1, 2), (0, 2, 3))]),
)


def checks(name="Paint", **options):
    """Makes an image of texels that are black or white, where the readers differ most."""
    values = scenes.noise(16, 16)
    values[..., :3] = values[..., :1] > 0.5
    image = scenes.image(name, values, **options)
    return values, scenes.textured_quad(image).material_slots[0].material, image


def seen(encoded, u, v):
    """Returns the light that a reader of encoded texels finds."""
    return scenes.to_linear(scenes.bilinear(encoded, u, v))


def errors(level, image, count=60_000):
    """Estimates the error of an encoded level for both readers."""
    u, v = np.random.default_rng(5).random((2, count))
    off = seen(level, u, v) - seen(image, u, v)
    plain = scenes.bilinear(scenes.to_linear(level), u, v)
    plain -= scenes.bilinear(scenes.to_linear(image), u, v)
    return np.sqrt(np.mean(off**2)), np.sqrt(np.mean(plain**2))


def test_each_reader_sees_its_own_levels_best(bake):
    values, _, image = checks()
    found = {}
    for reader in ("linear", "srgb-after"):
        bake(image, bpy.context.selected_objects, reader=reader, wrap="clamp")
        found[reader] = [scenes.pixels(f"Paint.mip{k:02d}")[..., :3] for k in (1, 2, 3)]
    for linear, encoded in zip(found["linear"], found["srgb-after"], strict=True):
        own, others = errors(encoded, values[..., :3]), errors(linear, values[..., :3])
        assert own[0] < 0.98 * others[0]
        assert others[1] < 0.98 * own[1]


@pytest.mark.parametrize("content", ["color", "cutout"])
def test_levels_are_those_of_the_library(bake, content):
    values = scenes.noise(16, 16, alpha=True)
    image = scenes.image("Paint", values)
    scenes.textured_quad(image)
    bake(image, bpy.context.selected_objects, reader="srgb-after", content=content, wrap="clamp")
    light = np.array(values)
    light[..., :3] = scenes.to_linear(values[..., :3])
    expected = prefilter.mipmaps(light, QUAD, reader="srgb-after")[2]
    others = prefilter.mipmaps(light, QUAD)[2]
    stored = scenes.pixels("Paint.mip02")[..., :3]
    np.testing.assert_allclose(stored, scenes.to_srgb(expected[..., :3]), atol=0.6 / 255)
    assert np.abs(stored - scenes.to_srgb(others[..., :3])).max() > 4 / 255


@pytest.mark.parametrize(
    "options", [{"is_float": True}, {"colorspace": "Non-Color"}], ids=["float", "data"]
)
def test_other_images_are_read_as_light(bake, options):
    _, _, image = checks(**options)
    outcome = bake(image, bpy.context.selected_objects, reader="linear")
    assert outcome.warnings == []
    expected = scenes.pixels("Paint.mip02")
    outcome = bake(image, bpy.context.selected_objects, reader="srgb-after")
    assert outcome.warnings == [
        "Reader: 'Paint' is not an 8-bit sRGB image, so it is read as linear light"
    ]
    np.testing.assert_array_equal(scenes.pixels("Paint.mip02"), expected)


def test_a_file_that_is_read_as_light_gets_a_warning(bake, tmp_path):
    _, _, image = checks()
    options = {"reader": "srgb-after", "use_images": False}
    for name, count in (("out.exr", 1), ("out.dds", 1), ("out.tif", 0)):
        outcome = bake(
            image, bpy.context.selected_objects, filepath=str(tmp_path / name), **options
        )
        assert len(outcome.warnings) == count
        assert all(f"{name}' is read as linear light" in warning for warning in outcome.warnings)


def test_trilinear_goes_with_light(bake, tmp_path):
    _, _, image = checks()
    options = {"filter": "pam-trilinear", "reader": "srgb-after"}
    with pytest.raises(ValueError, match="reader: 'srgb-after' requires pam-bilinear"):
        bake(image, bpy.context.selected_objects, filepath=str(tmp_path / "out.tif"), **options)
    assert [one.name for one in bpy.data.images] == ["Paint"]
    assert list(tmp_path.iterdir()) == []
    data = scenes.image("Data", scenes.noise(8, 8), colorspace="Non-Color")
    bake(data, [scenes.textured_quad(data, "Other")], **options)


def test_plot_measures_what_the_reader_sees():
    values, _, _ = checks()
    settings = bpy.context.scene.prefilter_bake
    settings.wrap, settings.reader = "clamp", "srgb-after"
    assert bpy.ops.prefilter.plot_error(image="Paint", filters={"box", "pam-bilinear"}) == {
        "FINISHED"
    }
    _, *rows = bpy.data.texts["Paint.error.csv"].as_string().strip().splitlines()
    measured = {row.split(",")[0]: [float(part) for part in row.split(",")[1:]] for row in rows}
    light = scenes.to_linear(values[..., :3])
    for mip_value in ("1", "2"):
        light = scenes.halved(light)
        expected, _ = errors(scenes.to_srgb(light), values[..., :3])
        pam, box = measured[mip_value]
        assert box == pytest.approx(expected, rel=0.02)
        assert pam < box
    with pytest.raises(RuntimeError, match="reader: 'srgb-after' requires pam-bilinear"):
        bpy.ops.prefilter.plot_error(image="Paint", filters={"pam-trilinear"})


def test_preview_is_for_the_reader(addon):
    checks()
    bpy.context.scene.prefilter_bake.reader = "srgb-after"
    preview = addon("textures.view.preview")
    assert bpy.ops.prefilter.preview_levels(image="Paint") == {"FINISHED"}
    shown = preview.find(bpy.data.images["Paint"])
    assert shown.decodes_after
    light = scenes.to_linear(scenes.pixels("Paint")[..., :3])
    expected = prefilter.mipmaps(light, QUAD, reader="srgb-after", wrap="repeat")
    np.testing.assert_allclose(shown.levels["pam-bilinear"][2], expected[2], atol=1e-5)
    bpy.data.images["Paint"].colorspace_settings.name = "Non-Color"
    bpy.ops.prefilter.preview_levels(image="Paint")
    assert not preview.find(bpy.data.images["Paint"]).decodes_after
