# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands `voxelize` and `boolean`, in a Blender of their own."""

import importlib.util

import bodies
import bpy
import numpy as np
import pytest
import scenes
from command_line import IMPORTERS, assert_fails, loaded, run
from mathutils import Matrix


@pytest.fixture
def sphere(tmp_path):
    """Writes an open sphere, and returns its file and its volume."""
    ball = bodies.sphere("Ball")
    bodies.without_faces(ball, 2)
    path = tmp_path / "ball.ply"
    for obj in bpy.context.scene.objects:
        obj.select_set(obj == ball)
    bpy.ops.wm.ply_export(filepath=str(path), export_selected_objects=True)
    return path, bodies.volume(ball)


@pytest.fixture
def blend(tmp_path):
    """Saves a .blend file with two cubes of volume 8 that overlap, and one that is hidden."""
    bodies.cube("Body")
    bodies.cube("Hole", location=(1, 0, 0))
    bodies.cube("Hidden", location=(0, 5, 0)).hide_set(True)
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.mark.parametrize("command", ["voxelize", "boolean"])
def test_help(command):
    result = run(command, "--help")
    assert result.returncode == 0
    assert result.stdout.startswith(f"usage: blender --background --command prefilter {command}")
    for word in ("--depth", "--voxel-size", "--interpolant", "--threads", "plane", "examples:"):
        assert word in result.stdout
    assert command in run("--help").stdout


@pytest.mark.parametrize("extension", IMPORTERS)
def test_formats(sphere, tmp_path, extension):
    path, volume = sphere
    target = tmp_path / f"out{extension}"
    result = run("voxelize", path, "-o", target, "--depth", 5)
    assert result.returncode == 0, result.stderr
    assert "Voxelized 'ball' in 32³ cells" in result.stdout
    assert "open edges; the result is closed" in result.stdout
    assert "100 %" in result.stderr
    left = {"ball.ply", target.name, "out.mtl", "out.bin"}
    assert {file.name for file in tmp_path.iterdir()} <= left
    (made,) = loaded(target).values()
    bodies.welded(made)
    assert bodies.is_closed(made)
    assert bodies.volume(made) == pytest.approx(volume, rel=0.05)


def test_openvdb_file(sphere, tmp_path):
    result = run("voxelize", sphere[0], "-o", tmp_path / "out.vdb", "--depth", 5)
    if not any(map(importlib.util.find_spec, ("openvdb", "pyopenvdb"))):
        assert_fails(result, "no Python module for OpenVDB")
        return
    assert result.returncode == 0, result.stderr
    assert {file.name for file in tmp_path.iterdir()} == {"ball.ply", "out.vdb"}
    made = bpy.data.volumes.new("Out")
    made.filepath = str(tmp_path / "out.vdb")
    assert made.grids.load()
    assert [grid.name for grid in made.grids] == ["density"]


def test_blend_in_place(blend):
    result = run(
        "voxelize", blend, "-o", blend, "--overwrite", "--object", "Hole", "--voxel-size", 0.1
    )
    assert result.returncode == 0, result.stderr
    assert "'Hole' in 32³ cells of 10 cm" in result.stdout
    line = "object 'Hole': parts: 1 before, 1 after; genus: 0 before, 0 after"
    assert line in result.stdout
    objects = loaded(blend)
    assert len(objects["Body"].data.vertices) == 8
    assert bodies.is_closed(objects["Hole"])
    assert bodies.volume(objects["Hole"]) == pytest.approx(8, rel=0.05)


