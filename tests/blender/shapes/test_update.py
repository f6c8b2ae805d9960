# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.update_drawn`: an image made again in place."""

import bpy
import numpy as np
import outlines
import pytest
import scenes


@pytest.fixture
def circle():
    """Returns a circle of radius 1, and its image of 64 x 64 with no margin."""
    obj = outlines.curve("Circle")
    outlines.bezier_circle(obj)
    bpy.ops.prefilter.rasterize(width=64, height=64, margin=0)
    return obj, bpy.data.images["Circle"]


def update(image):
    assert bpy.ops.prefilter.update_drawn(image=image.name) == {"FINISHED"}


def test_it_keeps_the_datablock_and_its_users(circle):
    obj, image = circle
    material = scenes.material("Shows it", image)
    uid, users = image.session_uid, image.users
    obj.data.splines.clear()
    outlines.polygon(obj, [(0, 0), (1, 0), (1, 1), (0, 1)])
    assert scenes.pixels("Circle")[0, 0, 3] == 0
    update(image)
    assert list(bpy.data.images) == [image]
    assert (image.session_uid, image.users) == (uid, users)
    assert any(
        node.type == "TEX_IMAGE" and node.image == image for node in material.node_tree.nodes
    )
    np.testing.assert_array_equal(scenes.pixels("Circle"), 1)


def test_settings_of_the_image_count(circle, tmp_path):
    _, image = circle
    drawn = image.prefilter_drawn
    assert (drawn.width, drawn.margin, drawn.source) == (64, 0, "curves")
    drawn.width, drawn.height, drawn.pixel_type = 96, 32, "half"
    update(image)
    assert tuple(image.size) == (96, 32)
    assert image.is_float
    assert image.use_half_precision
    before = scenes.pixels("Circle")
    assert before[16, 48, 3] == 1
    image.use_fake_user = True
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    image = bpy.data.images["Circle"]
    np.testing.assert_allclose(scenes.pixels("Circle"), before, atol=1e-3)
    image.prefilter_drawn.pixel_type = "byte"
    update(image)
    assert not image.is_float
    np.testing.assert_allclose(scenes.pixels("Circle")[..., 3], before[..., 3], atol=3e-3)


def test_after_renaming_hiding_and_in_edit_mode(circle):
    obj, image = circle
    obj.name = "Other"
    obj.data.splines.clear()
    outlines.polygon(obj, [(0, 0), (1, 0), (1, 1), (0, 1)])
    obj.hide_set(True)
    update(image)
    np.testing.assert_array_equal(scenes.pixels("Circle"), 1)
    obj.hide_set(False)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.curve.select_all(action="DESELECT")
    obj.data.splines[0].points[2].select = True
    bpy.ops.curve.delete(type="VERT")
    update(image)
    assert scenes.pixels("Circle")[..., 3].mean() == pytest.approx(0.5, abs=0.01)


def test_objects_that_are_gone(circle, capfd):
    first, _ = circle
    second = outlines.square("Second", 2, (1, 1))
    first.select_set(True)
    bpy.ops.prefilter.rasterize(width=16, height=16, margin=0, image_name="Both")
    both = bpy.data.images["Both"]
    bpy.context.scene.collection.objects.unlink(first)
    update(both)
    assert "1 object that the image showed is gone" in capfd.readouterr().out
    np.testing.assert_array_equal(scenes.pixels("Both"), 1)
    bpy.data.objects.remove(second)
    bpy.data.objects.remove(first)
    with pytest.raises(RuntimeError, match="image 'Both': the objects that it shows are gone"):
        update(both)
    np.testing.assert_array_equal(scenes.pixels("Both"), 1)


def test_undo_brings_the_earlier_pixels_back(circle):
    obj, image = circle
    image.use_fake_user = True
    before = scenes.pixels("Circle")
    bpy.ops.ed.undo_push(message="before")
    obj.data.splines.clear()
    outlines.polygon(obj, [(0, 0), (1, 0), (1, 1), (0, 1)])
    bpy.ops.ed.undo_push(message="edited")
    update(image)
    bpy.ops.ed.undo_push(message="updated")
    np.testing.assert_array_equal(scenes.pixels("Circle"), 1)
    bpy.ops.ed.undo()
    np.testing.assert_array_equal(scenes.pixels("Circle"), before)
    bpy.ops.ed.redo()
    np.testing.assert_array_equal(scenes.pixels("Circle"), 1)


def test_uv_mask_again():
    obj = scenes.quads("Quad", [[(0, 0), (0.5, 0), (0.5, 0.5), (0, 0.5)]])
    bpy.ops.prefilter.rasterize(width=8, height=8)
    image = bpy.data.images["Quad.uv"]
    assert scenes.pixels("Quad.uv")[..., 0].sum() == 16
    obj.data.uv_layers[0].uv.foreach_set("vector", np.array(scenes.UNIT_SQUARE).ravel())
    update(image)
    assert scenes.pixels("Quad.uv")[..., 0].sum() == 64


def test_poll_and_refusals(circle):
    _, image = circle
    assert bpy.ops.prefilter.update_drawn() == {"FINISHED"}
    other = scenes.image("Other", scenes.noise(2, 2))
    with pytest.raises(RuntimeError, match="image 'Other' was not made by Rasterize"):
        update(other)
    with pytest.raises(RuntimeError, match="found no image named 'None'"):
        bpy.ops.prefilter.update_drawn(image="None")
    bpy.data.images.remove(image)
    with pytest.raises(RuntimeError, match="No image in this file was made by Rasterize"):
        bpy.ops.prefilter.update_drawn()
