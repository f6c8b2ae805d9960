# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.update_voxels`: results are updated from the present state of their sources."""

import bodies
import bpy
import numpy as np
import outlines
import pytest

DONE = {"FINISHED"}


def update():
    assert bpy.ops.prefilter.update_voxels() == DONE


def switch():
    assert bpy.ops.prefilter.switch_source() == DONE
    bpy.context.view_layer.update()
    return bpy.context.active_object


def seen():
    return {obj.name for obj in bpy.data.objects if obj.visible_get()}


def voxelized(**options):
    cube = bodies.cube(location=(1, 2, 3), rotation_euler=(0, 0, 0.5))
    assert bpy.ops.prefilter.voxelize(**{"depth": 5, **options}) == DONE
    return cube


def boolean(**options):
    """Returns a cube of volume 8 and another that takes half of it away."""
    other = bodies.cube("Other", location=(1, 0, 0))
    cube = bodies.cube()
    other.select_set(True)
    bpy.context.view_layer.objects.active = cube
    assert bpy.ops.prefilter.boolean(**{"depth": 5, **options}) == DONE
    return cube, other


def test_update_after_changing_the_source():
    result = voxelized()
    assert bodies.volume(result) == pytest.approx(8, rel=0.01)
    source = switch()
    for vertex in source.data.vertices:
        vertex.co.z *= 2
    update()
    assert bodies.volume(result) == pytest.approx(16, rel=0.01)
    assert seen() == {"Cube"}
    assert not source.users_collection
    assert {mesh.name for mesh in bpy.data.meshes} == {"Cube", "Cube.source"}
    assert len(switch().data.vertices) == 8


def test_modifiers_of_the_source_count_and_those_of_the_result_stay():
    result = voxelized()
    source = switch()
    array = source.modifiers.new("Array", "ARRAY")
    array.use_relative_offset, array.use_constant_offset = False, True
    array.constant_offset_displace = (4, 0, 0)
    switch()
    result.modifiers.new("Decimate", "DECIMATE").ratio = 0.5
    update()
    assert bodies.volume(result) == pytest.approx(16, rel=0.01)
    assert [one.name for one in result.modifiers] == ["Decimate"]
    assert [one.name for one in source.modifiers] == ["Array"]


def test_settings_are_those_of_the_object():
    result = voxelized(adaptivity=0.0)
    count = len(result.data.polygons)
    bpy.context.scene.prefilter_voxelize.depth = 7
    update()
    assert len(result.data.polygons) == count
    result.prefilter_voxels.depth = 6
    update()
    assert 3 < len(result.data.polygons) / count < 5


def test_update_after_moving_the_result():
    result = voxelized()
    result.location, result.scale = (5, 5, 5), (1, 1, 2)
    update()
    np.testing.assert_allclose(result.location, (5, 5, 5))
    assert bodies.volume(result) == pytest.approx(16, rel=0.01)


def test_update_after_moving_an_operand():
    """Hidden or not, whichever of both is active."""
    for operands in ("hide", "keep"):
        cube, other = boolean(operands=operands)
        assert bodies.volume(cube) == pytest.approx(4, rel=0.01)
        other.location.x = 1.5
        bpy.context.view_layer.update()
        before = seen()
        update()
        assert bodies.volume(cube) == pytest.approx(6, rel=0.01)
        assert seen() == before
        other.location.x = 0.5
        other.hide_set(False)
        bpy.context.view_layer.objects.active = other
        update()
        assert bodies.volume(cube) == pytest.approx(2, rel=0.01)
        for obj in list(bpy.data.objects):
            bpy.data.objects.remove(obj)


def test_an_operand_in_a_collection_that_is_left_out():
    cube, other = boolean()
    kept = bpy.data.collections.new("Kept")
    bpy.context.scene.collection.children.link(kept)
    for collection in other.users_collection:
        collection.objects.unlink(other)
    kept.objects.link(other)
    other.location.x = 1.5
    bpy.context.view_layer.layer_collection.children["Kept"].exclude = True
    bpy.context.view_layer.objects.active = cube
    update()
    assert bodies.volume(cube) == pytest.approx(6, rel=0.01)
    assert list(other.users_collection) == [kept]


def cut_twice():
    """Returns a cube without two halves of its sides, which leaves a quarter, and both others."""
    cube, first = boolean(adaptivity=0.0)
    second = bodies.cube("Second", location=(0, 1, 0))
    cube.select_set(True)
    bpy.context.view_layer.objects.active = cube
    assert bpy.ops.prefilter.boolean() == DONE
    assert bodies.volume(cube) == pytest.approx(2, rel=0.01)
    return cube, first, second


