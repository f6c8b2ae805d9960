# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.rasterize`, as scripts call it: areas, colors and places are known."""

import math

import bpy
import fonts
import numpy as np
import outlines
import pytest
import scenes
from mathutils import Matrix


def rasterize(**options):
    """Rasterizes, and returns the new image."""
    before = set(bpy.data.images)
    assert bpy.ops.prefilter.rasterize(**{"width": 64, "height": 64, **options}) == {"FINISHED"}
    (made,) = set(bpy.data.images) - before
    return made


def pixels(image):
    return scenes.pixels(image.name)


def refused(capfd, **options):
    """Returns the error message of the operator."""
    with pytest.raises(RuntimeError) as raised:
        bpy.ops.prefilter.rasterize(**{"width": 64, "height": 64, **options})
    assert not bpy.data.images
    capfd.readouterr()
    return str(raised.value)


def test_circles_have_their_areas():
    """8 pixels around a circle of radius 1 that fills 112 of 128 pixels."""
    obj = outlines.curve()
    outlines.nurbs(obj, outlines.NURBS_CIRCLE, order=3, bezier=True, endpoint=True)
    made = rasterize(width=128, height=128, pixel_type="float")
    assert pixels(made)[..., 3].sum(dtype=float) == pytest.approx(math.pi * 56**2, rel=1e-6)
    obj.data.splines.clear()
    outlines.bezier_circle(obj)
    made = rasterize(width=128, height=128, pixel_type="float")
    # Green's theorem on cubic segments with handles of length k (1 + k / 2 - k^2 / 4 a quarter).
    k = outlines.CIRCLE_HANDLE
    quarter = 0.5 + 0.6 * k - 0.15 * k * k
    assert pixels(made)[..., 3].sum(dtype=float) == pytest.approx(4 * quarter * 56**2, rel=1e-6)


def test_text_has_holes_and_its_area():
    text = outlines.text("o")
    made = rasterize(margin=4, pixel_type="float")
    alpha = pixels(made)[..., 3]
    assert alpha[32, 32] == 0
    assert alpha.max() == 1
    assert alpha[:3].max() == alpha[:, :2].max() == 0
    mesh = text.evaluated_get(scenes.depsgraph()).to_mesh()
    area = sum(face.area for face in mesh.polygons)
    size = max(np.ptp([vertex.co for vertex in mesh.vertices], axis=0)[:2])
    assert alpha.sum(dtype=float) == pytest.approx(area * (56 / size) ** 2, rel=0.01)


def test_letters_are_filled_by_the_nonzero_rule(tmp_path):
    """Contours of variable fonts overlap."""
    bar = [(0, 0), (0, 200), (600, 200), (600, 0)]
    stem = [(0, 0), (0, 1000), (200, 1000), (200, 0)]
    hole = [(50, 50), (150, 50), (150, 150), (50, 150)]
    fonts.write_font(tmp_path / "variable.ttf", "L", [bar, stem, hole])
    text = outlines.text("L")
    text.data.font = bpy.data.fonts.load(str(tmp_path / "variable.ttf"))
    alpha = pixels(rasterize(width=60, height=100, margin=0))[..., 3]
    # Two contours wind round the corner, and one round its hole goes back.
    expected = np.zeros((100, 60))
    expected[:20] = expected[:, :20] = 1
    np.testing.assert_allclose(alpha, expected, atol=1e-3)


def test_even_odd_within_an_object():
    obj = outlines.square("First", 4)
    outlines.polygon(obj, [(1, 1), (3, 1), (3, 3), (1, 3)])
    outlines.polygon(obj, [(1.5, 1.5), (1.5, 2.5), (2.5, 2.5), (2.5, 1.5)])
    alpha = pixels(rasterize(margin=0))[..., 3]
    assert (alpha[8, 8], alpha[20, 20], alpha[32, 32]) == (1, 0, 1)


