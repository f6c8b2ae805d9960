# SPDX-License-Identifier: GPL-3.0-or-later

"""Bakes of the texture cache: files that are left alone, and the messages about them."""

import os
import shutil
import sys
from pathlib import Path

import bpy
import cycles_scenes as cycles
import numpy as np
import prefilter
import pytest
import scenes
from cycles_scenes import (
    bake,
    contents,
    generate,
    packed_picture,
    smooth,
    udim,
)

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))

from bench.reliability import disk_full


def test_an_image_of_one_color_stays(scene, tmp_path, capfd):
    pixels = np.full((128, 128, 3), 0.5, np.float32)
    cycles.shown_on(cycles.write_picture(tmp_path / "flat.png", pixels, "uint8"))
    generate()
    before = contents(tmp_path)
    assert bake() == {"FINISHED"}
    assert contents(tmp_path) == before
    assert "1 of one color stay" in capfd.readouterr().out


def test_canceling_leaves_the_cache(scene, tmp_path, addon):
    for name in ("one.png", "two.png"):
        pixels = smooth(128, 128, 3, seed=len(name) + ord(name[0]))
        cycles.shown_on(cycles.write_picture(tmp_path / name, pixels, "uint8"), name=name)
    generate()
    before = contents(tmp_path)
    module = addon("texture_cache.bake")
    for most in (0.0, 0.3, 0.7, 0.999):
        job = module.CacheBake.read(scene, scenes.depsgraph())
        with pytest.raises(prefilter.Cancelled):
            job.compute(lambda fraction, most=most: fraction <= most)
        assert contents(tmp_path) == before


def test_no_space_leaves_the_cache(scene, tmp_path, addon, monkeypatch):
    for name in ("one.png", "two.png"):
        pixels = smooth(128, 128, 3, seed=len(name) + ord(name[0]))
        cycles.shown_on(cycles.write_picture(tmp_path / name, pixels, "uint8"), name=name)
    generate()
    before = contents(tmp_path)
    original = addon("bridge.files.tx")._write
    calls = []

    def full(writer, path, *rest):
        calls.append(path)
        if len(calls) > 10:
            raise OSError(f"cannot write '{path}': no space left")
        original(writer, path, *rest)

    monkeypatch.setattr(addon("bridge.files.tx"), "_write", full)
    with pytest.raises(RuntimeError, match="no space left"):
        bake()
    assert contents(tmp_path) == before


@pytest.mark.parametrize(("name", "kind"), [("paint.png", "uint8"), ("paint.exr", "float")])
@pytest.mark.parametrize("share", [0.0, 0.4, 0.9])
def test_incomplete_cache_files_are_made_again(scene, tmp_path, name, kind, share):
    cycles.shown_on(cycles.write_picture(tmp_path / name, smooth(256, 256, 3), kind))
    generate()
    assert bake() == {"FINISHED"}
    (made,) = tmp_path.glob("blender_tx/*.tx")
    expected = [cycles.level(made, number) for number in range(9)]
    made.unlink()
    generate()
    status = made.stat()
    os.truncate(made, int(share * status.st_size))
    os.utime(made, ns=(status.st_mtime_ns, status.st_mtime_ns))
    assert bake() == {"FINISHED"}
    for number, level in enumerate(expected):
        np.testing.assert_array_equal(level, cycles.level(made, number))