@pytest.mark.parametrize("is_cutter_active", [False, True])
def test_one_boolean_after_the_other(is_cutter_active):
    """Both are made again, and the first one's result is kept as it is then."""
    cube, first, second = cut_twice()
    first.location.x, second.location.y = 1.5, 1.5
    if is_cutter_active:
        first.hide_set(False)
        bpy.context.view_layer.objects.active = first
    count = len(bpy.data.objects)
    update()
    assert bodies.volume(cube) == pytest.approx(8 * 0.75 * 0.75, rel=0.01)
    assert len(bpy.data.objects) == count
    assert len(bpy.data.meshes) == 5
    bpy.context.view_layer.objects.active = cube
    assert bodies.volume(switch()) == pytest.approx(6, rel=0.01)


def test_update_uses_present_positions():
    """The object was moved together with its hidden source."""
    cube, first, second = cut_twice()
    for obj in (cube, first, second):
        obj.location.z = 10
    update()
    assert bodies.volume(cube) == pytest.approx(2, rel=0.01)


def test_manually_edited_results_are_not_updated(capfd):
    cube, first, _ = cut_twice()
    source = switch()
    for vertex in source.data.vertices:
        vertex.co.z *= 2
    switch()
    first.location.x = 1.5
    update()
    assert bodies.volume(cube) == pytest.approx(8 - 2, rel=0.01)
    assert "by hand" not in capfd.readouterr().out
    cube.data.vertices[0].co.z -= 1
    update()
    assert "Warning: the mesh of 'Cube' was changed by hand" in capfd.readouterr().out


def test_a_failed_update_changes_nothing(addon, monkeypatch):
    cube, first, _ = cut_twice()
    source = cube.prefilter_made_of.sources[0].obj
    before = {obj.name: obj.data for obj in bpy.data.objects}
    meshes = {mesh.name: len(mesh.vertices) for mesh in bpy.data.meshes}
    compute, runs = addon("voxels.boolean").Boolean.compute, []

    def failing(self, progress):
        runs.append(self)
        if len(runs) > 1:
            raise MemoryError("no room")
        compute(self, progress)

    monkeypatch.setattr(addon("voxels.boolean").Boolean, "compute", failing)
    first.location.x = 1.5
    with pytest.raises(RuntimeError, match="no room"):
        bpy.ops.prefilter.update_voxels()
    assert len(runs) == 2
    assert {obj.name: obj.data for obj in bpy.data.objects} == before
    assert {mesh.name: len(mesh.vertices) for mesh in bpy.data.meshes} == meshes
    assert not source.users_collection


def test_gone_operands(capfd):
    third = bodies.cube("Third", location=(0, 0, 1))
    cube, other = boolean(operands="keep")
    bpy.data.objects.remove(third)
    update()
    assert bodies.volume(cube) == pytest.approx(4, rel=0.01)
    assert "Warning: 1 object that it was combined with is gone" in capfd.readouterr().out
    bpy.data.objects.remove(other)
    with pytest.raises(RuntimeError, match="the objects that it was combined with are gone"):
        bpy.ops.prefilter.update_voxels()


def test_a_text():
    text = outlines.text("Text")
    text.data.extrude = 0.2
    assert bpy.ops.prefilter.voxelize(depth=6) == DONE
    made = bpy.context.active_object
    before = bodies.volume(made)
    text.data.extrude = 0.4
    update()
    assert bpy.context.active_object == made
    assert bodies.volume(made) == pytest.approx(2 * before, rel=0.15)
    assert seen() == {made.name}


def cut_text():
    """Returns the result of a text of three bars without the first, the text, and its width."""
    text = outlines.text("III")
    text.data.extrude = 0.2
    bpy.context.view_layer.update()
    width = text.dimensions.x
    bodies.cube("Cutter", location=(width / 2 - 1, 0, 0))
    text.select_set(True)
    bpy.context.view_layer.objects.active = text
    assert bpy.ops.prefilter.boolean(depth=6) == DONE
    return bpy.context.active_object, text, width


def test_a_text_where_its_result_was_moved_to():
    """Nothing is cut away where it has moved by its width."""
    result, text, width = cut_text()
    two_bars = bodies.volume(result)
    result.location.x += width
    update()
    assert bodies.volume(result) == pytest.approx(1.5 * two_bars, rel=0.05)
    np.testing.assert_allclose(text.matrix_world, result.matrix_world, atol=1e-6)


def test_a_text_that_was_moved_while_it_was_shown():
    """The result follows the text, and the cut is updated."""
    result, text, width = cut_text()
    two_bars = bodies.volume(result)
    assert switch() == text
    text.location.x += width
    update()
    assert result.location.x == pytest.approx(width)
    assert bodies.volume(result) == pytest.approx(1.5 * two_bars, rel=0.05)


