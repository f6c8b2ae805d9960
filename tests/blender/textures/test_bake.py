# SPDX-License-Identifier: GPL-3.0-or-later

"""Results of the bake: color, alpha, wrap, levels, and nothing after a failure."""

import bpy
import numpy as np
import OpenImageIO as oiio
import prefilter
import pytest
import scenes
from prefilter.workflows import openimageio


@pytest.fixture
def calls(addon, monkeypatch):
    """Returns a list that gets the keywords of each call of the library."""
    caught = []
    original = prefilter.coarser_levels

    def mipmaps(image, surface, **options):
        caught.append(options)
        return original(image, surface, **options)

    monkeypatch.setattr(prefilter, "coarser_levels", mipmaps)
    return caught


def test_srgb_is_filtered_as_light(bake):
    values = scenes.noise(8, 16)
    outcome = bake(scenes.image("Paint", values), filter="box")
    assert outcome.images == [f"Paint.mip{i:02d}" for i in (1, 2, 3, 4)]
    linear = scenes.to_linear(values[..., :3])
    for number in (1, 2, 3):
        linear = scenes.halved(linear)
        found = scenes.pixels(f"Paint.mip{number:02d}")
        assert found.shape == (8 >> number, 16 >> number, 4)
        np.testing.assert_allclose(found[..., :3], scenes.to_srgb(linear), atol=0.51 / 255)
        np.testing.assert_array_equal(found[..., 3], 1)


def test_data_is_filtered_as_it_is(bake):
    values = scenes.noise(8, 8, alpha=True)
    bake(scenes.image("Normals", values, colorspace="Non-Color"), filter="box")
    expected = scenes.halved(values)
    np.testing.assert_allclose(scenes.pixels("Normals.mip01"), expected, atol=0.51 / 255)


def test_straight_alpha_weighs_color(bake):
    values = scenes.noise(8, 8, alpha=True)
    bake(scenes.image("Leaf", values, colorspace="Linear Rec.709"), filter="box")
    alpha = scenes.halved(values[..., 3:])
    color = scenes.halved(values[..., :3] * values[..., 3:]) / alpha
    found = scenes.pixels("Leaf.mip01")
    np.testing.assert_allclose(found[..., 3:], alpha, atol=0.51 / 255)
    np.testing.assert_allclose(found[..., :3], color, atol=0.51 / 255)


@pytest.mark.parametrize("alpha_mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED"])
def test_float_channels_are_filtered_as_they_are(bake, alpha_mode):
    values = 9 * scenes.noise(8, 8, alpha=True)
    bake(scenes.image("Light", values, is_float=True, alpha_mode=alpha_mode), filter="box")
    assert bpy.data.images["Light.mip01"].is_float
    np.testing.assert_allclose(scenes.pixels("Light.mip01"), scenes.halved(values), rtol=1e-5)


def test_surface_decides_the_weights(bake):
    """Half of the area of a plane holds most of the texture: the last level is half and half."""
    values = np.zeros((8, 8, 4), np.float32)
    values[:, :6] = (1, 0, 0, 1)
    values[:, 6:] = (0, 0, 1, 1)
    image = scenes.image("Flag", values, colorspace="Non-Color")
    pair = scenes.quads(
        "Pair",
        [
            ((0, 0), (0.75, 0), (0.75, 1), (0, 1)),
            ((0.75, 0), (1, 0), (1, 1), (0.75, 1)),
        ],
    )
    pair.data.materials.append(scenes.material("Cloth", image))
    bake(image, [pair], filter="pam-box", wrap="clamp")
    np.testing.assert_allclose(scenes.pixels("Flag.mip03")[0, 0], (0.5, 0, 0.5, 1), atol=0.003)
    bake(image, [pair], filter="box", wrap="clamp")
    np.testing.assert_allclose(scenes.pixels("Flag.mip03")[0, 0], (0.75, 0, 0.25, 1), atol=0.003)


def test_objects_share_an_image_by_area(bake):
    values = np.zeros((4, 4, 4), np.float32)
    values[:, :2] = (1, 0, 0, 1)
    values[:, 2:] = (0, 0, 1, 1)
    image = scenes.image("Flag", values, colorspace="Non-Color")
    material = scenes.material("Cloth", image)
    left = scenes.quads("Left", [((0, 0), (0.5, 0), (0.5, 1), (0, 1))])
    right = scenes.quads("Right", [((0.5, 0), (1, 0), (1, 1), (0.5, 1))])
    for obj in (left, right):
        obj.data.materials.append(material)
    right.scale = (3, 1, 1)
    outcome = bake(image, [left, right], filter="pam-box", wrap="clamp")
    np.testing.assert_allclose(scenes.pixels("Flag.mip02")[0, 0], (0.25, 0, 0.75, 1), atol=0.003)
    assert "2 objects" in outcome.summary


