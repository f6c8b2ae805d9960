# SPDX-License-Identifier: GPL-3.0-or-later

"""Images: reading, refusals and writing."""

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest
import scenes
from prefilter.workflows import openimageio


def read(addon, made):
    return addon("bridge.images").read(made)


def write_levels(addon, made, levels):
    return addon("bridge.level_images").stage_levels(read(addon, made), levels).commit()


@pytest.mark.parametrize(
    "colorspace", ["sRGB", "Non-Color", "Linear Rec.709", "ACEScg", "Rec.1886"]
)
def test_decode_and_encode_are_inverse(addon, colorspace):
    images = addon("bridge.images")
    values = scenes.noise(4, 8, alpha=True)
    picture = read(addon, scenes.image("Paint", values, colorspace=colorspace))
    linear = images.scene_linear(picture)
    assert linear.shape == (4, 8, 4)
    np.testing.assert_array_equal(linear[..., 3], picture.stored[..., 3])
    np.testing.assert_allclose(images.encoded(picture, linear), values, atol=2e-5)


def test_srgb_bytes_are_decoded(addon):
    values = scenes.noise(4, 4)
    picture = read(addon, scenes.image("Paint", values))
    linear = addon("bridge.images").scene_linear(picture)
    assert linear.shape == (4, 4, 3)
    np.testing.assert_allclose(linear, scenes.to_linear(values[..., :3]), atol=1e-6)


def test_other_spaces_are_decoded_as_blender_does(addon, tmp_path):
    """Blender converts a 16-bit file on load; the add-on converts the same values from bytes."""
    values = scenes.noise(4, 4)[..., :3]
    path = str(tmp_path / "values.png")
    spec = oiio.ImageSpec(4, 4, 3, "uint16")
    writer = oiio.ImageOutput.create(path)
    assert writer.open(path, spec)
    assert writer.write_image(np.round(values[::-1] * 65535).astype(np.uint16))
    writer.close()
    loaded = bpy.data.images.load(path)
    for space in ("Rec.1886", "Display P3", "Filmic sRGB"):
        loaded.colorspace_settings.name = space
        loaded.reload()
        made = scenes.image("Paint", scenes.noise(4, 4), colorspace=space)
        linear = addon("bridge.images").scene_linear(read(addon, made))
        np.testing.assert_allclose(linear, scenes.pixels(loaded.name)[..., :3], atol=1e-4)


def test_conversion_in_bands(addon, monkeypatch):
    images = addon("bridge.images")
    picture = read(addon, scenes.image("Paint", scenes.noise(10, 4), colorspace="ACEScg"))
    whole = images.scene_linear(picture)
    monkeypatch.setattr(openimageio, "_PIXELS_A_BAND", 12)
    checks = []
    banded = images.scene_linear(picture, lambda: checks.append(None))
    np.testing.assert_array_equal(banded, whole)
    assert len(checks) == 4


def test_unknown_space_is_named(addon):
    picture = read(addon, scenes.image("Paint", scenes.noise(4, 4), colorspace="ACEScg"))
    object.__setattr__(picture, "ocio_config", "/no/such/config.ocio")
    with pytest.raises(ValueError, match=r"'Paint'.*'ACEScg'"):
        addon("bridge.images").scene_linear(picture)


def test_float_values_are_taken_as_they_are(addon):
    values = 7 * scenes.noise(4, 4, alpha=True) - 1
    picture = read(addon, scenes.image("Light", values, is_float=True))
    np.testing.assert_array_equal(addon("bridge.images").scene_linear(picture), values)


@pytest.mark.parametrize(
    ("is_float", "alpha_mode", "colorspace", "coverage", "straight"),
    [
        (False, "STRAIGHT", "sRGB", True, True),
        (False, "PREMUL", "sRGB", True, True),
        (False, "CHANNEL_PACKED", "sRGB", False, False),
        (False, "NONE", "sRGB", False, False),
        (False, "STRAIGHT", "Non-Color", False, False),
        (True, "STRAIGHT", "Linear Rec.709", True, False),
        (True, "PREMUL", "Linear Rec.709", True, False),
        (True, "CHANNEL_PACKED", "Linear Rec.709", False, False),
        (True, "STRAIGHT", "Non-Color", False, False),
    ],
)
def test_alpha_modes(addon, is_float, alpha_mode, colorspace, coverage, straight):
    made = scenes.image(
        "Paint",
        scenes.noise(4, 4, alpha=True),
        is_float=is_float,
        alpha_mode=alpha_mode,
        colorspace=colorspace,
    )
    picture = read(addon, made)
    assert picture.alpha_is_coverage == coverage
    assert picture.alpha_is_straight == straight


