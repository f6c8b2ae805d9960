# SPDX-License-Identifier: GPL-3.0-or-later

"""`bake --all` in tasks: each makes the same bytes as the whole bake."""

import json

import gltf_files
import pytest
import scenes
from command_line import assert_fails, run

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
    """Returns the images that each task bakes."""
    assert [task["task"] for task in tasks] == list(range(1, len(tasks) + 1))
    return [[one["image"] for one in task["images"]] for task in tasks]


@pytest.mark.parametrize("kind", ["ktx2", "png"])
def test_tasks_make_what_the_whole_makes(model, tmp_path, kind):
    flags = ("--format", kind)
    whole = bake(model, tmp_path / "whole", *flags)
    found = run("bake", model, "--all", "--output", tmp_path / "tasks", *flags, "--list", "--json")
    # In this process the importer's output from Python comes first.
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


def test_one_image_is_baked_with_its_partner(model, tmp_path):
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


def test_up_to_date_files_are_left_alone(model, tmp_path):
    """Depends on pixels, surfaces and settings, but not on names and times."""
    flags = ("--skip-up-to-date",)

    def baked(*more):
        before = {path.name: path.stat().st_ino for path in (tmp_path / "out").glob("*")}
        result = run("bake", model, "--all", "--output", tmp_path / "out", *flags, *more)
        assert result.returncode == 0, result.stderr
        made = {
            path.name.removesuffix(".ktx2")
            for path in (tmp_path / "out").glob("*.ktx2")
            if path.stat().st_ino != before.get(path.name)
        }
        assert f"Baked {len(made)} image" in result.stdout
        return made

    everything = {"albedo", "normal", "orm", "glow"}
    assert baked() == everything
    assert baked() == set()
    assert baked("--threads", "1", "--manifest", tmp_path / "m.json") == set()
    listed = json.loads((tmp_path / "m.json").read_text())["images"]
    assert {one["image"].removesuffix(".png") for one in listed} == everything
    gltf_files.write_png(tmp_path / "orm.png", scenes.noise(16, 16, seed=9)[..., :3])
    assert baked() == {"orm", "normal"}
    assert baked("--task", "1/3", "--filter", "box") <= everything
    assert baked("--effort", "fast") == everything
    (tmp_path / "out" / "glow.ktx2").write_bytes(b"")
    assert baked("--effort", "fast") == {"glow"}
    text = model.read_text()
    model.write_text(text.replace('"emissiveFactor"', '"name": "Other", "emissiveFactor"'))
    assert baked("--effort", "fast") == set()


@pytest.mark.parametrize("name", ["exr", "tif"])
def test_one_image_that_is_up_to_date(model, tmp_path, name):
    command = ("bake", model, "--image", "glow.png", "--output", tmp_path / f"o.{name}")
    for words in ("Baked 'glow.png'", "Up to date: '"):
        result = run(*command, "--skip-up-to-date")
        assert result.returncode == 0, result.stderr
        assert words in result.stdout
    for flags in (("--output", tmp_path / "o.dds"), ("--all", "--output", tmp_path / "o.glb")):
        result = run("bake", model, *flags, "--skip-up-to-date")
        assert_fails(result, "--skip-up-to-date", status=2)