@pytest.mark.parametrize(
    ("extension", "wrap"), [("REPEAT", "repeat"), ("EXTEND", "clamp"), ("CLIP", "border")]
)
def test_wrap_comes_from_the_node(bake, calls, extension, wrap):
    image = scenes.image("Paint", scenes.noise(4, 4))
    quad = scenes.textured_quad(image)
    tree = quad.active_material.node_tree
    next(node for node in tree.nodes if node.type == "TEX_IMAGE").extension = extension
    assert bake(image, [quad]).warnings == []
    bake(image, [quad], wrap_v="clamp")
    bake(image, [quad], wrap="border", wrap_v="repeat")
    assert [options["wrap"] for options in calls] == [
        (wrap, wrap),
        (wrap, "clamp"),
        ("border", "repeat"),
    ]


def test_mirror_and_disagreement_are_said(bake):
    image = scenes.image("Paint", scenes.noise(4, 4))
    quad = scenes.textured_quad(image)
    tree = quad.active_material.node_tree
    node = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    node.extension = "MIRROR"
    (warning,) = bake(image, [quad]).warnings
    assert "MIRROR" in warning
    assert "'clamp'" in warning
    node.extension = "EXTEND"
    twin = scenes.textured_quad(image, "Twin")
    (warning,) = bake(image, [quad, twin]).warnings
    assert "EXTEND, REPEAT" in warning


@pytest.mark.parametrize(
    ("is_float", "low", "colorspace", "bounds", "expected"),
    [
        (False, 0, "sRGB", "auto", (0, 1)),
        (True, 0, None, "auto", (0, 1)),
        (True, -1, None, "auto", (-1, 1)),
        (True, 0, None, "unit", (0, 1)),
        (False, 0, "sRGB", "positive", (0, None)),
        (False, 0, "sRGB", "none", None),
    ],
)
def test_bounds(bake, calls, is_float, low, colorspace, bounds, expected):
    values = scenes.noise(4, 4) + low
    values[0, 0] = 1
    values[..., 3] = 1
    values[1, 1, :3] = low
    image = scenes.image("Paint", values, is_float=is_float, colorspace=colorspace)
    bake(image, filter="box", bounds=bounds)
    assert calls[0]["bounds"] == expected


def test_bounds_reach_as_far_as_a_wide_color_space(bake, calls):
    image = scenes.image("Paint", scenes.noise(4, 4), colorspace="Filmic sRGB")
    bake(image, filter="box")
    low, high = calls[0]["bounds"]
    assert low == 0
    assert high > 1


def striped(most, few):
    """Texels that jump between two values, which makes a free fit overshoot; one is below 0."""
    values = np.full((32, 32, 4), most, np.float32)
    values[:, ::5, :3] = few
    values[3, 3, :3] = -1e-6
    values[..., 3] = 1
    return values


def test_light_falls_no_deeper_than_the_image(bake):
    """A texel that is a little below 0 once let levels fall to -10 beside a highlight."""
    image = scenes.image("Light", striped(0.01, 50), is_float=True)
    names = bake(image, [scenes.textured_quad(image)]).images
    assert min(scenes.pixels(name).min() for name in names) >= -1e-6


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear", "lanczos3"])
def test_light_rises_no_higher_than_the_image(bake, filter):
    """A few suns: a free fit makes brighter ones of them, which twinkle."""
    values = np.full((32, 32, 4), 0.01, np.float32)
    values[7:17, 7:17, :3] = 50
    values[..., 3] = 1
    image = scenes.image("Suns", values, is_float=True)
    quad = scenes.textured_quad(image)
    names = bake(image, [quad], filter=filter).images
    assert max(scenes.pixels(name).max() for name in names) <= 50
    names = bake(image, [quad], filter=filter, bounds="positive").images
    assert max(scenes.pixels(name)[..., :3].max() for name in names) > 50