def test_premultiplied_byte_file_is_straight_in_blender(addon, tmp_path):
    """The fact that the alpha handling stands on."""
    path = str(tmp_path / "premultiplied.png")
    spec = oiio.ImageSpec(2, 2, 4, "uint8")
    spec.attribute("oiio:UnassociatedAlpha", 1)
    writer = oiio.ImageOutput.create(path)
    assert writer.open(path, spec)
    assert writer.write_image(np.full((2, 2, 4), (100, 50, 25, 128), np.uint8))
    writer.close()
    loaded = bpy.data.images.load(path)
    loaded.alpha_mode = "PREMUL"
    loaded.reload()
    stored = read(addon, loaded).stored
    np.testing.assert_allclose(stored[0, 0] * 255, (199, 100, 50, 128), atol=1)


def test_missing_file(addon):
    made = bpy.data.images.new("Gone", 4, 4)
    made.source = "FILE"
    made.filepath = "/no/such/picture.png"
    with pytest.raises(ValueError, match=r"'Gone'.*no pixels.*/no/such/picture.png"):
        read(addon, made)


def test_corrupt_file(addon, tmp_path):
    path = tmp_path / "corrupt.png"
    path.write_bytes(b"no picture")
    loaded = bpy.data.images.load(str(path))
    with pytest.raises(ValueError, match=r"corrupt\.png' cannot be read"):
        read(addon, loaded)


@pytest.mark.parametrize(
    ("source", "kind"), [("TILED", "UDIM"), ("MOVIE", "movie"), ("SEQUENCE", "sequence")]
)
def test_other_sources_are_refused(addon, source, kind):
    made = bpy.data.images.new("Odd", 4, 4, tiled=source == "TILED")
    made.source = source
    with pytest.raises(ValueError, match=f"'Odd'.*{kind}"):
        read(addon, made)


def test_render_result_is_refused(addon):
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    bpy.ops.render.render()
    with pytest.raises(ValueError, match=r"'Render Result'.*(viewer|render result)"):
        read(addon, bpy.data.images["Render Result"])


def test_unknown_name_lists_known_images(addon):
    scenes.image("Paint", scenes.noise(4, 4))
    with pytest.raises(ValueError, match=r"'Pain'.*'Paint'"):
        addon("bridge.images").find("Pain")


def test_unknown_name_lists_only_some(addon):
    for number in range(9):
        scenes.image(f"Paint {number}", scenes.noise(2, 2))
    with pytest.raises(ValueError, match=r"'Paint 4' and 4 more$"):
        addon("bridge.images").find("Pain")


LEVEL_CASES = [
    (False, "STRAIGHT", "sRGB"),
    (False, "PREMUL", "sRGB"),
    (False, "CHANNEL_PACKED", "ACEScg"),
    (False, "STRAIGHT", "Non-Color"),
    (True, "STRAIGHT", "Linear Rec.709"),
    (True, "PREMUL", "sRGB"),
    (True, "CHANNEL_PACKED", "ACEScg"),
    (True, "STRAIGHT", "Non-Color"),
]


@pytest.mark.parametrize(("is_float", "alpha_mode", "colorspace"), LEVEL_CASES)
def test_levels_survive_saving(addon, tmp_path, is_float, alpha_mode, colorspace):
    made = scenes.image(
        "Paint",
        scenes.noise(8, 4, alpha=True),
        is_float=is_float,
        alpha_mode=alpha_mode,
        colorspace=colorspace,
    )
    levels = [scenes.noise(4, 2, alpha=True, seed=2), scenes.noise(2, 1, alpha=True, seed=3)]
    names = write_levels(addon, made, levels)
    assert names == ["Paint.mip01", "Paint.mip02"]
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    for name, level in zip(names, levels, strict=True):
        image = bpy.data.images[name]
        assert image.is_float == is_float
        assert image.packed_file is not None
        np.testing.assert_allclose(scenes.pixels(name), level, atol=2e-3 if is_float else 1e-6)
        if not is_float:
            assert image.colorspace_settings.name == colorspace