def test_all_visible_objects(blend, tmp_path):
    result = run("voxelize", blend.name, "-o", "out.glb", "--depth", 4, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "Voxelized 2 objects" in result.stdout
    assert set(loaded(tmp_path / "out.glb")) == {"Body", "Hole"}


@pytest.mark.parametrize(
    ("operation", "volume"), [("difference", 4), ("union", 12), ("intersection", 4)]
)
def test_boolean_of_objects(blend, tmp_path, operation, volume):
    operands = ("--object", "Body", "--object", "Hole")
    target = tmp_path / "out.ply"
    result = run("boolean", blend, *operands, "--operation", operation, "-o", target, "--depth", 6)
    assert result.returncode == 0, result.stderr
    (made,) = loaded(target).values()
    assert bodies.volume(made) == pytest.approx(volume, rel=0.05)


def test_boolean_of_files(blend, sphere, tmp_path):
    path, volume = sphere
    target = tmp_path / "out.stl"
    result = run("boolean", blend, path, "--operation", "intersection", "-o", target)
    assert result.returncode == 0, result.stderr
    assert "Intersection with 'ball': 'scene' in 256³ cells" in result.stdout
    (made,) = loaded(target).values()
    assert bodies.volume(made) == pytest.approx(volume, rel=0.05)


def test_boolean_appends_blend_files(blend, sphere, tmp_path):
    path, _ = sphere
    target = tmp_path / "out.blend"
    result = run("boolean", path, blend, "--operation", "union", "-o", target)
    assert result.returncode == 0, result.stderr
    made = loaded(target)["ball"]
    assert bodies.volume(made) == pytest.approx(12, rel=0.05)


def blend_again(path, change):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    change()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def is_left_alone(*words):
    result = run(*words, "--depth", 3, "--skip-up-to-date")
    assert result.returncode == 0, result.stderr
    return "Up to date" in result.stdout


def test_up_to_date_files_are_skipped(blend, tmp_path):
    words = ("voxelize", blend, "-o", tmp_path / "out.glb")
    assert [is_left_alone(*words) for _ in range(2)] == [False, True]
    assert is_left_alone(*words, "--threads", 1)
    assert not is_left_alone(*words, "--object", "Hole")
    assert set(loaded(words[3])) == {"Hole"}
    blend_again(blend, lambda: bpy.data.objects["Body"].data.transform(Matrix.Scale(2, 4)))
    assert [is_left_alone(*words) for _ in range(2)] == [False, True]
    assert bodies.volume(loaded(words[3])["Body"]) == pytest.approx(64, rel=0.05)
    words[3].unlink()
    assert not is_left_alone(*words)


def test_materials_and_textures_decide(blend, tmp_path):
    texture = tmp_path / "texture.png"
    image = bpy.data.images.new("Texture", 2, 2)

    def paint(color):
        image.pixels.foreach_set(np.tile(color, 4).astype(np.float32))
        image.filepath_raw = str(texture)
        image.file_format = "PNG"
        image.save()

    def wear():
        material = scenes.material("Painted", bpy.data.images.load(str(texture)))
        bpy.data.meshes["Body"].materials.append(material)

    paint((1, 0, 0, 1))
    blend_again(blend, wear)
    words = ("voxelize", blend, "-o", tmp_path / "out.glb")
    assert [is_left_alone(*words) for _ in range(2)] == [False, True]
    image = bpy.data.images.new("Texture", 2, 2)
    paint((0, 1, 0, 1))
    assert [is_left_alone(*words) for _ in range(2)] == [False, True]


@pytest.mark.parametrize("extension", [".obj", ".ply", ".stl", ".glb"])
def test_files_store_the_fingerprint_of_their_sources(blend, tmp_path, extension):
    run("voxelize", blend, "-o", tmp_path / "made.obj", "--depth", 3)
    words = ("voxelize", tmp_path / "made.obj", "-o", tmp_path / f"out{extension}")
    assert [is_left_alone(*words) for _ in range(2)] == [False, True]
    assert set(loaded(words[3])) == {"Body", "Hole"} or extension in {".ply", ".stl"}
    (tmp_path / "made.mtl").write_text("newmtl other\n")
    assert not is_left_alone(*words)
    if extension == ".obj":
        words[3].with_suffix(".mtl").unlink()
        assert not is_left_alone(*words)


def test_layers_of_usd_may_be_elsewhere(blend, tmp_path):
    if not bpy.app.build_options.usd:
        pytest.skip("this Blender was built without USD")
    source = tmp_path / "made.usda"
    bpy.ops.wm.usd_export(filepath=str(source))
    for _ in range(2):
        assert not is_left_alone("voxelize", source, "-o", tmp_path / "out.ply")


def test_failures_leave_nothing(blend, tmp_path):
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    target = tmp_path / "out.ply"
    rows = [
        (("voxelize", tmp_path / "gone.ply", "-o", target), ["there is no file"], 1),
        (("voxelize", blend, "-o", tmp_path / "gone" / "out.ply"), ["there is no folder"], 1),
        (("voxelize", blend, "-o", tmp_path / "out.txt"), ["OUTPUT: found", "allowed: "], 2),
        (
            ("voxelize", blend, "-o", tmp_path / "out.fbx", "--skip-up-to-date"),
            ["found", ".glb"],
            2,
        ),
        (("voxelize", "image.png", "-o", target), ["FILE: found 'image.png'", "allowed: "], 2),
        (("voxelize", blend, "-o", target, "--depth", 13), ["--depth: found '13'", "1 to 12"], 2),
        (
            ("voxelize", blend, "-o", target, "--object", "Hidden"),
            ["no visible object with a surface named 'Hidden'", "'Body', 'Hole'"],
            1,
        ),
        (
            ("voxelize", blend, "-o", target, "--voxel-size", "0.0001"),
            ["object 'Body': Voxel Size: 0.0001", "the limit is 4096"],
            1,
        ),
        (("boolean", blend, "-o", target), ["give two files or more"], 2),
        (("boolean", blend, blend), ["-o"], 2),
    ]
    for arguments, words, status in rows:
        assert_fails(run(*arguments), *words, status=status)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_damaged_file(tmp_path):
    path = tmp_path / "bad.glb"
    path.write_bytes(b"no glTF")
    assert_fails(run("voxelize", path, "-o", tmp_path / "out.ply"), "cannot load", "bad.glb")
    assert not (tmp_path / "out.ply").exists()