@pytest.mark.parametrize("filter", ["pam-bilinear", "lanczos3"])
def test_associated_light_keeps_its_color(bake, filter):
    """Alpha and colors are limited together: suns stay as orange as they are, and as bright."""
    values = np.zeros((32, 32, 4), np.float32)
    values[7:17, 7:17] = (30, 20, 10, 1)
    image = scenes.image("Suns", values, is_float=True)
    for name in bake(image, [scenes.textured_quad(image)], filter=filter).images:
        found = scenes.pixels(name)
        assert found.max() <= 30.001
        assert found[..., 3].max() <= 1
        seen = found[found[..., 3] > 0.1]
        straight = seen[:, :3] / seen[:, 3:]
        np.testing.assert_allclose(straight, np.broadcast_to((30, 20, 10), straight.shape), 1e-3)


@pytest.mark.parametrize("is_packed", [False, True])
def test_integers_of_many_bits_stay_within_one(bake, tmp_path, is_packed):
    """Blender has a 16-bit PNG as floats."""
    pixels = np.round(np.clip(striped(1, 0), 0, 1) * 65535).astype(np.uint16)
    path = str(tmp_path / "deep.png")
    writer = oiio.ImageOutput.create(path)
    assert writer.open(path, oiio.ImageSpec(32, 32, 4, "uint16"))
    assert writer.write_image(pixels)
    writer.close()
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Linear Rec.709"
    if is_packed:
        image.pack()
    assert image.is_float
    names = bake(image, [scenes.textured_quad(image)]).images
    assert bpy.data.images[names[0]].is_float
    assert max(scenes.pixels(name).max() for name in names) <= 1


def test_values_that_are_not_finite_leave_the_bounds(bake, calls):
    values = scenes.noise(4, 4)
    values[0, 0, 0] = float("nan")
    values[0, 0, 1] = -float("inf")
    image = scenes.image("Light", values, is_float=True)
    half = scenes.quads("Half", [((0, 0.6), (1, 0.6), (1, 0.9), (0, 0.9))])
    half.data.materials.append(scenes.material("Cloth", image))
    bake(image, [half], filter="pam-box", wrap="clamp", levels=2)
    assert calls[0]["bounds"] == (0, 1)


def test_levels_limit_the_images_and_not_the_file(bake, tmp_path):
    path = tmp_path / "out.exr"
    image = scenes.image("Paint", scenes.noise(16, 16))
    outcome = bake(image, filter="box", levels=3, filepath=str(path))
    assert outcome.images == ["Paint.mip01", "Paint.mip02"]
    assert path.exists()
    assert "2 level images" in outcome.summary
    assert str(path) in outcome.summary


@pytest.mark.parametrize("filepath", ["", "out.exr"])
def test_too_many_levels(bake, calls, tmp_path, filepath):
    image = scenes.image("Paint", scenes.noise(16, 16))
    filepath = filepath and str(tmp_path / filepath)
    with pytest.raises(ValueError, match=r"Levels.*6"):
        bake(image, filter="box", levels=6, filepath=filepath)
    assert calls == []
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("height", "width"), [(1, 8), (7, 5), (6, 8), (13, 1)])
@pytest.mark.parametrize("ending", [".exr", ".tif"])
def test_sides_need_no_power_of_two(bake, tmp_path, height, width, ending):
    image = scenes.image("Odd", scenes.noise(height, width))
    target = tmp_path / f"out{ending}"
    outcome = bake(image, filter="box", filepath=str(target))
    sizes = [
        (max(1, width >> k), max(1, height >> k)) for k in range(max(width, height).bit_length())
    ]
    assert [tuple(bpy.data.images[name].size) for name in outcome.images] == sizes[1:]
    file = oiio.ImageInput.open(str(target))
    found = []
    while file.seek_subimage(0, len(found)):
        found.append((file.spec().width, file.spec().height))
    file.close()
    assert found == sizes


def test_an_image_of_one_texel_has_no_further_level(bake):
    outcome = bake(scenes.image("Dot", scenes.noise(1, 1)), filter="box")
    assert outcome.images == []


def test_nothing_to_write(bake):
    image = scenes.image("Paint", scenes.noise(4, 4))
    with pytest.raises(ValueError, match="nothing to write"):
        bake(image, filter="box", use_images=False)


def test_texture_space_filters_need_no_mesh(bake):
    image = scenes.image("Paint", scenes.noise(4, 4))
    for name in ("box", "tent", "lanczos3"):
        bake(image, filter=name)
    for name in ("box-covered", "tent-covered", "lanczos3-covered", "pam-box", "pam-bilinear"):
        with pytest.raises(ValueError, match=r"'Paint': no surface.*no visible object"):
            bake(image, filter=name)


