# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.use_as_decal`: the image is where its shapes were, in the size that it has."""

import math

import bpy
import numpy as np
import outlines
import pytest
import scenes
from mathutils import Vector


def rasterize(**options):
    assert bpy.ops.prefilter.rasterize(**{"side": 64, **options}) == {"FINISHED"}
    return max(bpy.data.images, key=lambda image: image.session_uid)


def decal(**options):
    before = set(bpy.data.objects)
    assert bpy.ops.prefilter.use_as_decal(**options) == {"FINISHED"}
    (made,) = set(bpy.data.objects) - before
    bpy.context.view_layer.update()
    return made


def corners(obj):
    """Returns the corners of a plane in the world, from the low left one on."""
    return np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])


def sign(name="Sign"):
    """Returns an object that fills a box of 4 x 1."""
    obj = outlines.curve(name)
    outlines.polygon(obj, [(0, 0), (4, 0), (4, 1), (0, 1)])
    return obj


def textures(material):
    return [node for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]


def surface(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def test_a_wide_text_gets_a_wide_image():
    outlines.text("A wide text")
    made = rasterize(side=256, margin=0)
    width, height = made.size
    assert width == 256
    assert height < 100
    alpha = scenes.pixels(made.name)[..., 3]
    assert alpha[:, :3].max() > 0.1
    assert alpha[-2:].max() > 0.1
    assert tuple(rasterize(resolution="size", width=64, height=64).size) == (64, 64)
    assert tuple(rasterize(width=96, height=32).size) == (96, 32)


def test_margin_and_side():
    sign()
    made = rasterize(side=48, margin=4)
    assert tuple(made.size) == (48, 18)
    alpha = scenes.pixels(made.name)[..., 3]
    expected = np.zeros((18, 48))
    expected[4:14, 4:44] = 1
    np.testing.assert_array_equal(alpha, expected)


def test_a_margin_without_room():
    sign()
    with pytest.raises(RuntimeError, match="Margin: 8 leaves no room in 16 pixels"):
        rasterize(side=16)


def test_a_plane_in_the_place_of_the_shapes():
    obj = sign()
    obj.location, obj.scale = (1, 2, 3), (1, 2, 1)
    obj.rotation_euler = (math.pi / 2, 0, math.pi / 2)
    bpy.context.view_layer.update()
    image = rasterize(margin=0)
    made = decal()
    expected = [obj.matrix_world @ Vector((x, y, 0)) for x, y in ((0, 0), (4, 0), (4, 1), (0, 1))]
    np.testing.assert_allclose(corners(made), expected, atol=1e-5)
    assert tuple(made.scale) == (1, 1, 1)
    assert bpy.context.active_object == made
    assert made.select_get()
    assert not obj.visible_get()
    assert obj.hide_render
    material = made.data.materials[0]
    (texture,) = textures(material)
    assert texture.image == image
    shader = surface(material)
    assert shader.inputs["Base Color"].links[0].from_socket == texture.outputs["Color"]
    assert shader.inputs["Alpha"].links[0].from_socket == texture.outputs["Alpha"]
    assert image.colorspace_settings.name == "sRGB"
    bpy.ops.ed.undo_push()


def test_the_margin_is_around_the_shapes():
    sign()
    image = rasterize(side=48, margin=4)
    made = corners(decal(image=image.name))
    np.testing.assert_allclose(made[0], (-0.4, -0.4, 0), atol=1e-6)
    np.testing.assert_allclose(made[2], (4.4, 1.4, 0), atol=1e-6)


def test_offset_and_without_hiding():
    obj = sign()
    rasterize(margin=0)
    made = decal(offset=0.25, use_hide=False)
    np.testing.assert_allclose(corners(made)[:, 2], 0.25)
    assert obj.visible_get()
    assert not obj.hide_render


@pytest.mark.parametrize("view", ["top", "front", "right"])
def test_views_along_axes(view):
    obj = sign()
    turn = {"top": (0, 0, 0), "front": (math.pi / 2, 0, 0), "right": (math.pi / 2, 0, math.pi / 2)}
    obj.location, obj.rotation_euler = (5, 6, 7), turn[view]
    bpy.context.view_layer.update()
    rasterize(margin=0, view=view)
    expected = [obj.matrix_world @ Vector((x, y, 0)) for x, y in ((0, 0), (4, 0), (4, 1), (0, 1))]
    np.testing.assert_allclose(corners(decal()), expected, atol=1e-5)


def test_through_a_camera():
    obj = sign()
    obj.location = (1, 1, -8)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    bpy.context.view_layer.update()
    rasterize(width=64, height=32, view="camera")
    made = corners(decal())
    half = 8 * camera.data.sensor_width / 2 / camera.data.lens
    np.testing.assert_allclose(made[0], (-half, -half / 2, -8), atol=1e-4)
    np.testing.assert_allclose(made[2], (half, half / 2, -8), atol=1e-4)


def test_an_svg_file_at_the_cursor(tmp_path):
    path = tmp_path / "drawing.svg"
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="8" height="4"/>')
    bpy.context.scene.cursor.location = (1, 0, 0)
    bpy.ops.prefilter.rasterize_svg(filepath=str(path), side=32, margin=0)
    assert tuple(bpy.data.images["drawing"].size) == (32, 16)
    made = corners(decal(image="drawing"))
    np.testing.assert_allclose(made[0], (0.5, -0.25, 0), atol=1e-6)
    np.testing.assert_allclose(made[2], (1.5, 0.25, 0), atol=1e-6)


def test_a_mask_is_an_alpha():
    sign()
    rasterize(color="mask")
    material = decal().data.materials[0]
    (texture,) = textures(material)
    alpha = surface(material).inputs["Alpha"].links[0].from_socket
    assert alpha == texture.outputs["Color"]
    assert not surface(material).inputs["Base Color"].is_linked


def test_opaque_images_stay_opaque():
    sign()
    rasterize(background="color")
    assert not surface(decal().data.materials[0]).inputs["Alpha"].is_linked


def test_two_planes_share_a_material():
    obj = sign()
    image = rasterize()
    first, second = decal(image=image.name), decal(image=image.name)
    assert first.data.materials[0] == second.data.materials[0]
    assert first.users_collection == obj.users_collection


def test_update_keeps_the_aspect():
    obj = sign()
    image = rasterize(margin=0)
    made = decal()
    made.location.z = 2
    for point in obj.data.splines[0].points:
        point.co.x *= 2
    bpy.context.view_layer.update()
    bpy.ops.prefilter.update_drawn(image=image.name)
    assert tuple(image.size) == (64, 8)
    bpy.context.view_layer.update()
    np.testing.assert_allclose(corners(made)[2], (8, 1, 2), atol=1e-5)


def test_over_the_color_of_a_material():
    obj = scenes.quads("Wall", [scenes.UNIT_SQUARE])
    material = bpy.data.materials.new("Wall")
    if material.node_tree is None:
        material.use_nodes = True
    surface(material).inputs["Base Color"].default_value = (1, 0, 0, 1)
    obj.data.materials.append(material)
    sign()
    image = rasterize()
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.prefilter.use_as_decal(image=image.name, target="material") == {"FINISHED"}
    mix = surface(material).inputs["Base Color"].links[0].from_node
    (texture,) = textures(material)
    assert (mix.type, texture.extension) == ("MIX", "CLIP")
    inputs = {one.identifier: one for one in mix.inputs}
    assert tuple(inputs["A_Color"].default_value) == (1, 0, 0, 1)
    assert inputs["B_Color"].links[0].from_socket == texture.outputs["Color"]
    assert inputs["Factor_Float"].links[0].from_socket == texture.outputs["Alpha"]
    # Another one goes over the first.
    bpy.ops.prefilter.use_as_decal(image=image.name, target="material")
    above = surface(material).inputs["Base Color"].links[0].from_node
    below = {one.identifier: one for one in above.inputs}["A_Color"].links[0].from_node
    assert below == mix


def test_a_mesh_without_a_material_gets_one():
    obj = scenes.quads("Wall", [scenes.UNIT_SQUARE])
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    assert bpy.ops.prefilter.rasterize(source="uv", width=16, height=16) == {"FINISHED"}
    assert bpy.ops.prefilter.use_as_decal(image="Wall.uv", target="material") == {"FINISHED"}
    (texture,) = textures(obj.active_material)
    assert texture.image == bpy.data.images["Wall.uv"]
    with pytest.raises(RuntimeError, match="shows a UV map, which is in no place"):
        bpy.ops.prefilter.use_as_decal(image="Wall.uv", target="plane")


def test_refusals(capfd):
    assert not bpy.ops.prefilter.use_as_decal.poll()
    obj = sign()
    image = rasterize()
    with pytest.raises(RuntimeError, match="Make a mesh with a UV map the active object"):
        bpy.ops.prefilter.use_as_decal(image=image.name, target="material")
    plain = scenes.image("Plain", np.ones((4, 4, 4), np.float32))
    with pytest.raises(RuntimeError, match="'Plain' was not made by Rasterize"):
        bpy.ops.prefilter.use_as_decal(image=plain.name)
    capfd.readouterr()
    assert obj.visible_get()


def test_premultiplied_bytes_get_a_warning(capfd):
    sign()
    rasterize(alpha="premultiplied")
    decal()
    assert "edges dark" in capfd.readouterr().out


def test_saved_and_opened_again(tmp_path):
    sign()
    rasterize(margin=0)
    name = decal().name
    path = str(tmp_path / "sign.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    made = bpy.data.objects[name]
    (texture,) = textures(made.data.materials[0])
    assert tuple(texture.image.size) == (64, 16)
    np.testing.assert_allclose(corners(made)[2], (4, 1, 0), atol=1e-6)
