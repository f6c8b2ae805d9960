# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.voxelize` in Sculpt Mode: masks and face sets stay, and Multires is refused."""

import bodies
import bpy
import numpy as np
import pytest


def sculpted(subdivisions=4):
    """Returns a ball in Sculpt Mode whose upper half is masked, with a face set at each side."""
    ball = bodies.sphere(subdivisions=subdivisions)
    mask = ball.data.attributes.new(".sculpt_mask", "FLOAT", "POINT")
    mask.data.foreach_set("value", [float(one.co.z > 0) for one in ball.data.vertices])
    sets = ball.data.attributes.new(".sculpt_face_set", "INT", "FACE")
    sets.data.foreach_set("value", [3 if one.center.x > 0 else 7 for one in ball.data.polygons])
    bpy.ops.object.mode_set(mode="SCULPT")
    return ball


def values(mesh, name, dtype):
    attribute = mesh.attributes[name]
    found = np.empty(len(attribute.data), dtype)
    attribute.data.foreach_get("value", found)
    return attribute.domain, found


def assert_kept(mesh, cell):
    places = np.array([vertex.co for vertex in mesh.vertices])
    domain, mask = values(mesh, ".sculpt_mask", np.float32)
    assert domain == "POINT"
    clear = np.abs(places[:, 2]) > 2 * cell
    np.testing.assert_allclose(mask[clear], places[clear, 2] > 0, atol=1e-6)
    domain, sets = values(mesh, ".sculpt_face_set", np.int32)
    assert domain == "FACE"
    middles = np.array([face.center for face in mesh.polygons])
    clear = np.abs(middles[:, 0]) > 2 * cell
    assert clear.mean() > 0.8
    np.testing.assert_array_equal(sets[clear], np.where(middles[clear, 0] > 0, 3, 7))


def test_masks_and_face_sets_are_kept():
    ball = sculpted()
    assert bpy.ops.prefilter.voxelize(depth=5) == {"FINISHED"}
    assert ball.mode == "SCULPT"
    assert bodies.is_closed(ball)
    assert_kept(ball.data, 2 / 28)


@pytest.mark.parametrize("mode", ["SCULPT", "OBJECT"])
def test_symmetry_is_kept(mode):
    """Symmetry and Voxel Remesh's settings stay, as both are settings of the mesh."""
    ball = sculpted()
    bpy.ops.object.mode_set(mode=mode)
    ball.data.use_mirror_x, ball.data.use_mirror_z = True, True
    ball.data.remesh_voxel_size = 0.0625
    for run in (bpy.ops.prefilter.voxelize, bpy.ops.prefilter.update_voxels):
        if run.poll():
            assert run() == {"FINISHED"}
        mesh = ball.data
        assert (mesh.use_mirror_x, mesh.use_mirror_y, mesh.use_mirror_z) == (True, False, True)
        assert mesh.remesh_voxel_size == 0.0625


def test_triangles_are_small_and_nothing_is_kept():
    """Brushes need the triangles, and of each run a copy would be kept."""
    ball = sculpted()
    bpy.ops.prefilter.voxelize(depth=5, adaptivity=1.0, output="volume")
    assert len(ball.data.polygons) > 3000
    assert not ball.data.has_custom_normals
    assert [obj.name for obj in bpy.data.objects] == ["Sphere"]
    assert [mesh.name for mesh in bpy.data.meshes] == ["Sphere"]


def test_the_sculpted_object_alone():
    other = bodies.cube("Other", location=(5, 0, 0))
    ball = sculpted()
    other.select_set(True)
    bpy.ops.prefilter.voxelize(depth=5)
    assert len(other.data.vertices) == 8
    assert bodies.is_closed(ball)