@pytest.mark.parametrize("pages", [0, 1, 2, 4, 6, 9, 12])
def test_a_full_disk_leaves_no_broken_cache(scene, tmp_path, addon, pages):
    pixels = np.random.default_rng(1).random((64, 64, 3)).astype(np.float32)
    pictures = [tmp_path / f"{i}.png" for i in range(2)]
    for picture in pictures:
        cycles.write_picture(picture, pixels, "uint8")
    used = sum(-(-picture.stat().st_size // 4096) for picture in pictures)
    with disk_full.disk(tmp_path, (used + 1 + pages) * 4096) as disk:
        if disk is None:
            pytest.skip("no disk can be mounted")
        for picture in pictures:
            copied = bpy.data.images.load(shutil.copy(picture, disk))
            cycles.shown_on(copied, name=picture.name)
        with pytest.raises(RuntimeError, match=r"cannot|full"):
            bake()
        for made in disk.glob("blender_tx/*"):
            addon("bridge.openimageio").check_whole(made, 7)


@pytest.mark.parametrize("has_cache", [False, True])
def test_a_read_only_folder_is_an_error(scene, tmp_path, has_cache):
    folder = tmp_path / "textures"
    folder.mkdir()
    cycles.shown_on(cycles.write_picture(folder / "paint.png", smooth(64, 64, 3), "uint8"))
    if has_cache:
        generate()
    locked = folder / "blender_tx" if has_cache else folder
    locked.chmod(0o555)
    before = contents(tmp_path)
    try:
        with pytest.raises(RuntimeError, match=r"'paint\.png'.*read-only"):
            bake()
        assert contents(tmp_path) == before
        assert has_cache or not (folder / "blender_tx").exists()
    finally:
        locked.chmod(0o755)


def test_images_without_a_file_are_skipped(scene, tmp_path, capfd):
    cycles.shown_on(cycles.write_picture(tmp_path / "good.png", smooth(64, 64, 3), "uint8"))
    made = bpy.data.images.new("Generated", 16, 16)
    packed = cycles.write_picture(tmp_path / "packed.png", smooth(64, 64, 3), "uint8")
    packed.pack()
    dirty = cycles.write_picture(tmp_path / "dirty.png", smooth(64, 64, 3), "uint8")
    dirty.pixels[0] = 0.25
    gone = cycles.write_picture(tmp_path / "gone.png", smooth(64, 64, 3), "uint8")
    (tmp_path / "gone.png").unlink()
    movie = cycles.write_picture(tmp_path / "frames.png", smooth(64, 64, 3), "uint8")
    movie.source = "SEQUENCE"
    broken = cycles.write_picture(tmp_path / "broken.png", smooth(64, 64, 3), "uint8")
    (tmp_path / "broken.png").write_bytes(b"no picture")
    for image in (made, packed, dirty, gone, movie, broken):
        cycles.shown_on(image, name=image.name)
    assert bake() == {"FINISHED"}
    output = capfd.readouterr().out
    for text in (
        "'Generated': found a generated image",
        "'packed.png' is packed: unpack it",
        "'dirty.png': has changes that are not in its file",
        "'gone.png': there is no file",
        "'frames.png': found an image sequence",
        "'broken.png': Blender cannot make a texture cache",
        "texture cache of 1 image (1 file), over 1 object",
    ):
        assert text in output
    assert [path.name.split(".")[0] for path in cycles.cache_files(tmp_path)] == ["good"]


def test_packed_images_are_unpacked_and_baked_in_one_step(scene, tmp_path, capfd):
    names = ("one", "two")
    for seed, name in enumerate(names):
        image, _ = packed_picture(tmp_path, f"{name}.png", smooth(64, 64, 3, seed=seed))
        image.name = name
        cycles.shown_on(image, name=name)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    with pytest.raises(RuntimeError) as caught:
        bake()
    lines = str(caught.value).splitlines()
    for name in names:
        (line,) = (line for line in lines if f"'{name}'" in line)
        assert "is packed: unpack it" in line
        assert len(line) < 80
    capfd.readouterr()
    assert bpy.ops.prefilter.bake_texture_cache(use_unpack=True) == {"FINISHED"}
    output = capfd.readouterr().out
    for name in names:
        assert f"image '{name}': unpacked into '{name}.png'" in output
        assert cycles.cache_file(tmp_path / "textures", f"{name}.png").is_file()
    assert "texture cache of 2 images (2 files)" in output


def test_a_tile_without_a_file_is_reported(scene, tmp_path):
    image = udim(tmp_path, missing=True)
    cycles.shown_on(image)
    with pytest.raises(RuntimeError, match=r"there is no file '.*paint\.1002\.exr'"):
        bake()
    assert not (tmp_path / "blender_tx").exists()


def of_objects(tree, node):
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Object"], node.inputs["Vector"])


def of_the_world(tree, node):
    del tree
    world = bpy.data.worlds.new("Sky")
    scenes.use_nodes(world)
    world.node_tree.nodes.new("ShaderNodeTexEnvironment").image = node.image
    bpy.context.scene.world = world


def of_a_curve(tree, node):
    del tree
    curve = bpy.data.curves.new("Rope", "CURVE")
    curve.materials.append(bpy.data.objects["Quad"].data.materials[0])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Rope", curve))
    assert node.image is not None


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (of_objects, "gets its coordinates from 'Texture Coordinate' (Object)"),
        (of_the_world, "the world 'Sky' shows it as an environment"),
        (of_a_curve, "object 'Rope' (curve) shows it"),
    ],
)
def test_images_with_other_users_keep_blenders_levels(scene, tmp_path, capfd, spoil, reason):
    cycles.shown_on(
        cycles.write_picture(tmp_path / "good.png", smooth(64, 64, 3), "uint8"), name="G"
    )
    image = cycles.write_picture(tmp_path / "paint.png", smooth(64, 64, 3, seed=9), "uint8")
    half = ((0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0))
    tree = cycles.shown_on(image, half).data.materials[0].node_tree
    spoil(tree, tree.nodes["Image Texture"])
    generate()
    path = cycles.cache_file(tmp_path, "paint.png")
    before = path.read_bytes()
    assert bake() == {"FINISHED"}
    assert path.read_bytes() == before
    output = capfd.readouterr().out
    assert f"'paint.png': {reason}" in output or reason in output
    assert "it keeps Blender's levels" in output


def test_nodes_must_agree_on_the_extension(scene, tmp_path):
    image = cycles.write_picture(tmp_path / "paint.png", smooth(64, 64, 3), "uint8")
    wide = ((-0.5, 0), (1.5, 0), (1.5, 1), (-0.5, 1))
    obj = cycles.shown_on(image, wide)
    node = obj.data.materials[0].node_tree.nodes["Image Texture"]
    node.extension = "MIRROR"
    with pytest.raises(
        RuntimeError,
        match="some UVs lie outside the image, where Image Texture nodes extend it by MIRROR",
    ):
        bake()
    node.extension = "CLIP"
    assert bake() == {"FINISHED"}
    cycles.shown_on(image, wide, "Other")
    with pytest.raises(RuntimeError, match=r"CLIP, REPEAT|REPEAT, CLIP"):
        bake()


def test_nothing_to_bake_says_why(scene, tmp_path):
    cycles.write_picture(tmp_path / "paint.png", smooth(64, 64, 3), "uint8")
    with pytest.raises(RuntimeError, match="no image texture to bake; it has no mesh"):
        bake()
    scenes.quads("Bare")
    with pytest.raises(RuntimeError, match=r"no material on a mesh that is rendered.*'Bare'"):
        bake()


def test_bad_geometry_is_reported(scene, tmp_path):
    image = cycles.write_picture(tmp_path / "paint.png", smooth(64, 64, 3), "uint8")
    obj = cycles.shown_on(image)
    obj.data.vertices[0].co.x = float("nan")
    with pytest.raises(RuntimeError, match=r"object 'Quad': .*positions"):
        bake()
    obj.data.vertices[0].co.x = 0
    for vertex in obj.data.vertices:
        vertex.co = (0, 0, 0)
    with pytest.raises(RuntimeError, match="no surface of the scene lies in it"):
        bake()
