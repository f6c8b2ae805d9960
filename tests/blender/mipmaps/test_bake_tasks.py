# SPDX-License-Identifier: GPL-3.0-or-later

"""`bake --all` in tasks: each makes, byte for byte, what the whole makes."""

import json

import gltf_files
import pytest
import scenes
from command_line import assert_fails, run, run_blender

PAIR = ("normal.png", "orm.png")


@pytest.fixture
def model(tmp_path):
    """Writes a model with a color, a light, and a normal map with a roughness."""
    names = ("albedo.png", "orm.png", "normal.png", "glow.png")
    for seed, name in enumerate(names):
        gltf_files.write_png(tmp_path / name, scenes.noise(16, 16, seed=seed)[..., :3])
    material = {
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0},
            "metallicRoughnessTexture": {"index": 1},
        },
        "normalTexture": {"index": 2},
        "emissiveTexture": {"index": 3},
        "emissiveFactor": [1, 1, 1],
    }
    gltf_files.write(tmp_path / "model.gltf", [material], list(names))
    return tmp_path / "model.gltf"


def bake(model, folder, *arguments):
    result = run("bake", model, "--all", "--output", folder, *arguments)
    assert result.returncode == 0, result.stderr
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def images(tasks):
    """Returns what each task bakes."""
    assert [task["task"] for task in tasks] == list(range(1, len(tasks) + 1))
    return [[one["image"] for one in task["images"]] for task in tasks]


@pytest.mark.parametrize("kind", ["ktx2", "png"])
def test_tasks_make_what_the_whole_makes(model, tmp_path, kind):
    flags = ("--format", kind)
    whole = bake(model, tmp_path / "whole", *flags)
    found = run("bake", model, "--all", "--output", tmp_path / "tasks", *flags, "--list", "--json")
    # In this process Python's own lines of the importer are here too.
    tasks = json.loads(found.stdout.splitlines()[-1])["tasks"]
    assert sorted(map(sorted, images(tasks))) == [["albedo.png"], ["glow.png"], list(PAIR)]
    made: dict[str, bytes] = {}
    for task in reversed(tasks):
        files = {file for image in task["images"] for file in image["files"]}
        part = bake(model, tmp_path / "tasks", *flags, "--task", f"{task['task']}/{len(tasks)}")
        new = part.keys() - made.keys()
        assert files == {str(tmp_path / "tasks" / name) for name in new}
        assert not [name for name in made if part[name] != made[name]]
        made = part
    assert made == whole


def test_one_image_brings_what_it_is_baked_with(model, tmp_path):
    whole = bake(model, tmp_path / "whole")
    for name, expected in (("orm.png", PAIR), ("normal.png", PAIR), ("glow.png", ["glow.png"])):
        found = bake(model, tmp_path / name.removesuffix(".png"), "--image", name)
        files = [one.replace(".png", ".ktx2") for one in expected]
        assert found == {file: whole[file] for file in files}
    other = run("bake", model, "--all", "--output", tmp_path / "no", "--image", "Other")
    assert_fails(other, "--image", "'Other'", "'glow.png'")


def test_more_parts_than_images(model, tmp_path):
    result = run("bake", model, "--all", "--output", tmp_path / "out", "--task", "4/4")
    assert (result.returncode, result.stderr) == (0, "")
    assert "Nothing to do in part 4 of 4" in result.stdout
    assert not (tmp_path / "out").exists()


def test_an_image_that_is_missing_fails_in_its_own_task(model, tmp_path):
    whole = bake(model, tmp_path / "whole")
    (tmp_path / "glow.png").unlink()
    results = [
        run("bake", model, "--all", "--output", tmp_path / "tasks", "--task", f"{number}/3")
        for number in (1, 2, 3)
    ]
    assert sorted(result.returncode for result in results) == [0, 0, 1]
    assert any("'glow.png' is not baked" in result.stderr for result in results)
    left = {path.name: path.read_bytes() for path in (tmp_path / "tasks").iterdir()}
    assert left == {name: data for name, data in whole.items() if name != "glow.ktx2"}


def test_standard_output_is_the_list_alone(model):
    """Whatever Blender and its importer print."""
    result = run_blender("bake", model, "--all", "--list", "--json")
    assert result.returncode == 0, result.stderr
    assert len(images(json.loads(result.stdout)["tasks"])) == 3
