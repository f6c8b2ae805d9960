# SPDX-License-Identifier: GPL-3.0-or-later

"""The job templates in the zip: for Open Job Description, and for Flamenco 3.

PREFILTER_OPENJD is the program `openjd`, PREFILTER_BLENDER_COMMAND one that starts a Blender with
the extension; scripts/test sets both, for two Blenders. Tests that need a missing one are skipped.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from jobs import (
    BLENDER,
    FARM,
    contents,
    has_texture_cache,
    needs_blender,
    run,
    write_ball,
    write_model,
    write_scene,
)

HERE = Path(__file__).parent
OPENJD = os.environ.get("PREFILTER_OPENJD", "")
TEMPLATES = sorted((FARM / "openjd").glob("*.yaml"))
JOB_TYPES = sorted((FARM / "flamenco").glob("*.js"))

needs_openjd = pytest.mark.skipif(not OPENJD, reason="openjd-cli is not installed")


def run_template(name: str, step: str, **parameters: object) -> str:
    """Runs all tasks up to a step of a template, and returns the log, with reports of progress."""
    template = FARM / "openjd" / f"{name}.yaml"
    values = {"Blender": BLENDER, **parameters}
    given = [word for key, value in values.items() for word in ("-p", f"{key}={value}")]
    return run(OPENJD, "run", template, "--step", step, "--run-dependencies", *given)


def compiled(name: str, **settings: object) -> dict[str, Any]:
    """Returns the tasks of a job type of Flamenco."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    done = subprocess.run(
        [node, str(HERE / "compile_job.js"), str(FARM / "flamenco" / f"{name}.js")],
        input=json.dumps(settings),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def commands(job: dict[str, Any]) -> list[list[str]]:
    """Returns the command of each task."""
    found = []
    for task in job["tasks"]:
        assert task["type"] == "blender"
        (command,) = task["commands"]
        assert command["name"] == "exec"
        found.append([command["parameters"]["exe"], *command["parameters"]["args"]])
    return found


@needs_openjd
@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.stem)
def test_templates_are_valid(path):
    assert "passes validation" in run(OPENJD, "check", path)


@needs_openjd
@needs_blender
def test_a_bake_of_two_images(tmp_path):
    model = write_model(tmp_path)
    prefilter = (BLENDER, "--background", "--command", "prefilter")
    flags = ("--all", "--skip-up-to-date", "--output")
    run(*prefilter, "bake", model, *flags, tmp_path / "whole")
    whole = contents(tmp_path / "whole")
    assert whole.keys() == {"paint0.ktx2", "paint1.ktx2"}
    log = run_template("bake", "Bake", Model=model, Textures=tmp_path / "tasks", Tasks=2)
    assert contents(tmp_path / "tasks") == whole
    assert log.count("openjd_progress: 100.0") == 2
    assert log.count("openjd_status: Baked 'paint") == 2


@needs_openjd
@needs_blender
def test_a_surface_of_a_million_points(tmp_path):
    (tmp_path / "points").mkdir()
    for number in range(2):
        write_ball(tmp_path / "points" / f"{number}.ply", 500_000, number)
    surface = tmp_path / "surface.ply"
    places = {"Points": tmp_path / "points", "Surface": surface, "Work": tmp_path / "work"}
    log = run_template("reconstruct", "Join", Depth=6, Parts=2, Tasks=1, **places)
    assert log.count("openjd_status: Step ") == 2 + 2 + 1 + 2
    assert "openjd_status: Reconstructed 'surface.ply'" in log
    assert surface.read_bytes().startswith(b"ply\n")


@needs_openjd
@needs_blender
def test_the_texture_cache_of_a_scene(tmp_path):
    if not has_texture_cache():
        pytest.skip("this Blender has no texture cache")
    scene = write_scene(tmp_path)
    log = run_template("texture_cache", "TurnOn", Scene=scene, Tasks=2)
    assert log.count("openjd_progress: 100.0") == 3
    files = [path for path in tmp_path.rglob("*.tx") if b"PrefilterInputs=" in path.read_bytes()]
    assert len(files) == 2
    shown = "import bpy; assert bpy.context.scene.render.use_texture_cache"
    run(BLENDER, "--background", scene, "--python-exit-code", "1", "--python-expr", shown)


def test_flamenco_bakes_an_image_a_task():
    job = compiled("prefilter-bake", blendfile="a b.blend", textures="/out", tasks=3)
    start = ["{blender}", "--background", "--command", "prefilter", "bake", "a b.blend", "--all"]
    more = ["--output", "/out", "--format", "ktx2", "--skip-up-to-date", "--task"]
    assert commands(job) == [[*start, *more, f"{number}/3"] for number in (1, 2, 3)]
    assert not any(task["dependencies"] for task in job["tasks"])


def test_flamenco_turns_the_cache_on_at_the_end():
    job = compiled("prefilter-texture-cache", blendfile="a.blend", tasks=2)
    start = ["{blender}", "--background", "--command", "prefilter", "bake-cache", "a.blend"]
    start.append("--skip-up-to-date")
    assert commands(job) == [
        [*start, "--task", "1/2"],
        [*start, "--task", "2/2"],
        [*start, "--save"],
    ]
    assert [task["dependencies"] for task in job["tasks"]] == [[], [], ["bake-1", "bake-2"]]


def test_flamenco_reconstructs_in_steps():
    places = {"points": "scans", "surface": "scan.ply", "work": "/work"}
    job = compiled("prefilter-reconstruct", **places, depth=11, parts=32, tasks=2)
    start = ["{blender}", "--background", "--command", "prefilter", "reconstruct"]
    start += ["scans", "--output", "scan.ply", "--depth", "11", "--memory-limit", "0"]
    start += ["--work", "/work", "--parts", "32", "--step"]
    runs = (("measure", 2), ("count", 2), ("merge", 1), ("part", 2), ("join", 1))
    assert commands(job) == [
        [*start, step, "--task", f"{number}/{count}"]
        for step, count in runs
        for number in range(1, count + 1)
    ]
    assert [task["dependencies"] for task in job["tasks"]] == [
        *([], []),
        *(["measure-1", "measure-2"], ["measure-1", "measure-2"]),
        ["count-1", "count-2"],
        *(["merge"], ["merge"]),
        ["part-1", "part-2"],
    ]


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("prefilter-bake", {"blendfile": "a.blend"}),
        ("prefilter-bake", {"blendfile": "a.blend", "textures": "o", "tasks": "3"}),
        ("prefilter-texture-cache", {"blendfile": "a.blend", "frames": "1"}),
    ],
)
def test_flamenco_refuses_what_a_job_type_does_not_know(name, settings):
    with pytest.raises(AssertionError, match="setting"):
        compiled(name, **settings)


def test_each_job_has_both_kinds():
    names = {path.stem for path in TEMPLATES}
    types = {path.stem.removeprefix("prefilter-").replace("-", "_") for path in JOB_TYPES}
    assert names == types == {"bake", "texture_cache", "reconstruct"}
