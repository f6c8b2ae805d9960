# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake into Cycles' texture cache: that renders use it, and that nothing else changes."""

import json
import os
import re

import bpy
import cycles_scenes as cycles
import numpy as np
import OpenImageIO as oiio
import pytest
import scenes
from command_line import assert_fails, run
from cycles_scenes import (
    BLUE,
    GREEN,
    HAS_CACHE,
    MAGENTA,
    bake,
    contents,
    generate,
    smooth,
    udim,
)


@pytest.mark.skipif(HAS_CACHE, reason="this Blender has a texture cache")
def test_an_older_blender_says_what_is_needed():
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    assert not bpy.ops.prefilter.bake_texture_cache.poll()
    with pytest.raises(RuntimeError, match=r"Blender 5\.2 LTS or later"):
        bake()


def test_levels_are_removed_again(scene, tmp_path):
    image = cycles.write_picture(tmp_path / "paint.png", smooth(256, 256, 3), "uint8")
    cycles.shown_on(image)
    generate()
    made, levels = contents(tmp_path), [cycles.level(cycles.cache_file(tmp_path), 3)]
    with pytest.raises(RuntimeError, match="has no levels to remove"):
        bpy.ops.prefilter.remove_levels(image=image.name, kinds={"cache"})
    assert contents(tmp_path) == made
    bake()
    baked = contents(tmp_path)
    assert baked != made
    with pytest.raises(RuntimeError, match="has no levels to remove"):
        bpy.ops.prefilter.remove_levels(image=image.name)
    assert contents(tmp_path) == baked
    assert bpy.ops.prefilter.remove_levels(kinds={"cache"}, use_all=True) == {"FINISHED"}
    assert not cycles.cache_files(tmp_path)
    generate()
    np.testing.assert_array_equal(cycles.level(cycles.cache_file(tmp_path), 3), *levels)


@pytest.mark.parametrize("kind", ["uint8", "float"])
def test_files_contain_no_time(scene, tmp_path, kind):
    name = "paint.exr" if kind == "float" else "paint.png"
    image = cycles.write_picture(tmp_path / name, smooth(256, 256, 3), kind)
    os.utime(tmp_path / name, (1.6e9, 1.6e9))
    cycles.shown_on(image)
    bake()
    (path,) = cycles.cache_files(tmp_path)
    date = re.compile(rb"\d{4}:\d\d:\d\d \d\d:\d\d:\d\d")
    # Blender dates each level like the image.
    assert {found[:10] for found in date.findall(path.read_bytes())} == {b"2020:09:13"}


def test_another_engine_gets_a_warning(scene, tmp_path, capfd):
    cycles.shown_on(cycles.write_picture(tmp_path / "paint.png", smooth(256, 256, 3), "uint8"))
    bake()
    assert "Warning" not in capfd.readouterr().out
    scene.render.engine = "BLENDER_WORKBENCH"
    assert bake() == {"FINISHED"}
    assert "Warning: scene 'Scene' is not rendered by Cycles" in capfd.readouterr().out


@pytest.mark.usefixtures("scene")
def test_poll_without_images():
    assert not bpy.ops.prefilter.bake_texture_cache.poll()
    with pytest.raises(RuntimeError, match="no image in this file"):
        bake()


@pytest.mark.parametrize(("kind", "number"), [("float", 2), ("uint8", 1)])
def test_cycles_renders_the_levels(scene, tmp_path, kind, number):
    name = "paint.exr" if kind == "float" else "paint.png"
    image = cycles.write_picture(tmp_path / name, smooth(256, 256, 3), kind)
    node = cycles.shown_on(image).data.materials[0].node_tree.nodes["Image Texture"]
    node.extension = "EXTEND"
    scene.render.use_texture_cache = True
    generate()
    path = cycles.cache_file(tmp_path)
    size = 256 >> number

    def predicted():
        texels = cycles.level(path, number)[..., :3]
        return cycles.pixel_means(texels, size, is_encoded=kind == "uint8")

    of_blender, box = cycles.render(scene, size, tmp_path / "out.exr"), predicted()
    bake()
    of_ours, ours = cycles.render(scene, size, tmp_path / "out.exr"), predicted()

    def rmse(a, b):
        return np.sqrt(np.mean((a - b) ** 2))

    noise = 2e-3
    assert rmse(of_blender, box) < noise
    assert rmse(of_ours, ours) < noise
    assert rmse(ours, box) > 5 * noise
    full = cycles.level(path, 0)[..., :3]
    true = cycles.pixel_means(full, size, is_encoded=kind == "uint8")
    assert rmse(of_ours, true) < 0.8 * rmse(of_blender, true)


