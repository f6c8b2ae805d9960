# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.switch_source`: the source of an object is shown in its place, and preserved."""

import bodies
import bpy
import clouds
import numpy as np
import outlines
import pytest

SWITCHED = {"FINISHED"}


def switch():
    assert bpy.ops.prefilter.switch_source() == SWITCHED
    bpy.context.view_layer.update()
    return bpy.context.active_object


def voxelized(**options):
    """Returns a turned and moved cube with a modifier that was voxelized."""
    cube = bodies.cube(location=(1, 2, 3), rotation_euler=(0, 0, 0.5))
    cube.modifiers.new("Bevel", "BEVEL")
    assert bpy.ops.prefilter.voxelize(**{"depth": 4, **options}) == {"FINISHED"}
    return cube


def seen():
    return {obj.name for obj in bpy.data.objects if obj.visible_get()}


def test_there_and_back():
    result = voxelized()
    count = len(result.data.vertices)
    source = switch()
    assert (source.name, seen()) == ("Cube.source", {"Cube.source"})
    assert len(source.data.vertices) == 8
    assert [one.name for one in source.modifiers] == ["Bevel"]
    assert source.select_get()
    assert result.hide_render
    np.testing.assert_allclose(source.matrix_world, result.matrix_world, atol=1e-6)
    assert bpy.context.active_object == source
    assert switch() == result
    assert result.select_get()
    assert seen() == {"Cube"}
    assert not source.users_collection
    assert len(result.data.vertices) == count
    assert not result.hide_render
    assert not result.modifiers


def test_moved_objects_stay_moved():
    result = voxelized()
    result.location.x = 5
    source = switch()
    assert source.location.x == 5
    source.location.x = 7
    assert switch().location.x == 7
    assert result.location.x == 7


def test_under_a_parent():
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    cube = bodies.cube()
    cube.parent = parent
    assert bpy.ops.prefilter.voxelize(depth=4) == {"FINISHED"}
    parent.location = (4, 5, 6)
    assert tuple(switch().matrix_world.translation) == (4, 5, 6)


def test_saved_and_opened_again(tmp_path):
    voxelized()
    path = str(tmp_path / "cube.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert len(switch().data.vertices) == 8
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert seen() == {"Cube.source"}
    assert switch().name == "Cube"


def test_undo():
    bpy.context.preferences.edit.use_global_undo = True
    voxelized()
    bpy.ops.ed.undo_push(message="voxelized")
    switch()
    bpy.ops.ed.undo_push(message="switched")
    bpy.ops.ed.undo()
    assert seen() == {"Cube"}
    assert switch().name == "Cube.source"


def test_forget():
    result = voxelized()
    switch()
    assert bpy.ops.prefilter.forget_source() == SWITCHED
    assert seen() == {"Cube"}
    assert [obj.name for obj in bpy.data.objects] == ["Cube"]
    assert [mesh.name for mesh in bpy.data.meshes] == ["Cube"]
    assert result.visible_get()
    assert not bpy.ops.prefilter.switch_source.poll()


def test_a_mesh_that_others_use_stays():
    cube = bodies.cube()
    other = bodies.body("Other", cube.data, location=(9, 0, 0))
    other.select_set(False)
    bpy.context.view_layer.objects.active = cube
    assert bpy.ops.prefilter.voxelize(depth=4) == {"FINISHED"}
    assert other.data.name == "Cube"
    assert bpy.ops.prefilter.forget_source() == SWITCHED
    assert len(other.data.vertices) == 8


def test_twice():
    """The source shown is the object before the last run."""
    result = voxelized()
    count = len(result.data.vertices)
    assert bpy.ops.prefilter.voxelize(depth=5) == {"FINISHED"}
    source = switch()
    assert len(source.data.vertices) == count
    assert switch() == result


def test_boolean_with_its_operands():
    bodies.cube("Other", location=(1, 0, 0))
    bodies.cube()
    bpy.data.objects["Other"].select_set(True)
    options = {"operation": "union", "depth": 4, "operands": "hide"}
    assert bpy.ops.prefilter.boolean(**options) == {"FINISHED"}
    assert seen() == {"Cube"}
    switch()
    assert seen() == {"Cube.source", "Other"}
    switch()
    assert seen() == {"Cube"}
    bpy.ops.prefilter.forget_source()
    assert {obj.name for obj in bpy.data.objects} == {"Cube", "Other"}


def test_a_text():
    text = outlines.text("Text")
    text.data.extrude = 0.1
    assert bpy.ops.prefilter.voxelize(depth=5) == {"FINISHED"}
    assert seen() == {"Text.voxels"}
    assert switch() == text
    assert seen() == {"Text"}
    assert text.select_get()
    assert switch().name == "Text.voxels"
    assert not text.select_get()
    assert seen() == {"Text.voxels"}


def test_a_text_and_its_result_are_in_one_place():
    """Under a parent too, which the text has and the result has not."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    parent.location.y = 2
    text = outlines.text("Text")
    text.data.extrude = 0.1
    text.parent = parent
    assert bpy.ops.prefilter.voxelize(depth=5) == {"FINISHED"}
    result = bpy.context.active_object
    result.location = (5, 6, 7)
    assert tuple(switch().matrix_world.translation) == (5, 6, 7)
    assert text.parent == parent
    text.location.x += 3
    assert tuple(switch().location) == (8, 6, 7)


def test_points_and_their_surface():
    scan = clouds.scan(*clouds.sphere(3000))
    assert bpy.ops.prefilter.reconstruct(depth=5) == {"FINISHED"}
    assert switch() == scan
    assert seen() == {"Scan"}
    assert switch().name == "Scan.surface"


def test_deleted_sources():
    scan = clouds.scan(*clouds.sphere(3000))
    assert bpy.ops.prefilter.reconstruct(depth=5) == {"FINISHED"}
    bpy.data.objects.remove(scan)
    assert not bpy.ops.prefilter.switch_source.poll()
    with pytest.raises(RuntimeError, match="has no stored sources"):
        bpy.ops.prefilter.switch_source()
