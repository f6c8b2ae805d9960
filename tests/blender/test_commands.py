# SPDX-License-Identifier: GPL-3.0-or-later

"""`blender --background --command prefilter ...`, in a Blender of its own."""

import json

import bpy
import numpy as np
import OpenImageIO as oiio
import scenes
from command_line import assert_fails, run, run_blender


def test_a_blender_of_its_own_does_what_this_one_does(tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(16, 16)))
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    results = [
        runner("bake", path.name, "--output", name, cwd=tmp_path)
        for runner, name in ((run, "here.tif"), (run_blender, "there.tif"))
    ]
    here, there = (
        oiio.ImageBuf(str(tmp_path / name), 0, 1).get_pixels("float")
        for name in ("here.tif", "there.tif")
    )
    np.testing.assert_array_equal(here, there)
    assert [result.returncode for result in results] == [0, 0]
    # Blender 5.2 also prints the names of files that it reads.
    told = results[0].stdout.splitlines()[-1]
    assert told.replace("here.tif", "there.tif") in results[1].stdout.splitlines()
    ours = [
        [line for line in result.stderr.splitlines() if line.startswith("prefilter: ")]
        for result in results
    ]
    assert ours[0] == ours[1]
    assert ours[0]


def test_its_exit_status_is_that_of_the_command(tmp_path):
    assert_fails(run_blender("bake", tmp_path / "none.blend", "--save"), "none.blend")
    assert_fails(run_blender("bake", "none.blend", "--frames=5"), "--frames", status=2)


def test_standard_output_is_the_list_alone(tmp_path):
    """Whatever Blender and its importer print."""
    scenes.textured_quad(scenes.image("Paint", scenes.noise(16, 16)))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.export_scene.gltf(filepath=str(tmp_path / "scene.glb"))
    flags = ("--all", "--list", "--json", "--material", "Quad material")
    result = run_blender("bake", tmp_path / "scene.blend", *flags)
    assert result.returncode == 0, result.stderr
    ((task,),) = (json.loads(result.stdout)["tasks"],)
    assert [image["image"] for image in task["images"]] == ["Paint"]
    help_text = run_blender("bake", "--help")
    assert help_text.returncode == 0
    assert "usage: " in help_text.stdout
