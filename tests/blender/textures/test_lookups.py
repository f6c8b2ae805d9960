# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels for renderers with one lookup per pixel, and for those that average many."""

import bpy
import numpy as np
import prefilter
import pytest
import scenes
from texture_readers import read_ktx2

QUAD = prefilter.Surface(
    np.array([(x, y, 0.0) for x, y in scenes.UNIT_SQUARE]),
    np.array([(0, 1, 2), (0, 2, 3)]),
    np.array([[scenes.UNIT_SQUARE[i] for i in corners] for corners in ((0, 1, 2), (0, 2, 3))]),
)
SIDE = 16
OPTIONS = {"wrap": "clamp", "levels": 3}


@pytest.fixture
def paint():
    """Makes an image of random values on a square, and returns it with a shader's lookups."""
    image = scenes.image("Paint", scenes.noise(SIDE, SIDE), colorspace="Non-Color")
    scenes.textured_quad(image)
    return image


def level(footprint, number=2, **options):
    values = scenes.noise(SIDE, SIDE)[..., :3]
    return prefilter.mipmaps(values, QUAD, footprint=footprint, **options)[number]


def baked(number=2):
    return scenes.pixels(f"Paint.mip{number:02d}")[..., :3]


@pytest.mark.parametrize(
    ("lookups", "name", "footprint"),
    [
        ("auto", "", 0.0),
        ("auto", "out.exr", 0.0),
        ("auto", "out.tif", 0.0),
        ("auto", "out.png", 0.0),
        ("auto", "out.dds", 1.0),
        ("auto", "out.KTX2", 1.0),
        ("supersampled", "out.dds", 0.0),
        ("one-lookup", "out.exr", 1.0),
        ("one-lookup", "", 1.0),
        ("anisotropic", "", 1.5),
        ("anisotropic", "out.ktx2", 1.5),
    ],
)
def test_the_file_decides_unless_the_user_does(bake, paint, tmp_path, lookups, name, footprint):
    filepath = str(tmp_path / name) if name else ""
    outcome = bake(
        paint, bpy.context.selected_objects, lookups=lookups, filepath=filepath, **OPTIONS
    )
    np.testing.assert_allclose(baked(), level(footprint), atol=0.51 / 255)
    assert np.abs(level(0.0) - level(1.0)).max() > 2 / 255
    words = {0.0: "PAM Bilinear over", 1.0: "one lookup per pixel", 1.5: "anisotropic lookups"}
    assert words[footprint] in outcome.summary
    assert ("lookup" in outcome.summary) == (footprint > 0)
    assert outcome.warnings == []


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear", "ls-bilinear"])
def test_fits_use_the_lookups(bake, paint, filter):
    bake(paint, bpy.context.selected_objects, filter=filter, lookups="one-lookup", wrap="clamp")
    np.testing.assert_allclose(baked(), level(1.0, filter=filter), atol=0.51 / 255)


@pytest.mark.parametrize("filter", ["box", "lanczos3-covered", "pam-box"])
def test_other_filters_ignore_the_lookups(bake, paint, filter):
    outcome = bake(
        paint, bpy.context.selected_objects, filter=filter, lookups="one-lookup", wrap="clamp"
    )
    np.testing.assert_allclose(baked(), level(0.0, filter=filter), atol=0.51 / 255)
    assert "lookup" not in outcome.summary


@pytest.mark.parametrize("content", ["color", "data"])
def test_levels_are_fitted_to_views(bake, paint, content):
    outcome = bake(paint, bpy.context.selected_objects, lookups="views", content=content, **OPTIONS)
    values = scenes.noise(SIDE, SIDE)[..., :3]
    is_light = content == "color"
    texels = prefilter.to_linear(values) if is_light else values
    start = prefilter.mipmaps(texels, QUAD, footprint=1.5, levels=3)
    expected = prefilter.fit_to_views(start, QUAD)
    stored = prefilter.to_srgb(expected[2]) if is_light else expected[2]
    np.testing.assert_allclose(baked(), stored, atol=0.51 / 255)
    assert np.abs(expected[2] - start[2]).max() > 2 / 255
    assert "fitted to views" in outcome.summary


