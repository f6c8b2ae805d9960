# SPDX-License-Identifier: GPL-3.0-or-later

"""Which files Blender's commands write, and which ones they leave alone."""

import os
import subprocess

import bpy
import gltf_files
import pytest
import scenes
from command_line import assert_fails, run


@pytest.fixture
def model(tmp_path):
    """A textured object in a .blend file, with its picture beside it."""
    picture = tmp_path / "wood.png"
    gltf_files.write_png(picture, scenes.noise(8, 8)[..., :3])
    bpy.ops.mesh.primitive_plane_add()
    material = scenes.material("Wood", bpy.data.images.load(str(picture)))
    bpy.context.object.data.materials.append(material)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    return tmp_path / "scene.blend"


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_ambiguous_output_is_refused(model, tmp_path):
    (tmp_path / "kept.exr").write_bytes(b"kept")
    os.link(tmp_path / "wood.png", tmp_path / "hard.exr")
    before = contents(tmp_path)
    picture, mesh = tmp_path / "wood.png", tmp_path / "scene.blend"
    for arguments, words in (
        (["resize", picture, tmp_path / "kept.exr", "--percent", 50], ["'", "exists", "-o"]),
        (["resize", picture, "-o", tmp_path / "{nam}.png", "--percent", 50], ["{nam}", "{name}"]),
        (["bake", mesh, "-o", tmp_path / "{nam}.exr"], ["{nam}", "allowed: {name}"]),
        (["bake", mesh, "--all", "-o", tmp_path / "{nam}.exr"], ["{nam}", "allowed: {name}"]),
        (["bake", mesh, "-o", tmp_path / "{name}.exr"], ["needs --all"]),
        (["bake", mesh, "-o", tmp_path / "hard.exr"], ["is read", "--overwrite"]),
        (["plot", mesh, "-o", tmp_path / "wood.png"], ["is read"]),
        (["plot", mesh, "-o", tmp_path / "{name}.png"], ["allowed: none"]),
        (["voxelize", mesh, "-o", mesh, "--depth", 3], ["is read"]),
        (["voxelize", mesh, mesh, "--depth", 3], ["is read"]),
        (["boolean", mesh, mesh, "-o", mesh, "--depth", 3], ["is read"]),
        (["reconstruct", mesh, "-o", mesh, "--depth", 3], ["is read"]),
        (["sampling-table", "-o", tmp_path / "{x}.json"], ["{x}"]),
    ):
        assert_fails(run(*arguments), *words, status=2)
    assert contents(tmp_path) == before


def test_a_bake_has_the_short_flag(model, tmp_path):
    for flag in ("-o", "--output"):
        result = run("bake", model, flag, tmp_path / "out.exr", "--filter", "box")
        assert result.returncode == 0, result.stderr
    assert (tmp_path / "out.exr").exists()


@pytest.mark.parametrize("name", ["CON", "aux.png", "nul", "a:b", "what?", "dots...", "cafe\u0301"])
def test_names_of_images_become_names_of_files(tmp_path, addon, name):
    """Every system allows the names, and they stay distinct."""
    image = bpy.data.images.new(name, 4, 4)
    bpy.data.images.new("other", 4, 4)
    files = addon("textures.file_names")
    pattern = files.Pattern.of(str(tmp_path), ".exr")
    stem = os.path.basename(files.paths(pattern, [image])[0]).removesuffix(".exr")
    assert stem == addon("core.file_names").clean_name(stem)
    assert stem.split(".")[0].lower() not in ("con", "aux", "nul")
    assert not set(stem) & set('<>:"/\\|?*')
    assert "\u0301" not in stem


def test_names_that_are_alike_get_numbers(addon):
    clean_names = addon("core.file_names").clean_names
    assert clean_names(["a:b", "a?b", "A_B", "con"]) == ["a_b", "a_b_2", "A_B_3", "con_"]


def test_a_misspelt_place_in_a_panel_is_refused(model, tmp_path):
    with pytest.raises(RuntimeError, match=r"File: found the placeholder \{nam\}"):
        bpy.ops.prefilter.bake_mipmaps(
            image="wood.png", filter="box", filepath=str(tmp_path / "{nam}.exr"), result="file"
        )
    assert not (tmp_path / "{nam}.exr").exists()


@pytest.mark.skipif(os.name == "nt", reason="its shell has other words for that")
def test_a_pipe_that_nobody_reads(model, tmp_path):
    if not bpy.app.binary_path:
        pytest.skip("a module of Python is no program")
    words = f"'{bpy.app.binary_path}' --background --command prefilter resize wood.png -o out.png"
    words = f"set -o pipefail; {words} --percent 50 --progress json | true"
    done = subprocess.run(["bash", "-c", words], cwd=tmp_path, capture_output=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out.png").exists()
