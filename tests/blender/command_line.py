# SPDX-License-Identifier: GPL-3.0-or-later

"""The command: in this Blender, which is quick, and in a Blender of its own."""

import contextlib
import importlib
import logging
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import bpy
import pytest

Result = subprocess.CompletedProcess[str]

IMPORTERS = {
    ".obj": "wm.obj_import",
    ".ply": "wm.ply_import",
    ".stl": "wm.stl_import",
    ".glb": "import_scene.gltf",
    ".gltf": "import_scene.gltf",
    ".fbx": "import_scene.fbx",
}
LOGGERS = ("glTFImporter", "glTFImporter_errors")
"""Loggers where a failed import leaves handlers, which keep writing to the import's stream."""


def run(*arguments: object, cwd: Path | None = None) -> Result:
    """Runs `prefilter ARGUMENTS` in this Blender, from the startup file like a new process.

    Afterward the file of the command is open.
    """
    addon = importlib.import_module("bl_ext.user_default.prefilter")
    words = [str(argument) for argument in arguments]
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        with _printing_to(out, err), contextlib.chdir(cwd or Path.cwd()):
            status = addon.Commands(addon.SUBJECTS).run(words)
        out.seek(0)
        err.seek(0)
        return Result(words, status, out.read(), err.read())


@contextlib.contextmanager
def _printing_to(out: IO[str], err: IO[str]) -> Iterator[None]:
    """Lets Python and Blender itself print to files."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(stream) for stream in (1, 2)]
    handlers = {name: list(logging.getLogger(name).handlers) for name in LOGGERS}
    os.dup2(out.fileno(), 1)
    os.dup2(err.fileno(), 2)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            yield
    finally:
        out.flush()
        err.flush()
        for stream, old in enumerate(kept, start=1):
            os.dup2(old, stream)
            os.close(old)
        for name, before in handlers.items():
            logging.getLogger(name).handlers[:] = before


def run_blender(*arguments: object, cwd: Path | None = None) -> Result:
    """Runs `blender --background --command prefilter ARGUMENTS`."""
    if not bpy.app.binary_path:
        pytest.skip("a module of Python is no program")
    return subprocess.run(
        [bpy.app.binary_path, "--background", "--command", "prefilter", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=600,
        cwd=cwd,
        check=False,
    )


def assert_fails(result: Result, *words: str, status: int = 1) -> None:
    """Asserts that a run ended with an error of one line that has all of the words."""
    assert result.returncode == status, result.stderr
    assert "Traceback" not in result.stdout + result.stderr
    last = result.stderr.strip().splitlines()[-1]
    assert "error: " in last
    for word in words:
        assert word in last


def loaded(path: Path) -> dict[str, bpy.types.Object]:
    """Opens or imports a file, and returns its mesh objects."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    if path.suffix == ".blend":
        bpy.ops.wm.open_mainfile(filepath=str(path))
    else:
        module, name = IMPORTERS[path.suffix].split(".")
        getattr(getattr(bpy.ops, module), name)(filepath=str(path))
    bpy.context.view_layer.update()
    return {obj.name: obj for obj in bpy.data.objects if obj.type == "MESH"}
