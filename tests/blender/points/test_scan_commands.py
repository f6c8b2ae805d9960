# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `reconstruct`: from file to file, in memory, and from .blend files."""

import os
import signal

import bodies
import bpy
import clouds
import numpy as np
import pytest
from command_line import assert_fails, loaded, run
from prefilter.commands import reporters

DEPTH = ("--depth", 6)


def write_ply(path, points, normals=None, colors=None):
    """Writes a binary PLY file."""
    columns = [(name, "<f8", "double") for name in "xyz"]
    values = list(points.T)
    if normals is not None:
        columns += [(name, "<f4", "float") for name in ("nx", "ny", "nz")]
        values += list(normals.T)
    if colors is not None:
        columns += [(name, "u1", "uchar") for name in ("red", "green", "blue")]
        values += list(colors.T)
    table = np.empty(len(points), [(name, kind) for name, kind, _ in columns])
    for (name, _, _), column in zip(columns, values, strict=True):
        table[name] = column
    header = "".join(f"property {kind} {name}\n" for name, _, kind in columns)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{header}"
    path.write_bytes(f"{head}end_header\n".encode() + table.tobytes())
    return path


def torus_colors(points):
    return np.clip(255 * (points + 2) / 4, 0, 255).astype(np.uint8)


@pytest.fixture
def scan(tmp_path):
    """Writes points of a torus with normals and colors."""
    points, normals = clouds.torus()
    return write_ply(tmp_path / "scan.ply", points, normals, torus_colors(points))


def assert_torus(path, within=0.1):
    (made,) = loaded(path).values()
    bodies.welded(made)
    assert bodies.is_closed(made)
    assert np.abs(clouds.torus_distance(clouds.vertices(made))).mean() < within
    assert bodies.volume(made) == pytest.approx(clouds.TORUS_VOLUME, rel=0.05)
    return made


def test_help():
    result = run("reconstruct", "--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage: blender --background --command prefilter reconstruct")
    for word in ("--depth", "--voxel-size", "--wavelet", "--memory-limit", "d4", "examples:"):
        assert word in result.stdout
    assert "reconstruct" in run("--help").stdout


def test_from_file_to_file(scan, tmp_path, addon, monkeypatch):
    """The points come nowhere near Blender."""
    monkeypatch.setattr(addon("points.files").prefilter, "read_points", None)
    target = tmp_path / "out.ply"
    result = run("reconstruct", scan, "-o", target, *DEPTH, "--memory-limit", 200)
    assert result.returncode == 0, result.stderr
    assert "Reconstructed 'out.ply' from 20000 points at depth 6, in cells of" in result.stdout
    assert "100 %" in result.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"scan.ply", "out.ply"}
    assert len(bpy.data.meshes) == 1  # The cube of the startup file.
    assert_torus(target)


@pytest.mark.parametrize("ending", [".obj", ".stl", ".glb", ".blend"])
def test_other_targets(scan, tmp_path, ending):
    target = tmp_path / f"out{ending}"
    result = run("reconstruct", scan, "-o", target, *DEPTH)
    assert result.returncode == 0, result.stderr
    assert f"Reconstructed 'out{ending}' from 20000 points" in result.stdout
    assert_torus(target)


def test_colors(scan, tmp_path):
    """Colors are the file's, both from file to file and in memory."""
    for name, options in (("stream.ply", DEPTH), ("memory.ply", ("--voxel-size", 0.1))):
        result = run("reconstruct", scan, "-o", tmp_path / name, *options)
        assert result.returncode == 0, result.stderr
        (made,) = loaded(tmp_path / name).values()
        colors = made.data.color_attributes.active_color
        found = np.array([tuple(entry.color_srgb) for entry in colors.data])[:, :3]
        expected = (clouds.vertices(made) + 2) / 4
        np.testing.assert_allclose(found, expected, atol=0.04)


def test_several_sources(tmp_path):
    points, normals = clouds.torus()
    sources = []
    for i in range(3):
        part = slice(i, None, 3)
        # The last one has no normals; they are estimated.
        own = normals[part] if i < 2 else None
        sources.append(write_ply(tmp_path / f"{i}.ply", points[part], own))
    target = tmp_path / "out.ply"
    result = run("reconstruct", *sources, "-o", target, *DEPTH)
    assert result.returncode == 0, result.stderr
    assert "from 20000 points" in result.stdout
    assert_torus(target)


AWAY = np.array([500_000.0, 5_000_000.0, 100.0])


@pytest.fixture
def far(tmp_path):
    """Returns a file of a torus that is far from the origin."""
    points, normals = clouds.torus()
    return write_ply(tmp_path / "far.ply", points + AWAY, normals)


def test_far_away_points_keep_their_precision(far, tmp_path):
    target = tmp_path / "out.blend"
    result = run("reconstruct", far, "-o", target, *DEPTH)
    assert result.returncode == 0, result.stderr
    assert "kept as the custom property 'scan_offset'" in result.stderr
    (made,) = loaded(target).values()
    assert list(made["scan_offset"]) == list(AWAY)
    assert bodies.is_closed(made)
    assert np.abs(clouds.torus_distance(clouds.vertices(made))).mean() < 0.1