def test_unsupported_readers_get_one_lookup(bake, paint):
    options = {"lookups": "views", "wrap": "clamp"}
    outcome = bake(paint, filter="ls-bilinear", **options)
    np.testing.assert_allclose(baked(), level(1.0, filter="ls-bilinear"), atol=0.51 / 255)
    assert "for one lookup per pixel" in outcome.summary
    bake(paint, bpy.context.selected_objects, content="normal", **options)
    normals = prefilter.normal_mipmaps(scenes.noise(SIDE, SIDE)[..., :3], QUAD, footprint=1.0)
    np.testing.assert_allclose(baked(), normals[2], atol=0.51 / 255)


@pytest.mark.parametrize(("lookups", "count"), [("auto", 0), ("one-lookup", 1), ("anisotropic", 1)])
def test_readers_of_encoded_texels_are_supersampled(bake, tmp_path, lookups, count):
    image = scenes.image("Paint", scenes.noise(SIDE, SIDE))
    quad = scenes.textured_quad(image)
    bake(image, [quad], reader="srgb-after", lookups="supersampled", wrap="clamp")
    expected = baked()
    outcome = bake(
        image,
        [quad],
        reader="srgb-after",
        lookups=lookups,
        wrap="clamp",
        filepath=str(tmp_path / "out.ktx2"),
    )
    np.testing.assert_array_equal(baked(), expected)
    assert sum(warning.startswith("Lookups: ") for warning in outcome.warnings) == count


def test_normal_maps_use_the_lookups(bake, paint):
    normals = scenes.noise(SIDE, SIDE)[..., :3]
    for lookups, footprint in (("supersampled", 0.0), ("one-lookup", 1.0)):
        bake(
            paint,
            bpy.context.selected_objects,
            content="normal",
            lookups=lookups,
            wrap="clamp",
        )
        expected = prefilter.normal_mipmaps(normals, QUAD, footprint=footprint)[2]
        np.testing.assert_allclose(baked(), expected, atol=0.51 / 255)


def test_cut_outs_use_the_lookups(bake):
    image = scenes.image("Paint", scenes.noise(SIDE, SIDE, alpha=True))
    quad = scenes.textured_quad(image)
    found = []
    for lookups in ("supersampled", "one-lookup"):
        bake(image, [quad], content="cutout", lookups=lookups)
        found.append(baked())
    assert np.abs(found[0] - found[1]).max() > 2 / 255


def test_the_preview_shows_what_the_file_gets(addon, paint, tmp_path):
    settings = bpy.context.scene.prefilter_bake
    settings.wrap, settings.result = "clamp", "file"
    settings.filepath = str(tmp_path / "out.ktx2")
    preview = addon("textures.view.preview")
    for lookups, footprint in (("auto", 1.0), ("supersampled", 0.0)):
        settings.lookups = lookups
        assert bpy.ops.prefilter.preview_levels(image="Paint") == {"FINISHED"}
        found = preview.find(paint)
        np.testing.assert_allclose(found.levels["pam-bilinear"][2], level(footprint), atol=1e-6)
        assert found.settings == preview.settings_for_preview(settings.to_settings())
    settings.lookups = "views"
    assert bpy.ops.prefilter.preview_levels(image="Paint") == {"FINISHED"}
    start = prefilter.mipmaps(scenes.noise(SIDE, SIDE)[..., :3], QUAD, footprint=1.5)
    expected = prefilter.fit_to_views(start, QUAD)[2]
    found = preview.find(paint)
    np.testing.assert_allclose(found.levels["pam-bilinear"][2], expected, atol=1e-5)
    settings.lookups = "auto"
    assert found.settings != preview.settings_for_preview(settings.to_settings())


def test_the_plot_is_of_supersampled_readers(paint):
    settings = bpy.context.scene.prefilter_bake
    found = []
    for lookups in ("supersampled", "one-lookup"):
        settings.lookups = lookups
        bpy.ops.prefilter.plot_error(image="Paint", filters={"pam-bilinear"})
        found.append(bpy.data.texts["Paint.error.csv"].as_string())
    assert found[0] == found[1]


def test_least_squares_need_no_object(bake, tmp_path):
    image = scenes.image("Paint", scenes.noise(SIDE, SIDE), colorspace="Non-Color")
    path = tmp_path / "out.ktx2"
    outcome = bake(image, filter="ls-bilinear", wrap="repeat", seam_budget=1.0, filepath=str(path))
    expected = level(1.0, filter="ls-bilinear", wrap="repeat")
    np.testing.assert_allclose(baked(), expected, atol=0.51 / 255)
    assert "with Least Squares for one lookup per pixel into" in outcome.summary
    assert outcome.notes == []
    assert len(read_ktx2(path).levels) == 5