def test_the_nearer_object_covers_the_other():
    first = outlines.square("First", 4)
    outlines.polygon(first, [(1, 1), (3, 1), (3, 3), (1, 3)])
    outlines.colored(first, (1, 0, 0))
    second = outlines.square("Second", 2, (0, 0))
    outlines.colored(second, (0, 1, 0))
    second.location.z = 1
    bpy.context.view_layer.objects.active = first
    first.select_set(True)
    made = pixels(rasterize(margin=0))
    np.testing.assert_allclose(made[8, 8], (0, 1, 0, 1), atol=1e-6)
    np.testing.assert_allclose(made[24, 24], (0, 1, 0, 1), atol=1e-6)
    np.testing.assert_allclose(made[56, 56], (1, 0, 0, 1), atol=1e-6)
    second.location.z = -1
    made = pixels(rasterize(margin=0))
    np.testing.assert_allclose(made[8, 8], (1, 0, 0, 1), atol=1e-6)
    np.testing.assert_allclose(made[24, 24], (0, 1, 0, 1), atol=1e-6)


def test_colors_of_materials():
    obj = outlines.curve()
    outlines.colored(obj, (0.5, 0.25, 0.125), (0.1, 0.2, 0.8, 0.5))
    outlines.polygon(obj, [(0, 0), (1, 0), (1, 2), (0, 2)], slot=0)
    outlines.polygon(obj, [(1, 0), (2, 0), (2, 2), (1, 2)], slot=1)
    made = rasterize(margin=0)
    byte = 1 / 255
    assert (made.colorspace_settings.name, made.alpha_mode) == ("sRGB", "STRAIGHT")
    values = pixels(made)
    np.testing.assert_allclose(
        values[9, 9, :3], scenes.to_srgb(np.array([0.5, 0.25, 0.125])), atol=byte
    )
    np.testing.assert_allclose(
        values[9, 50, :3], scenes.to_srgb(np.array([0.1, 0.2, 0.8])), atol=byte
    )
    np.testing.assert_allclose(values[9, [9, 50], 3], [1, 0.5], atol=byte)
    made = rasterize(margin=0, pixel_type="float")
    assert made.alpha_mode == "PREMUL"
    np.testing.assert_allclose(pixels(made)[9, 50], (0.05, 0.1, 0.4, 0.5), atol=1e-6)
    made = rasterize(margin=0, pixel_type="float", alpha="straight")
    assert made.alpha_mode == "CHANNEL_PACKED"
    np.testing.assert_allclose(pixels(made)[9, 50], (0.1, 0.2, 0.8, 0.5), atol=1e-6)
    made = rasterize(margin=0, alpha="premultiplied")
    assert made.alpha_mode == "CHANNEL_PACKED"
    np.testing.assert_allclose(
        pixels(made)[9, 50, :3], scenes.to_srgb(np.array([0.05, 0.1, 0.4])), atol=byte
    )
    white = pixels(rasterize(margin=0, color="white"))
    np.testing.assert_array_equal(white, 1)


def test_colors_without_nodes_and_without_materials():
    obj = outlines.square()
    np.testing.assert_array_equal(pixels(rasterize(margin=0, pixel_type="float")), 1)
    material = bpy.data.materials.new("Viewport")
    material.diffuse_color = (0.25, 0.5, 0.75, 1)
    if material.node_tree is not None:
        material.node_tree.nodes.clear()
    obj.data.materials.append(material)
    found = pixels(rasterize(margin=0, pixel_type="float"))
    np.testing.assert_allclose(found[5, 5], (0.25, 0.5, 0.75, 1), atol=1e-6)
    obj.data.materials[0] = None
    np.testing.assert_array_equal(pixels(rasterize(margin=0, pixel_type="float")), 1)