def test_sources_are_preserved():
    ball = bodies.sphere()
    bpy.ops.prefilter.voxelize(depth=4)
    bpy.ops.object.mode_set(mode="SCULPT")
    bpy.ops.prefilter.voxelize(depth=6)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert ball.prefilter_voxels.depth == 4
    assert ball.prefilter_voxels.cell == pytest.approx(2 / 60, rel=0.03)
    bpy.ops.prefilter.switch_source()
    assert len(bpy.context.active_object.data.vertices) == 162


@pytest.mark.parametrize("faces", ["triangles", "quads"])
def test_face_sets_of_the_size_of_a_cell_survive(faces):
    """A hundred and more of them, of a few faces of a fine ball each, in the middle of others."""
    ball = sculpted(subdivisions=6)
    cell = 2 / 28
    middles = np.array([face.center for face in ball.data.polygons])
    count = 120
    steps = np.arange(count) + 0.5
    z, turn = 1 - 2 * steps / count, steps * np.pi * (3 - np.sqrt(5))
    flat = np.sqrt(1 - z**2)
    places = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)
    sets = np.where(middles[:, 0] > 0, 3, 7).astype(np.int32)
    distances = np.linalg.norm(middles[:, None] - places, axis=2)
    is_small = distances.min(axis=1) < 0.56 * cell
    sets[is_small] = 100 + distances[is_small].argmin(axis=1)
    before = {one: float(np.sum(sets == one)) for one in np.unique(sets)}
    areas = 4 * np.pi / len(middles)
    assert 0.8 < np.mean([n for one, n in before.items() if one >= 100]) * areas / cell**2 < 1.2
    ball.data.attributes[".sculpt_face_set"].data.foreach_set("value", sets)
    assert bpy.ops.prefilter.voxelize(depth=5, faces=faces) == {"FINISHED"}
    mesh = ball.data
    _, found = values(mesh, ".sculpt_face_set", np.int32)
    assert set(np.unique(found)) == {3, 7, *range(100, 100 + count)}
    for face in np.flatnonzero(found >= 100):
        place = np.array(mesh.polygons[face].center)
        assert np.linalg.norm(place - places[found[face] - 100]) < 1.1 * cell


def test_face_sets_survive_in_object_mode():
    ball = sculpted()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.prefilter.voxelize(depth=5, adaptivity=0.0)
    assert_kept(ball.data, 2 / 28)


def test_a_boolean_has_the_face_set_of_new_meshes():
    ball = sculpted()
    bpy.ops.object.mode_set(mode="OBJECT")
    other = bodies.cube("Other", location=(0, 0, 1))
    ball.select_set(True)
    bpy.context.view_layer.objects.active = ball
    bpy.ops.prefilter.boolean(depth=5, adaptivity=0.0)
    _, sets = values(ball.data, ".sculpt_face_set", np.int32)
    flat = [abs(face.center.z) < 0.01 for face in ball.data.polygons]
    assert sum(flat) > 500
    assert set(sets[flat]) == {1}
    assert set(sets) == {1, 3, 7}
    assert other.hide_get()


def test_multires_is_refused():
    ball = sculpted(subdivisions=2)
    ball.modifiers.new("Multires", "MULTIRES")
    with pytest.raises(RuntimeError, match="Multires: apply the modifier first"):
        bpy.ops.prefilter.voxelize(depth=4)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.prefilter.voxelize(depth=4) == {"FINISHED"}
    assert len(ball.modifiers) == 0


def test_dyntopo_is_refused():
    ball = sculpted(subdivisions=2)
    bpy.ops.sculpt.dynamic_topology_toggle()
    with pytest.raises(RuntimeError, match="Turn off Dyntopo first"):
        bpy.ops.prefilter.voxelize(depth=4)
    assert len(ball.data.vertices) == 42


def test_failures_stay_in_sculpt_mode():
    ball = sculpted(subdivisions=2)
    with pytest.raises(RuntimeError, match="Voxel Size"):
        bpy.ops.prefilter.voxelize(resolution="size", voxel_size=1e-5)
    assert ball.mode == "SCULPT"
    assert len(ball.data.vertices) == 42
