# SPDX-License-Identifier: GPL-3.0-or-later

"""Curve and text objects as closed contours, against Blender's own evaluation."""

import itertools
import math

import bpy
import numpy as np
import outlines
import pytest
import scenes


@pytest.fixture
def read(addon):
    """Returns a function that reads one object."""
    return lambda obj: addon("bridge.curves").read_curves([obj], scenes.depsgraph())[0]


def along(contour, count):
    """Returns (segments, count, 3) points of rational Bezier segments, by de Casteljau's scheme."""
    t = np.linspace(0, 1, count)[None, :, None]
    points = [contour[:, None, k] for k in range(contour.shape[1])]
    while len(points) > 1:
        points = [(1 - t) * a + t * b for a, b in itertools.pairwise(points)]
    found = np.broadcast_to(points[0], (len(contour), count, 4))
    return found[..., :3] / found[..., 3:]


def evaluated_points(obj):
    mesh = obj.evaluated_get(scenes.depsgraph()).to_mesh()
    points = np.array([vertex.co for vertex in mesh.vertices])
    obj.evaluated_get(scenes.depsgraph()).to_mesh_clear()
    return points


@pytest.mark.parametrize("weighted", [False, True])
def test_nurbs_match_blenders_evaluation(read, weighted):
    compared = 0
    for order, bezier, endpoint in itertools.product((2, 3, 4, 5, 6), (False, True), (False, True)):
        # Blender draws no Bezier knots of a higher order.
        if not bezier or order <= 4:
            compared += compare_nurbs(read, order, bezier, endpoint, weighted)
    assert compared > 1000


def compare_nurbs(read, order, bezier, endpoint, weighted):
    """Compares a random curve with Blender's points, and returns how many there are."""
    rng = np.random.default_rng(order)
    count = 12
    turn = np.arange(count) * 2 * np.pi / count
    points = np.stack([np.cos(turn), np.sin(turn), rng.random(count)], axis=1)
    points += 0.2 * rng.random(points.shape)
    weights = 0.5 + rng.random(count) if weighted else np.ones(count)
    obj = outlines.curve(dimensions="3D")
    spline = outlines.nurbs(
        obj, np.c_[points, weights], order=order, bezier=bezier, endpoint=endpoint
    )
    spline.resolution_u = 10
    (contour,) = read(obj).fills[0].contours
    np.testing.assert_allclose(along(contour, 2)[1:, 0], along(contour, 2)[:-1, 1], atol=1e-6)
    found = along(contour, 400).reshape(-1, 3)
    points = evaluated_points(obj)
    for point in points:
        assert np.linalg.norm(found - point, axis=1).min() < 0.01
    bpy.data.objects.remove(obj)
    return len(points)


def test_nurbs_circle_is_a_circle(read):
    obj = outlines.curve()
    outlines.nurbs(obj, outlines.NURBS_CIRCLE, order=3, bezier=True, endpoint=True)
    (contour,) = read(obj).fills[0].contours
    assert contour.shape == (4, 3, 4)
    radius = np.linalg.norm(along(contour, 50)[..., :2], axis=-1)
    np.testing.assert_allclose(radius, 1.0, atol=1e-7)


def test_bezier_points_are_kept_exactly_and_placed_in_the_world(read):
    obj = outlines.curve()
    outlines.bezier_circle(obj)
    obj.location, obj.scale = (4, 5, 6), (2, 3, 1)
    (contour,) = read(obj).fills[0].contours
    assert contour.shape == (4, 4, 4)
    assert (contour[..., 3] == 1).all()
    np.testing.assert_allclose(contour[0, 0, :3], (6, 5, 6))
    np.testing.assert_allclose(contour[0, 1, :3], (6, 5 + 3 * outlines.CIRCLE_HANDLE, 6), rtol=1e-6)
    np.testing.assert_array_equal(contour[:-1, 3], contour[1:, 0])
    np.testing.assert_array_equal(contour[-1, 3], contour[0, 0])


def test_fills_by_letter_and_by_material(read):
    text = outlines.text("o i")
    assert [len(fill.contours) for fill in read(text).fills] == [2, 2]
    obj = outlines.curve()
    outlines.colored(obj, (1, 0, 0), (0, 1, 0, 0.5))
    for slot, at in ((0, 0.0), (1, 2.0), (0, 4.0)):
        outlines.polygon(obj, [(at, 0), (at + 1, 0), (at, 1)], slot=slot)
    fills = read(obj).fills
    assert [len(fill.contours) for fill in fills] == [2, 1]
    assert [fill.color for fill in fills] == [(1, 0, 0, 1), (0, 1, 0, 0.5)]


def test_splines_that_fill_nothing(read):
    obj = outlines.curve()
    assert read(obj).fills == []
    outlines.polygon(obj, [(0, 0), (1, 0), (1, 1)], closed=False)
    obj.data.splines.new("BEZIER").use_cyclic_u = True
    obj.data.splines.new("POLY").use_cyclic_u = True
    found = read(obj)
    assert (found.fills, found.open_splines) == ([], 1)
    assert read(outlines.text("")).fills == []


def test_open_splines_are_left_out_as_blender_leaves_them_out():
    """Blender fills closed splines by the even-odd rule, whatever their direction."""
    obj = outlines.curve()
    obj.data.fill_mode = "BOTH"

    def area():
        mesh = obj.evaluated_get(scenes.depsgraph()).to_mesh()
        return sum(face.area for face in mesh.polygons)

    outlines.polygon(obj, [(0, 0), (4, 0), (4, 4), (0, 4)], closed=False)
    assert area() == 0
    obj.data.splines.clear()
    outlines.polygon(obj, [(0, 0), (4, 0), (4, 4), (0, 4)])
    outlines.polygon(obj, [(1, 1), (3, 1), (3, 3), (1, 3)])
    assert area() == pytest.approx(12)


def test_other_modifiers_than_those_on_splines_are_reported(read):
    obj = outlines.curve()
    outlines.bezier_circle(obj)
    cast = obj.modifiers.new("Bend", "SIMPLE_DEFORM")
    cast.deform_method, cast.factor, cast.deform_axis = "TAPER", 1.0, "X"
    cast.use_apply_on_spline = True
    before = read(obj).fills[0].contours[0]
    cast.show_viewport = False
    assert not np.allclose(before, read(obj).fills[0].contours[0])
    assert read(obj).problems == []
    obj.modifiers.new("Solid", "SOLIDIFY")
    obj.data.extrude, obj.data.offset = 0.1, 0.1
    assert [problem.split()[0] for problem in read(obj).problems] == [
        "bevel",
        "offset",
        "modifiers",
    ]


def test_edit_mode_and_hidden_objects(read):
    obj = outlines.curve()
    outlines.bezier_circle(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.curve.select_all(action="SELECT")
    bpy.ops.transform.resize(value=(2, 2, 2))
    assert read(obj).fills[0].contours[0][0, 0, 0] == pytest.approx(2)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.hide_set(True)
    assert read(obj).fills[0].contours[0][0, 0, 0] == pytest.approx(2)
    text = outlines.text("o")
    text.hide_viewport = True
    assert len(read(text).fills[0].contours) == 2


def test_not_finite(read):
    obj = outlines.square()
    obj.data.splines[0].points[1].co = (math.nan, 0, 0, 1)
    with pytest.raises(ValueError, match=r"object 'Square'.*finite"):
        read(obj)
