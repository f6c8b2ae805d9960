# SPDX-License-Identifier: GPL-3.0-or-later

"""The job types, by a Flamenco Manager and two of its Workers.

PREFILTER_FLAMENCO is the folder with the programs flamenco-manager and flamenco-worker. Without it,
or without a Blender that has the extension, these tests are skipped.
"""

import json
import os
import shutil
import socket
import subprocess
import time
import urllib.request
from collections.abc import Callable, Iterator
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

FLAMENCO = os.environ.get("PREFILTER_FLAMENCO", "")
MANAGER_SETTINGS = """\
_meta: {{version: 3}}
database: flamenco-manager.sqlite
listen: 127.0.0.1:{port}
autodiscoverable: false
local_manager_storage_path: {folder}/manager
shared_storage_path: {folder}/shared
variables:
  blender:
    values: [{{platform: linux, value: "{blender}"}}]
"""
WORKER_SETTINGS = """\
manager_url: http://127.0.0.1:{port}/
task_types: [blender]
"""

pytestmark = [
    needs_blender,
    pytest.mark.skipif(not FLAMENCO, reason="PREFILTER_FLAMENCO names no folder with Flamenco"),
]

Call = Callable[..., dict[str, Any]]


def wait_for(condition: Callable[[], bool], seconds: float) -> None:
    """Waits until a condition holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"waited {seconds} s"
        time.sleep(0.3)


@pytest.fixture(scope="module")
def call(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Call]:
    """Calls a Manager that knows the job types and has two Workers."""
    folder = tmp_path_factory.mktemp("flamenco")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    # It looks for job types in the folder that it is in.
    manager = Path(shutil.copy(Path(FLAMENCO) / "flamenco-manager", folder))
    shutil.copytree(FARM / "flamenco", folder / "scripts")
    settings = MANAGER_SETTINGS.format(port=port, folder=folder, blender=BLENDER)
    (folder / "flamenco-manager.yaml").write_text(settings)

    def call(path: str, data: object = None) -> dict[str, Any]:
        request = urllib.request.Request(
            f"http://127.0.0.1:{port}/api/v3/{path}",
            data=None if data is None else json.dumps(data).encode(),
            headers={"Content-Type": "application/json"},
        )
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.loads(answer.read() or b"{}")

    def answers() -> bool:
        try:
            return bool(call("version"))
        except OSError:
            return False

    logs = [(folder / f"{name}.log").open("w") for name in ("manager", "worker1", "worker2")]
    started = [subprocess.Popen([manager], cwd=folder, stdout=logs[0], stderr=logs[0])]
    try:
        wait_for(answers, 60)
        for log in logs[1:]:
            home = folder / Path(log.name).stem
            home.mkdir()
            (home / "flamenco-worker.yaml").write_text(WORKER_SETTINGS.format(port=port))
            names = {"FLAMENCO_HOME": str(home), "FLAMENCO_WORKER_NAME": home.name}
            worker = Path(FLAMENCO) / "flamenco-worker"
            started.append(
                subprocess.Popen([worker], cwd=home, env=os.environ | names, stdout=log, stderr=log)
            )
        yield call
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait(timeout=60)
        for log in logs:
            log.close()


def submit(call: Call, name: str, **settings: object) -> str:
    job_type = call(f"jobs/type/{name}")
    job = {
        "name": name,
        "type": name,
        "type_etag": job_type["etag"],
        "priority": 50,
        "submitter_platform": "linux",
        "settings": {
            setting["key"]: setting["default"]
            for setting in job_type["settings"]
            if "default" in setting
        }
        | {
            key: str(value) if isinstance(value, Path) else value for key, value in settings.items()
        },
    }
    return str(call("jobs", job)["id"])


def statuses(call: Call, job: str) -> dict[str, str]:
    return {task["name"]: task["status"] for task in call(f"jobs/{job}/tasks")["tasks"]}


def finish(call: Call, job: str) -> list[str]:
    """Waits for a job to end, and returns its tasks, all of which must have succeeded."""

    def ended() -> bool:
        return call(f"jobs/{job}")["status"] in ("completed", "failed", "canceled")

    wait_for(ended, 600)
    tasks = statuses(call, job)
    assert set(tasks.values()) == {"completed"}, tasks
    return list(tasks)


def test_a_bake_of_two_images(call, tmp_path):
    model = write_model(tmp_path)
    flags = ("--all", "--skip-up-to-date", "--output")
    run(
        BLENDER, "--background", "--command", "prefilter", "bake", model, *flags, tmp_path / "whole"
    )
    job = submit(call, "prefilter-bake", blendfile=model, textures=tmp_path / "tasks", tasks=3)
    assert finish(call, job) == ["bake-1", "bake-2", "bake-3"]
    assert contents(tmp_path / "tasks") == contents(tmp_path / "whole")


def test_a_task_that_fails(call, tmp_path):
    job = submit(
        call, "prefilter-bake", blendfile=tmp_path / "none.blend", textures=tmp_path, tasks=1
    )
    wait_for(lambda: call(f"jobs/{job}")["status"] == "failed", 120)
    assert statuses(call, job) == {"bake-1": "failed"}


def test_a_surface_of_a_million_points_is_canceled_and_goes_on(call, tmp_path):
    points = tmp_path / "points"
    points.mkdir()
    for number in range(2):
        write_ball(points / f"{number}.ply", 500_000, number)
    whole, surface, work = tmp_path / "whole.ply", tmp_path / "surface.ply", tmp_path / "work"
    made = ("--background", "--command", "prefilter", "reconstruct", points)
    run(BLENDER, *made, "-o", whole, "--depth", "8")
    places = {"points": points, "surface": surface, "work": work}
    job = submit(call, "prefilter-reconstruct", **places, depth=8, parts=4, tasks=2)
    wait_for(lambda: statuses(call, job)["part-1"] == "active", 300)
    # Where a Worker says that it has begun a task only after its job is canceled, the Manager makes
    # the job active again.
    time.sleep(3)
    call(f"jobs/{job}/setstatus", {"status": "cancel-requested", "reason": "tests"})
    wait_for(lambda: call(f"jobs/{job}")["status"] == "canceled", 60)
    assert statuses(call, job)["join"] == "canceled"
    assert not surface.exists()
    call(f"jobs/{job}/setstatus", {"status": "requeueing", "reason": "tests"})
    tasks = finish(call, job)
    assert [name.split("-")[0] for name in tasks] == [
        *("measure", "measure", "count", "count", "merge", "part", "part", "join"),
    ]
    assert surface.read_bytes() == whole.read_bytes()
    assert not [path for path in work.iterdir() if path.name.startswith(".")]


def test_the_texture_cache_of_a_scene(call, tmp_path):
    if not has_texture_cache():
        pytest.skip("this Blender has no texture cache")
    scene = write_scene(tmp_path)
    job = submit(call, "prefilter-texture-cache", blendfile=scene, tasks=2)
    assert finish(call, job) == ["bake-1", "bake-2", "turn-on"]
    files = [path for path in tmp_path.rglob("*.tx") if b"PrefilterInputs=" in path.read_bytes()]
    assert len(files) == 2
    shown = "import bpy; assert bpy.context.scene.render.use_texture_cache"
    run(BLENDER, "--background", scene, "--python-exit-code", "1", "--python-expr", shown)