def test_far_away_points_in_files_of_places(far, tmp_path):
    """A place of an object holds round numbers."""
    target = tmp_path / "out.glb"
    result = run("reconstruct", far, "-o", target, *DEPTH)
    assert result.returncode == 0, result.stderr
    assert "custom property" not in result.stderr
    (made,) = loaded(target).values()
    np.testing.assert_array_equal(made.matrix_world.translation, AWAY)
    made.matrix_world.translation = (0, 0, 0)
    bpy.context.view_layer.update()
    assert np.abs(clouds.torus_distance(clouds.vertices(made))).mean() < 0.1


def test_far_away_points_in_files_of_few_digits(far, tmp_path):
    target = tmp_path / "out.stl"
    result = run("reconstruct", far, "-o", target, *DEPTH)
    assert result.returncode == 0, result.stderr
    told = "(500000, 5000000, 100) is to be added to its coordinates"
    assert told in result.stderr
    (made,) = loaded(target).values()
    assert np.abs(clouds.torus_distance(clouds.vertices(made))).mean() < 0.1


def test_offsets_of_objects_are_added_back(tmp_path, addon):
    points, normals = clouds.torus()
    scan = clouds.scan(points, normals)
    scan["scan_offset"] = list(AWAY)
    blend = tmp_path / "scan.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    target = tmp_path / "out.ply"
    result = run("reconstruct", blend, "-o", target, *DEPTH)
    assert result.returncode == 0, result.stderr
    made = addon("points.files").prefilter.read_points(target)
    assert np.abs(clouds.torus_distance(made.positions - AWAY)).mean() < 0.01
    result = run("reconstruct", blend, "-o", tmp_path / "out.glb", *DEPTH)
    assert result.returncode == 0, result.stderr
    (made,) = loaded(tmp_path / "out.glb").values()
    np.testing.assert_array_equal(made.matrix_world.translation, AWAY)


def test_several_files_to_ply_keep_their_doubles(tmp_path, addon):
    """They come nowhere near Blender, whose meshes have floats."""
    points, normals = clouds.torus()
    offset = np.array([500_000.0, 5_000_000.0, 100.0])
    sources = [
        write_ply(tmp_path / f"{i}.ply", points[i::2] + offset, normals[i::2]) for i in range(2)
    ]
    target = tmp_path / "out.ply"
    result = run("reconstruct", *sources, "-o", target, "--voxel-size", 0.05)
    assert result.returncode == 0, result.stderr
    assert "from 20000 points" in result.stdout
    assert "read '0.ply', '1.ply'" in result.stdout
    made = addon("points.files").prefilter.read_points(target)
    assert len(made.positions) > 1000
    assert np.abs(clouds.torus_distance(made.positions - offset)).mean() < 0.01


def test_objects_of_a_blend_file(tmp_path):
    clouds.scan(*clouds.torus())
    clouds.scan(*clouds.sphere(), name="Other")
    bodies.cube()
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    target = tmp_path / "out.ply"
    result = run("reconstruct", path, "-o", target, *DEPTH, "--object", "Scan")
    assert result.returncode == 0, result.stderr
    assert "Reconstructed 'Scan.surface' from 20000 points" in result.stdout
    assert_torus(target)


def test_failures_leave_nothing(scan, tmp_path):
    cut = tmp_path / "cut.ply"
    cut.write_bytes(scan.read_bytes()[:-100])
    blend = tmp_path / "scene.blend"
    bodies.cube()
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    target = tmp_path / "out.ply"
    rows = [
        ((tmp_path / "gone.ply", target), ["gone.ply"], 1),
        ((tmp_path / "gone.ply", tmp_path / "out.stl"), ["gone.ply"], 1),
        ((scan, tmp_path / "gone" / "out.ply"), ["there is no folder"], 1),
        ((scan, tmp_path / "out.vdb"), ["TARGET: found", "allowed: "], 2),
        (("image.png", target), ["SOURCE: found 'image.png'", "allowed: "], 2),
        ((scan, target, "--depth", 13), ["--depth: found '13'", "1 to 12"], 2),
        ((scan, target, "--object", "Scan"), ["--object: only .blend files"], 2),
        ((scan, blend, "-o", target), ["SOURCE: .blend files"], 2),
        ((blend, target), ["no visible object with points and no faces"], 1),
        ((cut, target), ["cut.ply"], 1),
        ((cut, tmp_path / "out.glb"), ["cut.ply"], 1),
        ((scan, target, "--voxel-size", "0.0001"), ["Voxel Size: 0.0001", "4096"], 1),
    ]
    for arguments, words, status in rows:
        assert_fails(run("reconstruct", *arguments), *words, status=status)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_ctrl_c_leaves_nothing(scan, tmp_path, addon, monkeypatch, number, status):
    """Interrupts after the first line of progress, as a user would."""

    class Interrupted(reporters.PlainReporter):
        _is_sent = False

        def show_progress(self, fraction):
            if not self._is_sent:
                self._is_sent = True
                os.kill(os.getpid(), number)
            super().show_progress(fraction)

    monkeypatch.setitem(reporters.REPORTERS, "plain", Interrupted)
    for name in ("out.ply", "out.stl"):
        result = run("reconstruct", scan, "-o", tmp_path / name, *DEPTH)
        assert result.returncode == status
        assert result.stderr.strip().endswith("prefilter: canceled")
    assert [path.name for path in tmp_path.iterdir()] == ["scan.ply"]