def test_failures_name_the_found_objects(bake):
    image = scenes.image("Paint", scenes.noise(4, 4))
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "SUN"))
    with pytest.raises(ValueError, match=r"'Paint'.*'Lamp' \(light\)"):
        bake(image, [lamp])
    bare = scenes.quads("Bare")
    with pytest.raises(ValueError, match=r"no material.*'Bare' \(mesh\)"):
        bake(image, [bare])
    quad = scenes.textured_quad(image)
    quad.data.uv_layers.remove(quad.data.uv_layers[0])
    with pytest.raises(ValueError, match="'Quad' has no UV map"):
        bake(image, [quad])


def test_failures_of_the_library_name_the_object(bake):
    image = scenes.image("Paint", scenes.noise(4, 4))
    good, bad = (scenes.textured_quad(image, name) for name in ("Good", "Bad"))
    bad.data.uv_layers[0].uv[0].vector.x = 1e7
    with pytest.raises(ValueError, match=r"^object 'Bad', uvs: triangle 0"):
        bake(image, [good, bad])
    bad.scale = (0, 0, 0)
    bad.data.uv_layers[0].uv[0].vector.x = 0
    bpy.context.view_layer.update()
    assert "2 objects" in bake(image, [good, bad]).summary
    with pytest.raises(ValueError, match=r"^object 'Bad': .* area"):
        bake(image, [bad])


def test_taken_names_are_reported(bake):
    image = scenes.image("Paint", scenes.noise(4, 4))
    scenes.image("Paint.mip02", scenes.noise(4, 4))
    outcome = bake(image, filter="box")
    assert outcome.images == ["Paint.mip01", "Paint.mip02.001"]
    (warning,) = outcome.warnings
    assert "'Paint.mip01', 'Paint.mip02.001'" in warning
    assert bake(image, filter="box").images == outcome.images


def snapshot(tmp_path):
    images = {image.name: scenes.pixels(image.name).tobytes() for image in bpy.data.images}
    return images, {path.name: path.read_bytes() for path in tmp_path.iterdir()}


def test_failure_leaves_everything_as_it_was(bake, tmp_path):
    path = tmp_path / "out.exr"
    image = scenes.image("Paint", scenes.noise(8, 8))
    quad = scenes.textured_quad(image)
    bake(image, [quad], filepath=str(path))
    before = snapshot(tmp_path)

    quad.data.vertices[0].co.x = float("nan")
    with pytest.raises(ValueError, match="'Quad'"):
        bake(image, [quad], filepath=str(path))
    assert snapshot(tmp_path) == before

    path.chmod(0o444)
    with pytest.raises(OSError, match="read-only"):
        bake(image, filter="box", filepath=str(path))
    assert snapshot(tmp_path) == before


def test_failure_while_writing_leaves_everything_as_it_was(bake, addon, tmp_path, monkeypatch):
    path = tmp_path / "out.exr"
    image = scenes.image("Paint", scenes.noise(8, 8))
    bake(image, filter="box", filepath=str(path))
    before = snapshot(tmp_path)

    def no_rename(source, target):
        raise PermissionError("no rename")

    monkeypatch.setattr(addon("bridge.files.staging").os, "replace", no_rename)
    image.pixels.foreach_set(scenes.noise(8, 8, seed=9).ravel())
    changed = snapshot(tmp_path)
    with pytest.raises(OSError, match="no rename"):
        bake(image, filter="box", filepath=str(path))
    assert snapshot(tmp_path) == changed
    assert changed[1] == before[1]


def test_failure_of_an_image_leaves_everything_as_it_was(bake, addon, tmp_path, monkeypatch):
    path = tmp_path / "out.exr"
    image = scenes.image("Paint", scenes.noise(8, 8))
    bake(image, filter="box", filepath=str(path), levels=3)
    image.pixels.foreach_set(scenes.noise(8, 8, seed=9).ravel())
    before = snapshot(tmp_path)
    original = addon("bridge.new_images")._fill_level

    def fill(made, picture, level):
        if level.shape[0] == 1:
            raise MemoryError("no room")
        original(made, picture, level)

    monkeypatch.setattr(addon("bridge.new_images"), "_fill_level", fill)
    with pytest.raises(MemoryError, match="no room"):
        bake(image, filter="box", filepath=str(path))
    assert snapshot(tmp_path) == before