def test_cycles_renders_whatever_the_levels_are(scene, tmp_path, addon):
    tx_files = addon("bridge.files.tx")
    cycles.shown_on(cycles.write_picture(tmp_path / "paint.png", smooth(256, 256, 3), "uint8"))
    bake()
    texture = tx_files.read(cycles.cache_file(tmp_path))
    flat = []
    for number in range(1, 9):
        side = 256 >> number
        flat.append(np.tile(np.float32((1, 0, 0, 1)), (side, side, 1)))
    tx_files.stage(texture, flat, lambda: None).commit()
    colors = cycles.render(scene, 64, tmp_path / "out.exr")
    np.testing.assert_allclose(colors, np.broadcast_to((1, 0, 0), colors.shape), atol=1e-3)


@pytest.mark.parametrize(
    ("name", "kind", "channels"),
    [
        ("byte.png", "uint8", 3),
        ("gray.png", "uint8", 1),
        ("deep.png", "uint16", 3),
        ("half.exr", "half", 3),
        ("float.exr", "float", 4),
    ],
)
def test_all_but_the_levels_stays(scene, tmp_path, name, kind, channels):
    image = cycles.write_picture(tmp_path / name, smooth(96, 160, channels), kind)
    os.utime(tmp_path / name, (1.6e9, 1.6e9))
    cycles.shown_on(image)
    scene.render.use_texture_cache = False
    generate()
    path = cycles.cache_file(tmp_path)
    before, full = cycles.metadata(path), cycles.level(path, 0)
    box = [cycles.level(path, number) for number in range(8)]
    assert bake() == {"FINISHED"}
    assert cycles.cache_files(tmp_path) == [path]
    assert cycles.metadata(path) == before
    np.testing.assert_array_equal(cycles.level(path, 0), full)
    assert path.stat().st_mtime == 1.6e9
    assert scene.render.use_texture_cache
    for number, theirs in enumerate(box):
        assert cycles.level(path, number).shape == theirs.shape
    assert not np.array_equal(cycles.level(path, 1), box[1])
    reader = oiio.ImageInput.open(str(path))
    assert not reader.seek_subimage(0, 8)


def test_blender_leaves_it_alone_until_the_image_changes(scene, tmp_path, capfd):
    name = tmp_path / "paint.png"
    cycles.shown_on(cycles.write_picture(name, smooth(128, 128, 3), "uint8"))
    scene.render.use_auto_generate_texture_cache = True
    bake()
    path = cycles.cache_file(tmp_path)
    ours = path.read_bytes()
    capfd.readouterr()
    generate()
    assert "0 failed, 1 up to date" in capfd.readouterr().out
    cycles.render(scene, 8, tmp_path / "out.exr")
    assert path.read_bytes() == ours
    os.utime(name, (1.6e9, 1.6e9))
    cycles.render(scene, 8, tmp_path / "out.exr")
    assert path.read_bytes() != ours
    bake()
    assert np.array_equal(cycles.level(path, 1)[..., :3], cycles.level(path, 1)[..., :3])
    assert path.stat().st_mtime == 1.6e9