@pytest.mark.parametrize("color", [(1, 1, 1), (0.2, 0.4, 0.6, 0.5)])
def test_colors_bleed_outward_under_zero_alpha(color):
    obj = outlines.curve()
    outlines.colored(obj, color)
    outlines.bezier_circle(obj)
    values = pixels(rasterize(margin=10))
    expected = scenes.to_srgb(np.array(color[:3]))
    assert values[0, 0, 3] == 0
    np.testing.assert_allclose(
        values[..., :3], np.broadcast_to(expected, (64, 64, 3)), atol=2 / 255
    )
    dark = pixels(rasterize(margin=10, use_bleed=False))
    np.testing.assert_array_equal(dark[:9], 0)
    np.testing.assert_array_equal(dark[..., 3], values[..., 3])


def test_background_and_mask():
    obj = outlines.square(side=2)
    outlines.polygon(obj, [(0.5, 0.5), (1.5, 0.5), (1.5, 1.5), (0.5, 1.5)])
    outlines.colored(obj, (1, 0, 0))
    made = rasterize(
        margin=0, background="color", background_color=(0, 0, 1, 1), pixel_type="float"
    )
    np.testing.assert_allclose(pixels(made)[32, 32, :3], (0, 0, 1), atol=1e-6)
    np.testing.assert_allclose(pixels(made)[2, 2, :3], (1, 0, 0), atol=1e-6)
    made = rasterize(
        margin=0, background="color", background_color=(0, 0, 1, 0.5), pixel_type="float"
    )
    np.testing.assert_allclose(pixels(made)[32, 32], (0, 0, 0.5, 0.5), atol=1e-6)
    mask = rasterize(margin=4.5, color="mask")
    assert mask.colorspace_settings.is_data
    values = pixels(mask)[..., 0]
    assert values[32, 32] == values[0, 0] == 0
    assert values[8, 8] == 1
    assert values[4, 8] == pytest.approx(0.5, abs=1 / 255)


@pytest.mark.parametrize(
    "name",
    [
        "box",
        "tent",
        "bspline2",
        "mitchell",
        "lanczos2",
        "lanczos3",
        "radial2",
        "radial3",
        "gaussian",
    ],
)
def test_filters_keep_areas(name):
    outlines.bezier_circle(outlines.curve())
    values = pixels(rasterize(filter=name, pixel_type="float"))[..., 3]
    box = pixels(rasterize(pixel_type="float"))[..., 3]
    assert values.min() >= 0
    assert values.max() <= 1
    assert values.sum(dtype=float) == pytest.approx(box.sum(dtype=float), rel=0.01)
    assert name == "box" or np.abs(values - box).max() > 0.01


def test_size_of_pixels_per_unit():
    outlines.square(side=2)
    made = rasterize(resolution="density", density=20.25, margin=3)
    assert tuple(made.size) == (47, 47)
    alpha = pixels(made)[..., 3]
    assert alpha.sum() == pytest.approx((2 * 20.25) ** 2, rel=2e-3)
    obj = bpy.context.object
    obj.scale = (1, 3, 1)
    assert tuple(rasterize(resolution="density", density=20, margin=0).size) == (40, 120)


def test_shapes_are_fitted_into_a_size():
    outlines.polygon(outlines.curve(), [(0, 0), (4, 0), (4, 1), (0, 1)])
    alpha = pixels(rasterize(width=64, height=32, margin=8))[..., 3]
    expected = np.zeros((32, 64))
    expected[10:22, 8:56] = 1
    np.testing.assert_array_equal(alpha, expected)


def test_views():
    obj = outlines.curve()
    outlines.polygon(obj, [(0, 0), (4, 0), (0, 2)])
    obj.matrix_world = Matrix.Rotation(math.radians(90), 4, "X")
    upright = pixels(rasterize(view="object", margin=0))[..., 3]
    np.testing.assert_array_equal(pixels(rasterize(view="front", margin=0))[..., 3], upright)
    assert upright[17, 2] == 1
    assert upright[52, 2] == upright[40, 60] == 0
    obj.matrix_world = Matrix.Rotation(math.radians(90), 4, "Z") @ obj.matrix_world
    np.testing.assert_allclose(
        pixels(rasterize(view="right", margin=0))[..., 3], upright, atol=1 / 255
    )
    obj.matrix_world = Matrix.Rotation(math.radians(180), 4, "Y")
    mirrored = pixels(rasterize(view="top", margin=0))[..., 3]
    np.testing.assert_allclose(mirrored, upright[:, ::-1], atol=1 / 255)