def test_cancel_between_level_files(bake, addon, tmp_path, monkeypatch):
    module = openimageio
    written = []
    original = module._write_level

    def write_level(path, buffer, number):
        written.append(number)
        original(path, buffer, number)

    monkeypatch.setattr(module, "_write_level", write_level)
    image = scenes.image("Paint", scenes.noise(16, 16))
    with pytest.raises(prefilter.Cancelled):
        bake(
            image,
            filter="box",
            filepath=str(tmp_path / "out.tif"),
            progress=lambda _: len(written) < 2,
        )
    assert written == [1, 2]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("stop_at", [0.0, 1.0])
def test_cancel_leaves_everything_as_it_was(bake, tmp_path, stop_at):
    path = tmp_path / "out.exr"
    image = scenes.image("Paint", scenes.noise(64, 64))
    quad = scenes.textured_quad(image)
    before = snapshot(tmp_path)
    with pytest.raises(prefilter.Cancelled):
        bake(image, [quad], filepath=str(path), progress=lambda done: done < stop_at)
    assert snapshot(tmp_path) == before


def test_progress_rises_to_one(bake):
    told = []
    image = scenes.image("Paint", scenes.noise(64, 64))
    bake(image, [scenes.textured_quad(image)], progress=lambda done: told.append(done) or True)
    assert told == sorted(told)
    assert told[-1] == 1


def test_pam_is_closer_on_a_real_model(textured, bake, addon):
    """Spot: the levels that were baked through Blender, against the library's surface error."""
    bpy.ops.wm.obj_import(filepath=str(next(textured.glob("spot/*.obj"))))
    (spot,) = bpy.context.selected_objects
    image = bpy.data.images.load(str(next(textured.glob("spot/*.png"))))
    found = addon("bridge.meshes").image_surfaces([spot], image, scenes.depsgraph(), all_faces=True)
    errors = {}
    for name in ("box", "pam-bilinear"):
        outcome = bake(image, [spot], filter=name, all_faces=True, wrap="clamp", levels=7)
        levels = [scenes.pixels(level)[..., :3] for level in (image.name, *outcome.images)]
        linear = [prefilter.to_linear(np.ascontiguousarray(level)) for level in levels]
        errors[name] = prefilter.mipmap_error(
            linear, linear[0], found.surfaces, [1, 2, 3, 4, 5, 6], wrap="clamp"
        )
    assert (np.asarray(errors["pam-bilinear"]) < np.asarray(errors["box"])).all()


def test_importance_moves_the_mean(bake):
    values = np.zeros((2, 2, 4), np.float32)
    values[:, :1] = 1
    values[..., 3] = 1
    picture = scenes.image("Paint", values, colorspace="Non-Color")
    pair = scenes.quads(
        "Pair",
        [((0, 0), (0.5, 0), (0.5, 1), (0, 1)), ((0.5, 0), (1, 0), (1, 1), (0.5, 1))],
    )
    pair.data.materials.append(scenes.material("Paint", picture))
    care = pair.data.attributes.new("Care", "FLOAT", "FACE")
    care.data.foreach_set("value", [3.0, 1.0])
    bake(picture, [pair], filter="pam-box", importance="Care")
    assert scenes.pixels("Paint.mip01")[0, 0, 0] == pytest.approx(0.75, abs=1 / 255)
    care.data.foreach_set("value", [0.0, 0.0])
    # Blender 4.2 would not look at the mesh again.
    pair.data.update()
    with pytest.raises(ValueError, match="Importance: 'Care' is 0 wherever objects 'Pair' use"):
        bake(picture, [pair], importance="Care")


def test_limit_surface_moves_the_mean(bake):
    """A long box's ends have another share of it when it is smooth."""
    values = np.zeros((2, 2, 4), np.float32)
    values[:, :1] = 1
    values[..., 3] = 1
    picture = scenes.image("Paint", values, colorspace="Non-Color")
    box = scenes.cube(picture)
    box.scale = (1, 1, 5)
    bpy.context.view_layer.update()
    layer = box.data.uv_layers.active.uv
    for face in box.data.polygons:
        left = 0.5 if abs(face.normal.z) > 0.5 else 0
        for corner, (u, v) in zip(face.loop_indices, scenes.UNIT_SQUARE, strict=True):
            layer[corner].vector = (left + u / 2, v)
    modifier = scenes.subdivided(box)
    means = []
    for modifier.levels, limit in ((1, True), (6, False), (1, False)):
        bake(picture, [box], filter="pam-box", use_subdivision_limit=limit)
        means.append(scenes.pixels("Paint.mip01")[0, 0, 0])
    assert means[0] == pytest.approx(means[1], abs=1.01 / 255)
    assert abs(means[2] - means[1]) > 4 / 255
