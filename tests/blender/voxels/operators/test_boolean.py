# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.boolean`, as scripts call it: volumes of boxes are known."""

import bodies
import bpy
import numpy as np
import pytest


def boolean(**options):
    return bpy.ops.prefilter.boolean(**{"depth": 6, **options})


@pytest.fixture
def pair():
    """Makes two cubes of volume 8 with 1 x 2 x 2 in common; the first one is active."""
    other = bodies.cube("Other", location=(1, 0, 0))
    first = bodies.cube("First")
    assert other.select_get()
    return first, other


@pytest.mark.parametrize(
    ("operation", "volume", "box"),
    [
        ("difference", 4.0, [(-1, -1, -1), (0, 1, 1)]),
        ("intersection", 4.0, [(0, -1, -1), (1, 1, 1)]),
        ("union", 12.0, [(-1, -1, -1), (2, 1, 1)]),
    ],
)
def test_volumes(pair, operation, volume, box):
    first, other = pair
    assert boolean(operation=operation) == {"FINISHED"}
    assert bodies.is_closed(first)
    assert bodies.volume(first) == pytest.approx(volume, rel=0.05)
    np.testing.assert_allclose(bodies.world_box(first), box, atol=0.06)
    assert len(other.data.vertices) == 8


def test_reports_its_result(pair, capfd):
    boolean()
    assert "Difference with 'Other': 'First' in 64³ cells of" in capfd.readouterr().out


@pytest.mark.parametrize("operands", ["keep", "hide", "delete"])
def test_other_operands(pair, operands):
    boolean(operands=operands)
    other = bpy.data.objects.get("Other")
    assert (other is None) == (operands == "delete")
    if other is not None:
        assert other.hide_get() == (operands == "hide")
        assert other.hide_render == (operands == "hide")


def test_many_operands():
    for i in range(3):
        bodies.cube(f"Bite{i}", size=0.5, location=(i - 1, 1, 1))
    first = bodies.cube("First")
    assert boolean(depth=7) == {"FINISHED"}
    bites = 0.25**2 * (0.5 + 2 * 0.25)
    assert bodies.volume(first) == pytest.approx(8 - bites, rel=0.01)


def test_in_the_space_of_the_active_object():
    bodies.cube("Other", location=(5, 0, 1))
    first = bodies.cube("First", location=(5, 0, 0), scale=(-1, 1, 1), rotation_euler=(0, 0, 0.5))
    scale, place = first.scale.copy(), first.location.copy()
    assert boolean(operation="union") == {"FINISHED"}
    assert (first.scale, first.location) == (scale, place)
    assert bodies.is_closed(first)
    assert bodies.world_box(first)[:, 2] == pytest.approx((-1, 2), abs=0.1)
    assert bodies.volume(first) > 11


def test_open_and_inside_out_operands(pair, capfd):
    first, other = pair
    bodies.turned(other)
    bodies.without_faces(first, 1)
    boolean(operation="union")
    assert bodies.is_closed(first)
    out = capfd.readouterr().out
    assert "Warning: object 'Other' was inside out" in out
    assert "object 'First' has 4 open edges; the result is closed" in out


def test_coincident_faces():
    bodies.cube("Other", location=(2, 0, 0))
    first = bodies.cube("First")
    boolean(operation="union")
    assert bodies.is_closed(first)
    assert bodies.volume(first) == pytest.approx(16, rel=0.05)


def test_one_inside_the_other():
    bodies.cube("Other", size=1.0)
    first = bodies.cube("First")
    boolean()
    assert bodies.is_closed(first)
    assert bodies.volume(first) == pytest.approx(7, rel=0.05)


def test_materials_of_all_operands(pair):
    for obj in pair:
        obj.data.materials.append(bpy.data.materials.new(obj.name))
    first, _ = pair
    boolean()
    assert [material.name for material in first.data.materials] == ["First", "Other"]
    cut = [face for face in first.data.polygons if np.abs(face.center[1:]).max() < 0.8]
    for face in cut:
        assert face.material_index == int(face.center.x > -0.5)


def test_colors_where_one_operand_has_them(pair):
    first, other = pair
    colors = other.data.color_attributes.new("Paint", "BYTE_COLOR", "POINT")
    for entry in colors.data:
        entry.color = (1, 0, 0, 1)
    boolean(operation="union")
    made = first.data.color_attributes["Paint"]
    assert made.domain == "CORNER"
    for face in first.data.polygons:
        # Between, faces of both lie on each other.
        if -0.05 < face.center.x < 1.05:
            continue
        wanted = (1, 0, 0, 1) if face.center.x > 0 else (1, 1, 1, 1)
        for corner in face.loop_indices:
            assert tuple(made.data[corner].color) == pytest.approx(wanted)


def test_nothing_in_common():
    bodies.cube("Other", location=(9, 0, 0))
    first = bodies.cube("First")
    with pytest.raises(RuntimeError, match="object 'First': the objects have nothing in common"):
        boolean(operation="intersection")
    assert len(first.data.vertices) == 8


def test_nothing_left():
    other = bodies.cube("Other", size=4.0)
    first = bodies.cube("First")
    with pytest.raises(RuntimeError, match="object 'First': the result is empty"):
        boolean(operands="delete")
    assert len(first.data.vertices) == 8
    assert not other.hide_get()


def test_hidden_operands_do_not_count(pair):
    _, other = pair
    other.hide_set(True)
    with pytest.raises(RuntimeError, match="Select one more object"):
        boolean()


def test_operand_without_faces():
    bodies.body("None", bpy.data.meshes.new("None"))
    bodies.cube("First")
    with pytest.raises(RuntimeError, match="object 'None': found no faces"):
        boolean()


def test_poll(pair):
    first, _ = pair
    assert bpy.ops.prefilter.boolean.poll()
    first.select_set(False)
    with pytest.raises(RuntimeError, match="make it the active one"):
        boolean()
    first.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Switch to Object Mode first"):
        boolean()
