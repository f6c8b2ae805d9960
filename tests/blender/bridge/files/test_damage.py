# SPDX-License-Identifier: GPL-3.0-or-later

"""Files that Blender cannot load: one line says why, and Blender itself goes on."""

import importlib
import random

import bpy
import pytest
from command_line import assert_fails, run

KINDS = (".ply", ".stl", ".obj", ".glb", ".gltf", ".fbx", ".blend")


@pytest.fixture
def files(tmp_path):
    """A ball in each kind of file."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
    exporters = importlib.import_module(
        "bl_ext.user_default.prefilter.bridge.files.scenes"
    ).EXPORTERS
    for ending in KINDS:
        path = tmp_path / f"whole{ending}"
        if ending == ".blend":
            bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
        else:
            exporters[ending].export(path, is_selection=True)
    return tmp_path


def damages(data, ending):
    """Yields truncated and wrong contents; a cut FBX file may make Blender run out of memory."""
    yield from (b"", bytes(100), b"hello\n", bytes(range(256)) * 2, b"{}", b"ply\n")
    yield from (data[:count] for count in (3, 40, 84, 200, len(data) // 2))
    generator = random.Random(1)
    for _ in range(0 if ending == ".fbx" else 6):
        damaged = bytearray(data)
        for _ in range(5):
            damaged[generator.randrange(min(len(data), 400))] = generator.randrange(256)
        yield bytes(damaged)


@pytest.mark.parametrize("ending", KINDS)
def test_one_line_says_what_is_wrong(files, ending):
    path = files / f"bad{ending}"
    for data in damages((files / f"whole{ending}").read_bytes(), ending):
        path.write_bytes(data)
        result = run("voxelize", path, "-o", files / "out.ply", "--depth", 3)
        told = [line for line in result.stderr.splitlines() if "%" not in line]
        assert all(line.startswith("prefilter: ") for line in told)
        assert "Traceback" not in result.stdout
        if result.returncode:
            assert_fails(result)
            for word in ("json", "Traceback", "Error:", "DNA"):
                assert word not in told[-1]


def test_a_file_beside_it_that_is_missing_is_named(files):
    (buffer,) = files.glob("*.bin")
    buffer.unlink()
    result = run("voxelize", files / "whole.gltf", "-o", files / "out.ply", "--depth", 3)
    assert_fails(result, f"the file '{buffer.name}' beside it is missing")