@pytest.mark.parametrize(
    ("kind", "colorspace", "is_encoded"),
    [
        ("uint8", "sRGB", True),
        ("uint8", "Non-Color", False),
        ("uint8", "Linear Rec.709", False),
        ("uint16", "sRGB", True),
        ("uint8", "Filmic sRGB", False),
        ("half", "Linear Rec.709", False),
        ("float", "Non-Color", False),
        ("float", "ACEScg", False),
    ],
)
def test_levels_are_closer_to_the_image_as_cycles_reads_it(
    scene, tmp_path, kind, colorspace, is_encoded
):
    name = f"paint.{'png' if kind.startswith('uint') else 'exr'}"
    pixels = smooth(128, 128, 3)
    pixels[:, 64:] = MAGENTA
    image = cycles.write_picture(tmp_path / name, pixels, kind)
    image.colorspace_settings.name = colorspace
    inside = ((0, 0), (0.49, 0), (0.49, 1), (0, 1))
    node = cycles.shown_on(image, inside).data.materials[0].node_tree.nodes["Image Texture"]
    node.extension = "EXTEND"
    generate()
    path = cycles.cache_file(tmp_path)
    random = np.random.default_rng(5)
    u, v = 0.49 * random.random(20000), random.random(20000)

    def read(number):
        values = cycles.looked_up(cycles.level(path, number)[..., :3], u, v)
        return scenes.to_linear(values) if is_encoded else values

    true = read(0)
    box = [np.sqrt(np.mean((read(number) - true) ** 2)) for number in (1, 2, 3, 4)]
    bake()
    ours = [np.sqrt(np.mean((read(number) - true) ** 2)) for number in (1, 2, 3, 4)]
    assert np.all(np.array(ours) < 0.96 * np.array(box)), (ours, box)


@pytest.mark.parametrize(
    ("name", "kind", "mode"),
    [
        ("leaf.png", "uint8", "STRAIGHT"),
        ("leaf.exr", "float", "PREMUL"),
        ("leaf.exr", "half", "PREMUL"),
    ],
)
def test_color_and_alpha_are_associated(scene, tmp_path, name, kind, mode):
    alpha = (smooth(64, 64, 1) > 0.5).astype(np.float32)
    color = np.float32(GREEN)
    leaf = color * alpha if mode == "PREMUL" else np.where(alpha > 0, color, np.float32(MAGENTA))
    image = cycles.write_picture(
        tmp_path / name, np.concatenate([leaf, alpha], axis=2).astype(np.float32), kind
    )
    image.alpha_mode = mode
    cycles.shown_on(image)
    bake()
    stored = cycles.level(cycles.cache_file(tmp_path), 2)
    known = cycles.level(cycles.cache_file(tmp_path), 0)
    assert known[..., 3].min() == 0
    assert np.all(stored[..., 3] >= 0)
    assert np.all(stored[..., 3] <= 1)
    assert stored[..., 3].mean() == pytest.approx(alpha.mean(), abs=0.02)
    seen = stored[..., 3] > 0.2
    np.testing.assert_allclose(
        stored[seen][:, :3] / stored[seen][:, 3:],
        np.broadcast_to(color, (seen.sum(), 3)),
        atol=0.02 if kind == "uint8" else 0.002,
    )


@pytest.mark.parametrize("is_cut_out", [False, True])
@pytest.mark.parametrize("kind", ["uint8", "float"])
def test_covered_colors_are_closer_to_the_image(scene, tmp_path, is_cut_out, kind):
    pixels, alpha = smooth(256, 256, 4), smooth(256, 256, 1, seed=8)
    pixels[..., 3:] = alpha > 0.5 if is_cut_out else np.clip(2 * alpha - 0.5, 0, 1)
    if kind == "float":
        pixels[..., :3] *= pixels[..., 3:]
    name = "leaf.png" if kind == "uint8" else "leaf.exr"
    image = cycles.write_picture(tmp_path / name, pixels, kind)
    material = cycles.shown_on(image).data.materials[0]
    material.node_tree.nodes["Image Texture"].extension = "EXTEND"
    generate()
    path = cycles.cache_file(tmp_path)
    random = np.random.default_rng(1)
    u, v = random.random(40000), random.random(40000)

    def read(number):
        texels = cycles.looked_up(cycles.level(path, number), u, v)
        color, covered = texels[:, :3], texels[:, 3:]
        straight = np.divide(color, covered, out=np.zeros_like(color), where=covered > 0)
        if kind == "uint8":
            straight = scenes.to_linear(straight)
        return np.concatenate([straight * covered, covered], axis=1)

    def errors():
        true = read(0)
        return np.array([np.sqrt(np.mean((read(k) - true) ** 2)) for k in (1, 2, 3, 4)])

    box = errors()
    bake()
    assert np.all(errors() < box)


