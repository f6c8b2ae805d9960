# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of meshes that a full disk cuts off are found, and the earlier file stays."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import bodies
import bpy
import clouds
import pytest
from command_line import IMPORTERS, loaded, run

SIMPLE = (".obj", ".ply", ".stl")


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """Mounts a file system of 60 kB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=60k", "tmpfs", str(folder)]
    if (
        sys.platform != "linux"
        or subprocess.run(mount, capture_output=True, check=False).returncode
    ):
        pytest.skip("no file system can be mounted here")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def exported(path: Path) -> Path:
    """Exports a cube and a ball of 482 vertices."""
    ball, cube = bodies.sphere("Ball"), bodies.cube("Body")
    for obj in bpy.context.scene.objects:
        obj.select_set(obj in {ball, cube})
    kind = path.suffix[1:]
    getattr(bpy.ops.wm, f"{kind}_export")(filepath=str(path), export_selected_objects=True)
    return path


@pytest.fixture
def check(addon):
    return addon("bridge.files.complete").check_whole


def counts() -> tuple[int, int]:
    meshes = [obj.data for obj in bpy.context.selected_objects]
    return sum(len(one.vertices) for one in meshes), sum(len(one.polygons) for one in meshes)


@pytest.mark.parametrize("ending", SIMPLE)
def test_whole_files_pass(check, tmp_path, ending):
    exported(tmp_path / f"out{ending}")
    check(tmp_path, *counts())


@pytest.mark.parametrize("ending", SIMPLE)
def test_files_cut_anywhere_are_detected(check, tmp_path, ending):
    path = exported(tmp_path / f"out{ending}")
    contents = path.read_bytes()
    cuts = {0, 1, 80, 84, len(contents) - 1, *range(0, len(contents), len(contents) // 40)}
    if ending == ".obj":
        cuts |= {place for place in range(len(contents)) if contents[place - 1 : place] == b"\n"}
        cuts = set(sorted(cuts)[:: max(1, len(cuts) // 100)]) | {max(cuts)}
    for cut in sorted(cuts):
        path.write_bytes(contents[:cut])
        with pytest.raises(OSError, match=rf"'out{ending}' was not written as a whole"):
            check(tmp_path, *counts())


@pytest.mark.parametrize("ending", SIMPLE)
def test_a_block_missing_inside_a_file_is_detected(check, tmp_path, ending):
    path = exported(tmp_path / f"out{ending}")
    contents = path.read_bytes()
    path.write_bytes(contents[:4096] + contents[8192:])
    with pytest.raises(OSError, match="was not written as a whole"):
        check(tmp_path, *counts())


@pytest.mark.parametrize(
    ("command", "ending"),
    [
        *(("voxelize", ending) for ending in IMPORTERS if ending != ".fbx"),
        ("boolean", ".ply"),
        *(("reconstruct", ending) for ending in (".ply", ".glb")),
    ],
)
def test_a_full_disk_keeps_the_earlier_file(tmp_path, small_disk, command, ending):
    if command == "reconstruct":
        points, normals = clouds.torus(5_000)
        source = tmp_path / "scan.ply"
        rows = [" ".join(map(str, (*p, *n))) for p, n in zip(points, normals, strict=True)]
        names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
        source.write_text(
            f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n{names}end_header\n"
            + "\n".join(rows)
            + "\n"
        )
        sources = [source]
    else:
        sources = [exported(tmp_path / "solid.ply")] * (1 if command == "voxelize" else 2)
    target = small_disk / f"old{ending}"
    target.write_bytes(b"earlier")
    more = ["--operation", "union"] if command == "boolean" else []
    more += [] if command == "reconstruct" else ["--adaptivity", 0]
    result = run(command, *sources, *more, "-o", target, "--depth", 5)
    # Blender itself prints the whole report of an exporter in Python.
    last = result.stderr.strip().splitlines()[-1]
    assert result.returncode == 1
    assert "error: " in last
    assert "No space left on device" in last or "was not written as a whole" in last
    assert target.read_bytes() == b"earlier"
    assert [path.name for path in small_disk.iterdir()] == [target.name]


@pytest.mark.parametrize("ending", SIMPLE)
def test_a_disk_with_room_gets_the_file(tmp_path, small_disk, ending):
    source, target = exported(tmp_path / "solid.ply"), small_disk / f"new{ending}"
    result = run("voxelize", source, target, "--depth", 3)
    assert result.returncode == 0, result.stderr
    assert loaded(target)