def test_a_text_before_two_booleans():
    """The copy between is in no collection, and the text goes where the last result is."""
    result, text, width = cut_text()
    two_bars = bodies.volume(result)
    bodies.cube("Other", location=(0, 5, 0))
    result.select_set(True)
    bpy.context.view_layer.objects.active = result
    assert bpy.ops.prefilter.boolean() == DONE
    result.location.x += width
    update()
    assert bodies.volume(result) == pytest.approx(1.5 * two_bars, rel=0.05)
    assert text.location.x == pytest.approx(width)


def test_a_text_that_is_seen_stays():
    """Sources that are in use elsewhere count where they are."""
    result, text, width = cut_text()
    two_bars = bodies.volume(result)
    text.hide_set(False)
    result.location.x += width
    update()
    assert text.location.x == 0
    assert bodies.volume(result) == pytest.approx(two_bars, rel=0.05)


def test_after_opening_the_file_again(tmp_path):
    boolean()
    path = str(tmp_path / "cut.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.data.objects["Other"].location.x = 1.5
    update()
    assert bodies.volume(bpy.data.objects["Cube"]) == pytest.approx(6, rel=0.01)


def test_undo():
    bpy.context.preferences.edit.use_global_undo = True
    voxelized(depth=4, adaptivity=0.0)
    count = len(bpy.data.objects["Cube"].data.vertices)
    bpy.data.objects["Cube"].prefilter_voxels.depth = 5
    bpy.ops.ed.undo_push(message="before")
    update()
    bpy.ops.ed.undo_push(message="updated")
    bpy.ops.ed.undo()
    assert len(bpy.data.objects["Cube"].data.vertices) == count
    update()
    assert len(bpy.data.objects["Cube"].data.vertices) > count


def test_replaced_originals():
    """No source is kept, and the source of an earlier run is removed."""
    result = voxelized()
    assert bpy.ops.prefilter.voxelize(depth=4, originals="replace") == DONE
    assert [obj.name for obj in bpy.data.objects] == ["Cube"]
    assert [mesh.name for mesh in bpy.data.meshes] == ["Cube"]
    assert not bpy.ops.prefilter.update_voxels.poll()
    assert bodies.is_closed(result)


def test_objects_without_a_recipe_are_refused():
    bodies.cube()
    assert not bpy.ops.prefilter.update_voxels.poll()
    with pytest.raises(RuntimeError, match="has no stored sources"):
        bpy.ops.prefilter.update_voxels()


def cells(capfd):
    """Returns how large the cells of the last run were, as it said."""
    return capfd.readouterr().out.rpartition("cells of ")[2].split(":")[0]


def test_a_boolean_keeps_the_cells_of_its_first_operand(capfd):
    """Unless it is told otherwise; they grow with the object."""
    cube = voxelized(resolution="size", voxel_size=0.125)
    cube.scale = (2, 2, 2)
    bodies.cube("Other", location=(2, 2, 3))
    cube.select_set(True)
    bpy.context.view_layer.objects.active = cube
    capfd.readouterr()
    assert bpy.ops.prefilter.boolean(operands="keep") == DONE
    assert cells(capfd) == "25 cm"
    bpy.ops.prefilter.boolean(operands="keep", resolution="size", voxel_size=0.5)
    assert cells(capfd) == "50 cm"
    bpy.ops.prefilter.boolean(operands="keep")
    assert cells(capfd) == "50 cm"
    for options in ({"depth": 5}, {"preset": "Preview"}, {"use_keep_resolution": False}):
        bpy.ops.prefilter.boolean(operands="keep", **options)
        assert cells(capfd) != "50 cm"
        bpy.ops.prefilter.boolean(operands="keep", resolution="size", voxel_size=0.5)


def test_too_many_cells_to_keep(capfd):
    """Then the depth counts, also when it is made again; cells that are asked for are refused."""
    cube = voxelized(resolution="size", voxel_size=0.125)
    bodies.cube("Wide", size=600, location=(0, 0, 301))
    cube.select_set(True)
    bpy.context.view_layer.objects.active = cube
    with pytest.raises(RuntimeError, match=r"Voxel Size: 0\.125 would need"):
        bpy.ops.prefilter.boolean(operation="union", resolution="size", voxel_size=0.125)
    assert bpy.ops.prefilter.boolean(operation="union") == DONE
    assert "too many cells of 12.5 cm: the depth counts" in capfd.readouterr().out
    update()
    assert "too many cells of 12.5 cm: the depth counts" in capfd.readouterr().out