@pytest.mark.parametrize("mode", ["CHANNEL_PACKED", "NONE"])
def test_channels_that_are_no_alpha_do_not_mix(scene, tmp_path, mode):
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., :3] = 0.5
    pixels[:, ::2, 3] = 0
    image = cycles.write_picture(tmp_path / "packed.png", pixels, "uint8")
    image.alpha_mode = mode
    cycles.shown_on(image)
    bake()
    stored = cycles.level(cycles.cache_file(tmp_path), 3)
    np.testing.assert_allclose(stored[..., :3], 0.5, atol=0.51 / 255)
    np.testing.assert_allclose(stored[..., 3], 0.5 if mode == "CHANNEL_PACKED" else 1, atol=0.01)


@pytest.mark.parametrize("kind", ["uint8", "float"])
def test_packed_alpha_that_a_material_shows_by_is_coverage(scene, tmp_path, kind):
    """With the setup of Blender's glTF importer: colors hidden by alpha are in no level."""
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[::4, :, :3] = GREEN
    pixels[..., 3] = 0
    pixels[::4, :, 3] = 1
    name = "leaf.png" if kind == "uint8" else "leaf.exr"
    image = cycles.write_picture(tmp_path / name, pixels, kind)
    image.alpha_mode = "CHANNEL_PACKED"
    quad = scenes.textured_quad(image)
    tree = quad.active_material.node_tree
    node = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])
    bake()
    for number in (2, 4):
        stored = cycles.level(cycles.cache_file(tmp_path), number)
        np.testing.assert_allclose(
            stored[..., :3], np.broadcast_to(GREEN, stored[..., :3].shape), atol=0.02
        )
        assert stored[..., 3].mean() == pytest.approx(0.25, abs=0.02)


def test_levels_fall_no_deeper_than_the_image(scene, tmp_path):
    pixels = np.full((64, 64, 3), 0.01, np.float32)
    pixels[:, ::5] = 50
    pixels[3, 3] = -1e-6
    cycles.shown_on(cycles.write_picture(tmp_path / "light.exr", pixels, "float"))
    bake()
    path = cycles.cache_file(tmp_path)
    assert min(cycles.level(path, number).min() for number in range(1, 7)) >= -1e-6


def test_deep_integers_stay_within_one(scene, tmp_path):
    """Blender caches a 16-bit file of another color space as floats."""
    pixels = np.ones((64, 64, 3), np.float32)
    pixels[:, ::5] = 0
    image = cycles.write_picture(tmp_path / "deep.png", pixels, "uint16")
    image.colorspace_settings.name = "ACEScg"
    cycles.shown_on(image)
    bake()
    path = cycles.cache_file(tmp_path)
    reader = oiio.ImageInput.open(str(path))
    assert reader.format_name() == "openexr"
    highest = cycles.level(path, 0).max()
    assert max(cycles.level(path, number).max() for number in range(1, 7)) <= max(1, highest)


def test_weights_are_those_of_all_objects(scene, tmp_path):
    pixels = np.zeros((64, 64, 3), np.float32)
    pixels[:] = MAGENTA
    pixels[:24] = GREEN
    pixels[40:] = BLUE
    image = cycles.write_picture(tmp_path / "paint.exr", pixels, "half")
    low = ((0, 0), (1, 0), (1, 0.36), (0, 0.36))
    high = ((0, 0.64), (1, 0.64), (1, 0.99), (0, 0.99))
    first = cycles.shown_on(image, low, "First")
    second = cycles.shown_on(image, high, "Second")
    second.data.materials[0] = first.data.materials[0]
    first.data.materials[0].node_tree.nodes["Image Texture"].extension = "EXTEND"
    for obj in (first, second):
        obj.select_set(False)
    bake()
    stored = cycles.level(cycles.cache_file(tmp_path), 4)[..., :3]
    np.testing.assert_allclose(stored[0], np.broadcast_to(GREEN, (4, 3)), atol=0.03)
    np.testing.assert_allclose(stored[3], np.broadcast_to(BLUE, (4, 3)), atol=0.03)
    second.hide_render = True
    bake()
    stored = cycles.level(cycles.cache_file(tmp_path), 4)[..., :3]
    np.testing.assert_allclose(stored[3], np.broadcast_to(GREEN, (4, 3)), atol=0.03)


