# SPDX-License-Identifier: GPL-3.0-or-later

"""Files that Blender cannot load: one line says why, and Blender itself goes on."""

import importlib
import random
from pathlib import Path

import bpy
import numpy as np
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
        path = str(tmp_path / f"whole{ending}")
        if ending == ".blend":
            bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
        else:
            exporters[ending](path)
    return tmp_path


def damages(data, ending):
    """Yields what is left of a file; one of FBX may ask Blender for more memory than there is."""
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


def write_ply(path: Path, kind: str, faces: list[list[int]], *, is_listed_first: bool) -> None:
    """Writes four vertices, and faces with a value of their own before or behind the corners."""
    corners, value = "property list uchar int vertex_indices\n", "property short group\n"
    properties = corners + value if is_listed_first else value + corners
    head = f"ply\nformat {kind} 1.0\nelement vertex 4\n"
    head += "".join(f"property float {name}\n" for name in "xyz")
    head += f"element face {len(faces)}\n{properties}end_header\n"
    if kind == "ascii":
        rows = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"]
        for face in faces:
            words = " ".join(map(str, [len(face), *face]))
            rows.append(f"{words} 7" if is_listed_first else f"7 {words}")
        path.write_text(head + "\n".join(rows) + "\n")
        return
    order = "<" if "little" in kind else ">"
    data = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], f"{order}f4").tobytes()
    for face in faces:
        group = np.array([7], f"{order}i2").tobytes()
        listed = bytes([len(face)]) + np.array(face, f"{order}i4").tobytes()
        data += listed + group if is_listed_first else group + listed
    path.write_bytes(head.encode() + data)


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("is_listed_first", [False, True])
def test_ply_files_are_whole_or_not(tmp_path, kind, is_listed_first):
    package = "bl_ext.user_default.prefilter.bridge.files.ply_check"
    is_whole = importlib.import_module(package).is_whole
    path = tmp_path / "a.ply"
    for faces in ([[0, 2, 1], [0, 1, 3]], [[0, 2, 1], [0, 1, 3, 2]], [], [[0, 1, 2, 3]]):
        write_ply(path, kind, faces, is_listed_first=is_listed_first)
        data = path.read_bytes()
        assert is_whole(path)
        path.write_bytes(data[:-3])
        assert not is_whole(path)
    for face in ([0, 1, 4], [0, 1, -1]):
        write_ply(path, kind, [face], is_listed_first=is_listed_first)
        assert not is_whole(path)