def test_camera():
    obj = outlines.curve()
    outlines.bezier_circle(obj)
    data = bpy.data.cameras.new("Camera")
    camera = bpy.data.objects.new("Camera", data)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    camera.location = (0, 0, 5)
    data.type, data.ortho_scale = "ORTHO", 4
    alpha = pixels(rasterize(view="camera", pixel_type="float"))[..., 3]
    assert alpha.sum(dtype=float) == pytest.approx(math.pi * 16**2, rel=1e-3)
    data.type, data.angle = "PERSP", 2 * math.atan(0.4)
    # At a distance of 5 the frame is 4 units wide; half as far away things are twice as large.
    alpha = pixels(rasterize(view="camera", pixel_type="float"))[..., 3]
    assert alpha.sum(dtype=float) == pytest.approx(math.pi * 16**2, rel=1e-3)
    obj.rotation_euler.x = 0.5
    alpha = pixels(rasterize(view="camera", pixel_type="float"))[..., 3]
    # Points of the circle, projected.
    turn = np.linspace(0, 2 * np.pi, 20000, endpoint=False)
    z = np.sin(0.5) * np.sin(turn)
    x, y = (one * 5 / (5 - z) * 16 for one in (np.cos(turn), np.cos(0.5) * np.sin(turn)))
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    assert alpha.sum(dtype=float) == pytest.approx(area, rel=1e-3)
    camera.location = (0, 0, 0.2)
    with pytest.raises(RuntimeError, match="reaches behind the camera"):
        rasterize(view="camera")
    data.type = "PANO"
    with pytest.raises(RuntimeError, match="'Camera' is panoramic"):
        rasterize(view="camera")
    bpy.context.scene.camera = None
    with pytest.raises(RuntimeError, match="the scene has no camera"):
        rasterize(view="camera")


def test_uv_mask():
    scenes.quads(
        "Quad",
        [
            [(0, 0), (0.5, 0), (0.5, 0.25), (0, 0.25)],
            [(0.25, 0.0), (0.75, 0.0), (0.75, 0.25), (0.25, 0.25)],
        ],
    )
    made = rasterize(width=32, height=16)
    assert made.name == "Quad.uv"
    assert made.colorspace_settings.is_data
    expected = np.zeros((16, 32))
    expected[:4, :24] = 1
    np.testing.assert_array_equal(pixels(made)[..., 0], expected)
    assert pixels(rasterize(tile=1002))[..., 0].max() == 0


def test_uv_mask_of_another_tile_and_of_a_flipped_chart():
    scenes.quads("Quad", [[(1.25, 1.5), (1.25, 1.75), (1.5, 1.75), (1.5, 1.5)]])
    values = pixels(rasterize(width=8, height=8, tile=1012))[..., 0]
    expected = np.zeros((8, 8))
    expected[4:6, 2:4] = 1
    np.testing.assert_array_equal(values, expected)


def test_uv_mask_agrees_with_texel_weights(addon):
    """Charts of a sphere: a texel that holds some of the surface is covered, and no other."""
    import prefilter

    bpy.ops.mesh.primitive_uv_sphere_add()
    values = pixels(rasterize(pixel_type="float", source="uv"))[..., 0]
    obj = bpy.context.object
    layouts = addon("bridge.uv_layouts")
    polygons = layouts.read_layout(obj, scenes.depsgraph())
    area = sum(
        0.5 * np.sum(p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1))
        for p in polygons
    )
    assert values.mean(dtype=float) == pytest.approx(area, rel=1e-5)
    assert prefilter is not None


