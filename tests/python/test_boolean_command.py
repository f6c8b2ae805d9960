# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `boolean` without Blender, against the package's functions."""

import os

import numpy as np
import prefilter
import pytest
from command_files import fails, run
from solids import box

trimesh = pytest.importorskip("trimesh", reason="scripts/decoders.txt is not installed")

CORNERS = {"a": ((0, 0, 0), (2, 2, 2)), "b": ((1, 1, 1), (3, 3, 3)), "c": ((0, 0, 1), (1, 1, 3))}
VOLUMES = {"union": 8 + 8 - 1, "intersection": 1, "difference": 8 - 1}


@pytest.fixture
def files(tmp_path):
    for name, corners in CORNERS.items():
        solid = box(*corners)
        mesh = trimesh.Trimesh(solid.positions, solid.triangles, process=False)
        mesh.export(tmp_path / f"{name}.ply")
    return tmp_path


def read(path):
    return trimesh.load_mesh(path, process=False)


@pytest.mark.parametrize("operation", VOLUMES)
def test_the_surface_is_that_of_the_package(files, capsys, operation):
    out = files / "out.ply"
    flags = ("--depth", "5", "--interpolant", "plane", "--adaptivity", "0", "--no-cleanup")
    names = (files / "a.ply", files / "b.ply")
    assert run("boolean", *names, "-o", out, "--operation", operation, *flags) == 0
    told = capsys.readouterr().out
    assert f"{operation.capitalize()} of 'a' with 'b' in 32³ cells: " in told
    within = {"union": ((0,) * 3, (3,) * 3), "intersection": ((1,) * 3, (2,) * 3)}
    low, high = within.get(operation, CORNERS["a"])
    bounds = prefilter.cube_around((np.array(low, float), np.array(high, float)), depth=5)
    solids = [box(*CORNERS[name]) for name in "ab"]
    trees = [
        prefilter.voxelize(one.positions, one.triangles, depth=5, bounds=bounds, thickness=1.5)
        for one in solids
    ]
    tree = getattr(trees[0], operation)(trees[1])
    assert tree.volume == pytest.approx(VOLUMES[operation], rel=0.02)
    expected, faces = tree.contour(interpolant="plane", adaptivity=0.0, cleanup=False)
    found = read(out)
    assert len(found.faces) == len(faces)
    np.testing.assert_allclose(found.vertices, expected, atol=1e-6)


def test_the_volume_is_that_of_the_result(tmp_path, capsys):
    """Cells keep a film where faces coincide; the surface and the volume do not."""
    for name, size in {"plate": (4, 4, 1), "hole": (2, 2, 1)}.items():
        trimesh.creation.box(size).export(tmp_path / f"{name}.ply")
    files = (tmp_path / "plate.ply", tmp_path / "hole.ply", "-o", tmp_path / "out.ply")
    for depth in (6, 7):
        assert run("boolean", *files, "--operation", "difference", "--depth", depth) == 0
        told = float(capsys.readouterr().out.split("volume ")[1])
        assert told == pytest.approx(12, rel=0.005)
        assert told == pytest.approx(trimesh.load_mesh(tmp_path / "out.ply").volume, rel=0.001)


def test_meshes_of_one_file_as_operands(files):
    scene = trimesh.Scene()
    for name in CORNERS:
        scene.add_geometry(read(files / f"{name}.ply"), node_name=name, geom_name=name)
    scene.export(files / "scene.glb")
    chosen = ("--object", "b", "--object", "a", "--voxel-size", "0.1")
    assert run("boolean", files / "scene.glb", *chosen, "-o", files / "b.stl") == 0
    made = trimesh.load_mesh(files / "b.stl")
    assert made.is_watertight
    assert made.volume == pytest.approx(7, rel=0.02)
    # All meshes of a file together are one operand.
    command = ("boolean", files / "scene.glb", files / "b.ply", "--voxel-size", "0.1")
    assert run(*command, "-o", files / "rest.stl") == 0
    made = trimesh.load_mesh(files / "rest.stl")
    # a and c without b: 7, and 2 of which 1 is in a.
    assert made.volume == pytest.approx(8, rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("a.ply", "-o", "o.ply"), 2, "FILE: give two files or more"),
        (("a.ply", "--object", "a", "-o", "o.ply"), 2, "FILE: give two files or more"),
        (("a.ply", "b.txt", "-o", "o.ply"), 2, "b.txt"),
        (("a.ply", "b.ply", "-o", "o.vdb"), 2, "o.vdb"),
        (("a.ply", "b.ply"), 2, "-o"),
        (("a.ply", "b.ply", "-o", "missing/o.ply"), 1, "there is no folder"),
        (("a.ply", "missing.ply", "-o", "o.ply"), 1, "there is no file 'missing.ply'"),
        (
            ("a.ply", "b.ply", "--object", "d", "--object", "a", "-o", "o.ply"),
            1,
            "--object: found no mesh 'd'",
        ),
        (
            ("far.ply", "a.ply", "--operation", "intersection", "-o", "o.ply"),
            1,
            "the objects have nothing in common",
        ),
    ],
)
def test_refusals(files, monkeypatch, capsys, arguments, status, words):
    monkeypatch.chdir(files)
    solid = box((9, 9, 9), (10, 10, 10))
    trimesh.Trimesh(solid.positions, solid.triangles, process=False).export("far.ply")
    before = sorted(os.listdir(files))
    assert words in fails(capsys, status, "boolean", *arguments)
    assert sorted(os.listdir(files)) == before


def test_nothing_is_left(files, capsys):
    line = fails(capsys, 1, "boolean", files / "a.ply", files / "a.ply", "-o", files / "o.ply")
    assert "the result is empty" in line
    assert not (files / "o.ply").exists()