def test_two_images_of_a_file_share_their_surfaces(scene, tmp_path):
    pixels = np.zeros((64, 64, 3), np.float32)
    pixels[:] = MAGENTA
    pixels[:, :20] = GREEN
    pixels[:, 44:] = BLUE
    first = cycles.write_picture(tmp_path / "paint.exr", pixels, "half")
    second = bpy.data.images.load(str(tmp_path / "paint.exr"), check_existing=False)
    assert first != second
    cycles.shown_on(first, ((0, 0), (0.3, 0), (0.3, 1), (0, 1)), "First")
    cycles.shown_on(second, ((0.7, 0), (1, 0), (1, 1), (0.7, 1)), "Second")
    for obj in bpy.data.objects:
        if obj.type == "MESH":
            obj.data.materials[0].node_tree.nodes["Image Texture"].extension = "EXTEND"
    bake()
    stored = cycles.level(cycles.cache_file(tmp_path), 4)[..., :3]
    np.testing.assert_allclose(stored[:, 0], np.broadcast_to(GREEN, (4, 3)), atol=0.03)
    np.testing.assert_allclose(stored[:, 3], np.broadcast_to(BLUE, (4, 3)), atol=0.03)


def test_color_spaces_of_a_file_have_a_cache_file_each(scene, tmp_path, capfd):
    first = cycles.write_picture(tmp_path / "paint.png", smooth(64, 64, 3), "uint8")
    second = bpy.data.images.load(str(tmp_path / "paint.png"), check_existing=False)
    second.colorspace_settings.name = "Non-Color"
    cycles.shown_on(first, name="First")
    cycles.shown_on(second, name="Second")
    bake()
    assert len(cycles.cache_files(tmp_path)) == 2
    assert "2 images (2 files), over 2 objects" in capfd.readouterr().out


def test_tiles_are_weighted_by_their_own_surfaces(scene, tmp_path):
    image = udim(tmp_path)
    squares = [
        ((0, 0), (1, 0), (1, 0.49), (0, 0.49)),
        ((1, 0.51), (2, 0.51), (2, 1), (1, 1)),
    ]
    obj = scenes.quads("Tiled", squares)
    obj.data.materials.append(cycles.emission("Tiled", image))
    obj.data.materials[0].node_tree.nodes["Image Texture"].extension = "EXTEND"
    bake()
    for number, color in ((1001, GREEN), (1002, BLUE)):
        stored = cycles.level(cycles.cache_file(tmp_path, f"paint.{number}"), 4)[..., :3]
        np.testing.assert_allclose(stored, np.broadcast_to(color, stored.shape), atol=0.03)


def test_nan_in_the_image_stays_there(scene, tmp_path):
    pixels = smooth(64, 64, 3)
    pixels[10, 10] = np.nan
    cycles.shown_on(cycles.write_picture(tmp_path / "paint.exr", pixels, "float"))
    assert bake() == {"FINISHED"}
    for number in range(1, 7):
        assert np.isfinite(cycles.level(cycles.cache_file(tmp_path), number)).all()


@pytest.mark.parametrize("is_absolute", [False, True])
def test_the_folder_of_the_preferences_is_used(scene, tmp_path, is_absolute):
    folder = tmp_path / "cache" / "of textures"
    paths = bpy.context.preferences.filepaths
    paths.texture_cache_directory = str(folder) if is_absolute else "cache/of textures"
    try:
        cycles.shown_on(cycles.write_picture(tmp_path / "paint.png", smooth(64, 64, 3), "uint8"))
        generate()
        (path,) = folder.glob("*.tx")
        before = path.read_bytes()
        bake()
        assert list(folder.iterdir()) == [path]
        assert path.read_bytes() != before
        assert not (tmp_path / "blender_tx").exists()
    finally:
        paths.texture_cache_directory = ""


def test_instances_count(scene, tmp_path):
    pixels = np.zeros((64, 64, 3), np.float32)
    pixels[:] = GREEN
    image = cycles.write_picture(tmp_path / "paint.exr", pixels + smooth(64, 64, 3), "half")
    source = cycles.shown_on(image)
    scenes.collection_instance(source)
    found = bpy.data.objects["Quad"]
    for collection in list(found.users_collection):
        if collection == scene.collection:
            collection.objects.unlink(found)
    assert bake() == {"FINISHED"}