def test_levels_are_updated_in_place(addon):
    made = scenes.image("Paint", scenes.noise(8, 8))
    write_levels(addon, made, [scenes.noise(4, 4), scenes.noise(2, 2)])
    shown = scenes.material("Shows level", bpy.data.images["Paint.mip01"])
    count = len(bpy.data.images)
    bpy.data.images.remove(made)
    wider = scenes.image("Paint", scenes.noise(2, 16), is_float=True)
    level = scenes.noise(1, 8, seed=5)
    write_levels(addon, wider, [level])
    assert len(bpy.data.images) == count
    node = next(node for node in shown.node_tree.nodes if node.type == "TEX_IMAGE")
    assert node.image == bpy.data.images["Paint.mip01"]
    assert node.image.is_float
    np.testing.assert_allclose(scenes.pixels("Paint.mip01"), level, atol=1e-6)
    assert tuple(bpy.data.images["Paint.mip02"].size) == (2, 2)


def test_levels_sort_by_their_names(addon):
    names = [addon("bridge.level_images").level_name("Paint", number) for number in range(1, 31)]
    assert names == sorted(names)


def test_levels_of_earlier_bakes_are_replaced(addon):
    made = scenes.image("Paint", scenes.noise(8, 8))
    for name in ("mip01", "mip02", "mip02.001", "mip03", "mip03.001", "mip10"):
        scenes.image(f"Paint.{name}", scenes.noise(2, 2))["prefilter_level_of"] = "Paint"
    scenes.image("Paint.mip04", scenes.noise(2, 2))
    shown = scenes.material("Shows level", bpy.data.images["Paint.mip02.001"])
    levels = [scenes.noise(4, 4), scenes.noise(2, 2, seed=2)]
    assert write_levels(addon, made, levels) == ["Paint.mip01", "Paint.mip02"]
    assert [image.name for image in bpy.data.images] == [
        "Paint", "Paint.mip01", "Paint.mip02", "Paint.mip03", "Paint.mip04", "Paint.mip10",
    ]  # fmt: skip
    node = next(node for node in shown.node_tree.nodes if node.type == "TEX_IMAGE")
    assert node.image == bpy.data.images["Paint.mip02"]
    np.testing.assert_allclose(scenes.pixels("Paint.mip02"), levels[1], atol=1e-6)


@pytest.mark.parametrize("count", [54, 55, 63])
def test_long_names_stay_distinct(addon, count):
    twins = [scenes.image("x" * (count - 1) + end, scenes.noise(2, 2)) for end in "ab"]
    for _ in range(2):
        names = [write_levels(addon, twin, [scenes.noise(1, 1)])[0] for twin in twins]
        assert len(set(names)) == 2
        assert all(name.endswith(".mip01") for name in names)
        assert all(name in bpy.data.images for name in names)
    assert len(bpy.data.images) == 4


def test_an_image_of_the_user_keeps_its_pixels(addon):
    made = scenes.image("Paint", scenes.noise(4, 4))
    scenes.image("Paint.mip01", scenes.noise(2, 2, seed=7))
    for seed in (2, 3):
        levels = [scenes.noise(2, 2, seed=seed), scenes.noise(1, 1, seed=seed)]
        assert write_levels(addon, made, levels) == ["Paint.mip01.001", "Paint.mip02"]
        np.testing.assert_allclose(scenes.pixels("Paint.mip01.001"), levels[0], atol=1e-6)
    np.testing.assert_allclose(scenes.pixels("Paint.mip01"), scenes.noise(2, 2, seed=7), atol=1e-6)
    assert len(bpy.data.images) == 4


def test_failure_while_staging_leaves_no_image(addon, monkeypatch):
    made = scenes.image("Paint", scenes.noise(4, 4))

    def no_packing(image, picture, level):
        raise RuntimeError("no packing")

    monkeypatch.setattr(addon("bridge.new_images"), "_fill_level", no_packing)
    with pytest.raises(OSError, match="'Paint': cannot make level 1"):
        write_levels(addon, made, [scenes.noise(2, 2)])
    assert [image.name for image in bpy.data.images] == ["Paint"]


def test_long_names_keep_their_suffix(addon):
    made = scenes.image("ä" * 30, scenes.noise(2, 2))
    names = write_levels(addon, made, [scenes.noise(1, 1)])
    assert names[0].endswith(".mip01")
    assert names[0] in bpy.data.images