def test_new_images_are_packed_and_outlive_the_file(tmp_path):
    outlines.bezier_circle(outlines.curve())
    before = {}
    for pixel_type in ("byte", "half", "float"):
        made = rasterize(pixel_type=pixel_type, image_name=pixel_type)
        assert made.packed_file is not None
        made.use_fake_user = True
        before[pixel_type] = pixels(made)
    assert bpy.data.images["half"].use_half_precision
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    for pixel_type, values in before.items():
        np.testing.assert_allclose(
            scenes.pixels(pixel_type), values, atol=1e-3 if pixel_type == "half" else 0
        )
        assert bpy.data.images[pixel_type].is_float == (pixel_type != "byte")


def test_names_and_report(capfd):
    outlines.text("a", "Sign")
    assert rasterize().name == "Sign"
    assert rasterize().name == "Sign.001"
    assert rasterize(image_name="Mine").name == "Mine"
    out = capfd.readouterr().out
    assert "Rasterized 'Sign.001': 64 x 64 pixels" in out
    obj = outlines.square()
    outlines.polygon(obj, [(0, 0), (1, 1), (2, 0)], closed=False)
    obj.data.bevel_depth = 0.1
    rasterize()
    out = capfd.readouterr().out
    assert "left out, because Blender fills only closed ones: 1 open spline of 'Square'" in out
    assert "bevel and extrusion of 'Square' do not show" in out


def test_undo():
    outlines.square()
    bpy.ops.ed.undo_push(message="before")
    rasterize()
    bpy.ops.ed.undo_push(message="rasterized")
    assert "Square" in bpy.data.images
    bpy.ops.ed.undo()
    assert not bpy.data.images
    bpy.ops.ed.redo()
    assert scenes.pixels("Square")[32, 32, 3] == 1


def test_poll():
    poll = bpy.ops.prefilter.rasterize.poll
    assert not poll()
    with pytest.raises(RuntimeError, match="Select curves or texts, or make a mesh with a UV map"):
        bpy.ops.prefilter.rasterize()
    obj = outlines.square()
    assert poll()
    obj.select_set(False)
    assert not poll()
    bpy.ops.mesh.primitive_cube_add()
    assert poll()
    bpy.context.object.data.uv_layers.remove(bpy.context.object.data.uv_layers[0])
    assert not poll()
    bpy.ops.object.mode_set(mode="EDIT")
    assert not poll()


def test_refused(capfd):
    obj = outlines.curve("Empty")
    assert "object 'Empty': found no closed splines to fill" in refused(capfd)
    outlines.polygon(obj, [(0, 0), (1, 0), (1, 1)], closed=False)
    assert "1 open spline of 'Empty'" in refused(capfd)
    outlines.polygon(obj, [(0, 0), (0, 0), (0, 0)])
    assert "the shapes have no area" in refused(capfd)
    outlines.polygon(obj, [(0, 0), (1, 0), (0, 1)])
    assert "Margin: 40 leaves no room in 64 x 64 pixels" in refused(capfd, margin=40)
    words = refused(capfd, resolution="density", density=1e6)
    assert "Pixels per Unit: 1e+06 would make an image of" in words
    assert "the limit is 65536" in words
    obj.scale = (0, 0, 0)
    assert "no area" in refused(capfd)
    assert "Make a mesh with a UV map the active object" in refused(capfd, source="uv")


def test_memory(capfd, monkeypatch, addon):
    outlines.square()
    monkeypatch.setattr(addon("core.memory"), "available_memory", lambda: 1e6)
    assert "an image of 256 x 256 pixels needs about 0.0 GB" in refused(
        capfd, width=256, height=256
    )


def test_text_without_area_of_a_sort():
    outlines.text(" ")
    with pytest.raises(RuntimeError, match="found no closed splines"):
        rasterize()
