# SPDX-License-Identifier: GPL-3.0-or-later

"""An empty Blender with the add-on enabled, for every test."""

import importlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import addon_utils
import bpy
import pytest
import scenes

# For texture_readers; behind this folder, as both have modules named scenes.
sys.path.append(str(Path(__file__).resolve().parents[1] / "python"))

HERE = Path(__file__).parent
PACKAGE = "bl_ext.user_default.prefilter"
# Arguments, numbers, files and windows of our own: the tests of these are the same whichever
# Blender runs them.
SAME_IN_ANY_BLENDER = {
    "bridge/files/test_engines.py",
    "bridge/test_wipe_window.py",
    "core/test_jobs.py",
    "core/test_queue.py",
    "textures/test_bad_inputs.py",
    "textures/test_bake_tasks.py",
    "textures/test_contents.py",
    "textures/test_mipmap_commands.py",
    "textures/test_reader.py",
    "textures/test_seams.py",
    "textures/view/test_canvas.py",
    "textures/view/test_errors.py",
    "images/test_perspective.py",
    "images/test_pins.py",
    "images/test_placement.py",
    "images/test_resample_commands.py",
    "images/test_resize_commands.py",
    "images/test_sampling_table_command.py",
    "points/test_scan_commands.py",
    "shapes/test_shape_commands.py",
    "test_nothing_lost.py",
    "voxels/test_voxel_commands.py",
}
TEXTURED = Path(__file__).resolve().parents[3] / "shared" / "data" / "textured"


def pytest_configure(config: pytest.Config) -> None:
    """Declares the marker, and checks that the list is of files that are there.

    What Blender is about to remove is not to be used.
    """
    config.addinivalue_line("markers", "once: the same whichever Blender runs it, so one does")
    config.addinivalue_line("markers", "window: needs a Blender with a window, which takes long")
    config.addinivalue_line("filterwarnings", "error:.*expected to be removed in Blender")
    missing = [name for name in SAME_IN_ANY_BLENDER if not (HERE / name).exists()]
    assert not missing, missing


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks the tests that one Blender runs for all, and the tests that need a window."""
    for item in items:
        if "display" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.window)
        if item.path.relative_to(HERE).as_posix() in SAME_IN_ANY_BLENDER:
            item.add_marker(pytest.mark.once)


@pytest.fixture(autouse=True)
def empty_blender() -> None:
    """Starts each test from an empty file, with the add-on and the preferences as installed.

    Blender unpacks the wheels of an extension whenever it is enabled, which takes longer than most
    tests do; so it stays enabled unless a test has changed the preferences.
    """
    preferences = bpy.context.preferences
    if PACKAGE in preferences.addons and not preferences.is_dirty:
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        return
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert addon_utils.enable(PACKAGE, default_set=True) is not None
    preferences.is_dirty = False


@pytest.fixture
def addon() -> Callable[[str], ModuleType]:
    """Returns a function that gives a module of the add-on by its name."""
    return lambda name: importlib.import_module(f"{PACKAGE}.{name}")


@pytest.fixture
def bake(addon: Callable[[str], ModuleType]) -> Callable[..., Any]:
    """Returns a function that bakes with the settings given as keywords."""

    def run(image, objects=(), *, all_faces=False, progress=lambda _: True, **settings):
        chosen = addon("textures.choices").Settings(**settings)
        bake_inputs = addon("textures.bake_inputs")
        request = bake_inputs.Request(
            image, list(objects), chosen, scenes.depsgraph(), all_faces=all_faces
        )
        job = bake_inputs.read(request)
        job.compute(progress)
        return job.write()

    return run


@pytest.fixture
def scene() -> bpy.types.Scene:
    """Returns the scene, set up for Cycles and its texture cache, which Blender has since 5.2."""
    if "use_texture_cache" not in bpy.types.RenderSettings.bl_rna.properties:
        pytest.skip("Blender 5.2 or later is needed")
    # It needs OpenImageIO's Python module, and test_smoke.py does without.
    importlib.import_module("cycles_scenes").set_up(bpy.context.scene)
    return bpy.context.scene


@pytest.fixture
def textured() -> Path:
    """Returns the folder of the gathered textured models."""
    if not TEXTURED.is_dir():
        pytest.skip(f"there is no {TEXTURED}")
    return TEXTURED


@pytest.fixture(scope="module")
def display(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Runs an X server without a screen, and returns the environment for programs to use it.

    FRAMEBUFFER is a file with the pixels of its screen; see `scenes.screen`.
    """
    folder = tmp_path_factory.mktemp("display")
    if shutil.which("Xvfb") is None:
        pytest.skip("there is no Xvfb")
    reading, writing = os.pipe()
    server = subprocess.Popen(
        [
            "Xvfb",
            *("-displayfd", str(writing), "-screen", "0", "1280x800x24", "-nolisten", "tcp"),
            *("-fbdir", str(folder)),
        ],
        pass_fds=[writing],
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    try:
        with os.fdopen(reading) as answer:
            number = answer.readline().strip()
        if not number:
            pytest.skip("Xvfb does not start")
        yield {"DISPLAY": f":{number}", "FRAMEBUFFER": str(folder / "Xvfb_screen0")}
    finally:
        server.terminate()
        server.wait()


@pytest.fixture(scope="module")
def in_window(display: dict[str, str]) -> Callable[[Path, Path], None]:
    """Returns a function that runs a session in a Blender with a window that nobody sees.

    It takes the session's program and the argument that this gets; the session has to end well.
    """

    if not bpy.app.binary_path:
        pytest.skip("a module of Python has no window")

    def run(session: Path, argument: Path) -> None:
        result = subprocess.run(
            [
                bpy.app.binary_path,
                "--factory-startup",
                "--enable-event-simulate",
                *("--window-geometry", "0", "0", "1280", "800"),
                *("--python", session, "--", argument),
            ],
            env={**os.environ, **display},
            capture_output=True,
            text=True,
            timeout=1500,
            check=False,
        )
        output = result.stdout + result.stderr
        assert result.returncode == 0, output
        assert "Traceback" not in output, output
        assert "Error:" not in output, output

    return run


@pytest.fixture(scope="module")
def found(
    request: pytest.FixtureRequest,
    in_window: Callable[[Path, Path], None],
    tmp_path_factory: pytest.TempPathFactory,
) -> Any:
    """Runs the session of a test module, its `SESSION`, once, and returns the results."""
    result = tmp_path_factory.mktemp("session") / "result.json"
    in_window(request.module.SESSION, result)
    return json.loads(result.read_text())
