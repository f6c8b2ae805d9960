# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `voxelize`: its surfaces, against the package's functions."""

import numpy as np
import prefilter
import pytest
from command_files import fails, run
from solids import box

trimesh = pytest.importorskip("trimesh", reason="scripts/decoders.txt is not installed")


def corners_and_faces():
    """Returns the positions and the triangles of a box."""
    solid = box((0, 0, 0), (1, 2, 3))
    return solid.positions, solid.triangles


@pytest.fixture
def cube(tmp_path):
    positions, triangles = corners_and_faces()
    trimesh.Trimesh(positions, triangles, process=False).export(tmp_path / "cube.stl")
    return tmp_path / "cube.stl"


def read(path):
    return trimesh.load_mesh(path, process=False)


def test_the_surface_is_that_of_the_package(cube, tmp_path, capsys):
    out = tmp_path / "out.ply"
    flags = ("--depth", "5", "--interpolant", "plane", "--adaptivity", "0", "--no-cleanup")
    assert run("voxelize", cube, "-o", out, *flags) == 0
    told = capsys.readouterr().out
    assert "Voxelized 'cube' in 32³ cells of " in told
    positions, triangles = corners_and_faces()
    low, high = prefilter.cube_around((positions.min(axis=0), positions.max(axis=0)), depth=5)
    tree = prefilter.voxelize(positions, triangles, depth=5, bounds=(low, high), thickness=1.5)
    expected, faces = tree.contour(interpolant="plane", adaptivity=0.0, cleanup=False)
    found = read(out)
    assert len(found.faces) == len(faces)
    np.testing.assert_allclose(found.vertices, expected, atol=1e-6)


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "glb"])
def test_files(cube, tmp_path, ending):
    out = tmp_path / f"out.{ending}"
    assert run("voxelize", cube, "-o", out, "--voxel-size", "0.1") == 0
    made = trimesh.load_mesh(out)
    made.merge_vertices()
    assert made.is_watertight
    positions, _ = corners_and_faces()
    assert made.volume == pytest.approx(np.prod(np.ptp(positions, axis=0)), rel=0.02)


def test_each_mesh_by_itself(tmp_path, capsys):
    positions, triangles = corners_and_faces()
    scene = trimesh.Scene()
    for name, shift in (("A", 0.0), ("B", 5.0)):
        mesh = trimesh.Trimesh(np.asarray(positions) + shift, triangles, process=False)
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    scene.export(tmp_path / "two.glb")
    out = tmp_path / "out.glb"
    assert run("voxelize", tmp_path / "two.glb", "-o", out, "--depth", "4") == 0
    assert "Voxelized 2 objects: " in capsys.readouterr().out
    assert set(trimesh.load_scene(out).geometry) == {"A", "B"}
    assert run("voxelize", tmp_path / "two.glb", "-o", out, "--depth", "4", "--object", "B") == 0
    assert trimesh.load_scene(out).bounds[0].min() > 3


def test_meshes_of_which_nothing_is_left_are_left_out(tmp_path, capsys):
    positions, triangles = corners_and_faces()
    line = trimesh.Trimesh([[9, 0, 0], [9, 1, 0], [9, 2, 0]], [[0, 1, 2]], process=False)
    sheet = trimesh.Trimesh([[7, 0, 0], [7, 1, 0], [7, 2, 3]], [[0, 1, 2]], process=False)
    scene = trimesh.Scene()
    for name, mesh in {
        "Line": line,
        "Body": trimesh.Trimesh(positions, triangles, process=False),
        "Sheet": sheet,
    }.items():
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    scene.export(tmp_path / "three.glb")
    out = tmp_path / "out.glb"
    arguments = (tmp_path / "three.glb", out, "--depth", "4", "--thickness", "0")
    assert run("voxelize", *arguments) == 0
    assert set(trimesh.load_scene(out).geometry) == {"Body"}
    warnings = capsys.readouterr().err
    assert "warning: left out: object 'Line': all its faces have zero area" in warnings
    assert "warning: left out: object 'Sheet': the result is empty" in warnings
    out.unlink()
    assert run("voxelize", *arguments, "--object", "Line", "--object", "Sheet") == 1
    error = capsys.readouterr().err
    assert "error: object 'Line': all its faces have zero area; object 'Sheet': the" in error
    assert not out.exists()


def test_what_is_refused(cube, tmp_path, capsys):
    out = tmp_path / "out.ply"
    for words, arguments in {
        "FILE: found 'a.blend'": ("a.blend", out),
        "OUTPUT: found 'a.fbx'": (cube, "a.fbx"),
        "not allowed with argument --depth": (cube, out, "--depth", "4", "--voxel-size", "1"),
        "--depth: found '0'": (cube, out, "--depth", "0"),
    }.items():
        assert words in fails(capsys, 2, "voxelize", *arguments)
    assert "FILE: there is no file" in fails(capsys, 1, "voxelize", tmp_path / "no.stl", "-o", out)
    told = fails(capsys, 1, "voxelize", cube, "-o", out, "--voxel-size", "1e-5")
    assert "mesh 'cube': Voxel Size: 1e-05 would need" in told
    assert not out.exists()