def test_the_command(tmp_path, scene):
    cycles.shown_on(cycles.write_picture(tmp_path / "paint.png", smooth(64, 64, 3), "uint8"))
    scene.render.use_texture_cache = False
    blend = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    result = run("bake-cache", blend, "--save", "--scene", scene.name)
    assert result.returncode == 0, result.stderr
    assert "texture cache of 1 image (1 file), over 1 object" in result.stdout
    level = cycles.level(cycles.cache_file(tmp_path), 1)
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert bpy.context.scene.render.use_texture_cache
    bake()
    np.testing.assert_array_equal(cycles.level(cycles.cache_file(tmp_path), 1), level)
    for arguments, message in (
        (("scene.glb",), "found 'scene.glb'; allowed: .blend"),
        ((tmp_path / "none.blend",), "there is no file"),
        ((blend, "--scene", "Other"), "no scene named 'Other'"),
    ):
        result = run("bake-cache", *arguments)
        assert result.returncode in (1, 2)
        assert message in result.stderr
        assert "Traceback" not in result.stderr


def test_tasks_make_what_the_whole_makes(scene, tmp_path):
    for seed, name in enumerate(("one", "two", "same")):
        path = tmp_path / f"{'one' if name == 'same' else name}.png"
        image = cycles.write_picture(path, smooth(64, 64, 3, seed=seed % 2), "uint8")
        if name == "same":
            image.colorspace_settings.name = "Non-Color"
        cycles.shown_on(image, name=name)
    blend = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    tasks = json.loads(run("bake-cache", blend, "--list", "--json").stdout.splitlines()[-1])
    assert [task["inputs"] for task in tasks["tasks"]] == [
        [str(tmp_path / f"{name}.png")] for name in ("one", "two")
    ]
    assert not cycles.cache_files(tmp_path)
    assert run("bake-cache", blend).returncode == 0
    whole = {path: path.read_bytes() for path in cycles.cache_files(tmp_path)}
    assert len(whole) == 3
    for path in whole:
        path.unlink()
    for number, count in ((2, 1), (3, 1), (1, 3)):
        result = run("bake-cache", blend, "--task", f"{number}/3")
        assert result.returncode == 0, result.stderr
        assert len(cycles.cache_files(tmp_path)) == count
    assert {path: path.read_bytes() for path in cycles.cache_files(tmp_path)} == whole
    for flags in (("--save", "--task", "1/2"), ("--unpack", "--list")):
        assert_fails(run("bake-cache", blend, *flags), flags[0], status=2)


@pytest.mark.parametrize(("ending", "kind"), [("png", "uint8"), ("exr", "half")])
def test_up_to_date_files_are_left_alone(scene, tmp_path, ending, kind):
    pixels = smooth(64, 64, 3)
    cycles.shown_on(cycles.write_picture(tmp_path / f"paint.{ending}", pixels, kind))
    blend = tmp_path / "scene.blend"

    def made(*flags):
        bpy.ops.wm.save_as_mainfile(filepath=str(blend))
        before = {path: path.stat().st_ino for path in cycles.cache_files(tmp_path)}
        result = run("bake-cache", blend, *flags)
        assert result.returncode == 0, result.stderr
        bpy.ops.wm.open_mainfile(filepath=str(blend))
        (path,) = cycles.cache_files(tmp_path)
        is_made = path.stat().st_ino != before.get(path)
        assert is_made != ("; 1 up to date" in result.stdout)
        return is_made

    skips = "--skip-up-to-date"
    assert made()
    plain = contents(tmp_path)[cycles.cache_file(tmp_path)]
    assert made(skips)
    level = cycles.level(cycles.cache_file(tmp_path), 1)
    assert not made(skips)
    bpy.data.objects["Quad"].data.vertices[0].co.x -= 2.0
    assert made(skips)
    assert not made(skips)
    bpy.data.objects["Quad"].data.vertices[0].co.x += 2.0
    assert made()
    assert contents(tmp_path)[cycles.cache_file(tmp_path)] == plain
    np.testing.assert_array_equal(cycles.level(cycles.cache_file(tmp_path), 1), level)


def test_results_do_not_depend_on_threads(scene, tmp_path, addon):
    cycles.shown_on(cycles.write_picture(tmp_path / "paint.png", smooth(128, 64, 4), "uint8"))
    module = addon("texture_cache.bake")
    found = []
    for threads in (1, 2, 5):
        job = module.CacheBake.read(scene, scenes.depsgraph(), threads=threads)
        job.compute(lambda _: True)
        job.write()
        found.append(cycles.cache_file(tmp_path).read_bytes())
    assert found[0] == found[1] == found[2]
