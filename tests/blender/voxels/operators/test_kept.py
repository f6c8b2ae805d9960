# SPDX-License-Identifier: GPL-3.0-or-later

"""What results keep of an object besides its shape: modifiers, and marks of edges and vertices."""

import bodies
import bpy
import numpy as np
import pytest


def voxelize(**options):
    return bpy.ops.prefilter.voxelize(**{"depth": 5, **options})


def bent(location=(0, 0, 0)):
    """Returns a tall box whose upper half a bone has turned by a quarter, and its armature."""
    box = bodies.cube("Arm", scale=(1, 1, 1))
    for vertex in box.data.vertices:
        vertex.co.z = 4.0 * (vertex.co.z + 1.0)
    data = bpy.data.armatures.new("Bones")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, low, high in (("Low", 0, 4), ("High", 4, 8)):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, low), (0, 0, high)
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, chosen in (("Low", lambda z: z < 4), ("High", lambda z: z > 4)):
        group = box.vertex_groups.new(name=name)
        members = [vertex.index for vertex in box.data.vertices if chosen(vertex.co.z)]
        group.add(members, 1.0, "REPLACE")
    rig.select_set(False)
    bpy.context.view_layer.objects.active = box
    rig.pose.bones["High"].rotation_mode = "XYZ"
    rig.pose.bones["High"].rotation_euler = (0.5, 0, 0)
    return box, rig


def shown_box(obj):
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    points = np.array([obj.matrix_world @ vertex.co for vertex in mesh.vertices])
    return np.stack([points.min(axis=0), points.max(axis=0)])


@pytest.mark.parametrize("way", ["modifier", "parent"])
@pytest.mark.parametrize("faces", ["triangles", "quads"])
def test_armatures_deform_results_as_they_did_the_mesh(way, faces):
    box, rig = bent()
    if way == "modifier":
        box.modifiers.new("Rigged", "ARMATURE").object = rig
    else:
        box.parent, box.parent_type = rig, "ARMATURE"
        box.matrix_parent_inverse = rig.matrix_world.inverted()
    at_rest, posed = bodies.volume(box), shown_box(box)
    assert posed[1, 1] > 2 or posed[0, 1] < -2
    assert voxelize(depth=6, faces=faces) == {"FINISHED"}
    # The mesh is that at rest: a second pose would not be the first one twice.
    assert bodies.volume(box) == pytest.approx(at_rest, rel=0.01)
    assert np.ptp([vertex.co.z for vertex in box.data.vertices]) == pytest.approx(8.0, abs=0.1)
    # Between the bones a fine mesh bends where a box is straight.
    np.testing.assert_allclose(shown_box(box), posed, atol=0.3)
    if way == "modifier":
        (kept,) = box.modifiers
        assert (kept.name, kept.object, kept.show_viewport) == ("Rigged", rig, True)
    else:
        assert (box.parent, box.parent_type) == (rig, "ARMATURE")


def test_armatures_are_applied_where_no_weights_are_kept():
    box, rig = bent()
    box.modifiers.new("Rigged", "ARMATURE").object = rig
    posed = shown_box(box)
    voxelize(depth=6, use_attributes=False)
    assert not box.modifiers
    np.testing.assert_allclose(shown_box(box), posed, atol=0.15)


def test_modifiers_that_are_off_stay():
    box = bodies.cube()
    box.modifiers.new("Off", "SUBSURF").show_viewport = False
    array = box.modifiers.new("On", "ARRAY")
    array.count = 3
    box.modifiers.new("Details", "MULTIRES").show_viewport = False
    voxelize()
    assert box.modifiers.keys() == ["Off"]
    assert not box.modifiers["Off"].show_viewport
    assert bodies.volume(box) == pytest.approx(24.0, rel=0.05)


def test_modifiers_of_a_first_operand_that_are_off_stay():
    bodies.cube("Other", location=(1, 1, 1))
    box = bodies.cube("First")
    box.modifiers.new("Off", "SUBSURF").show_viewport = False
    assert bpy.ops.prefilter.boolean(depth=5) == {"FINISHED"}
    assert box.modifiers.keys() == ["Off"]


def test_locks_of_vertex_groups():
    box = bodies.cube()
    for name, is_locked in (("Free", False), ("Locked", True)):
        group = box.vertex_groups.new(name=name)
        group.add([0, 1, 2, 3], 1.0, "REPLACE")
        group.lock_weight = is_locked
    voxelize()
    assert {group.name: group.lock_weight for group in box.vertex_groups} == {
        "Free": False,
        "Locked": True,
    }


def marked_box():
    """A turned cube with creases around its top, a seam, a bevel weight and a creased vertex."""
    box = bodies.cube(rotation_euler=(0.3, 0.7, 1.1))
    mesh = box.data
    creases = mesh.attributes.new("crease_edge", "FLOAT", "EDGE")
    bevels = mesh.attributes.new("bevel_weight_edge", "FLOAT", "EDGE")
    points = mesh.attributes.new("crease_vert", "FLOAT", "POINT")
    for edge in mesh.edges:
        a, b = (mesh.vertices[vertex].co for vertex in edge.vertices)
        middle = (a + b) / 2
        if middle.z > 0.9:
            creases.data[edge.index].value = 0.5
        if middle.x > 0.9 and middle.y > 0.9:
            edge.use_seam = True
        if middle.x < -0.9 and middle.y < -0.9:
            bevels.data[edge.index].value = 0.25
    for vertex in mesh.vertices:
        if vertex.co.x > 0 and vertex.co.y < 0 and vertex.co.z < 0:
            points.data[vertex.index].value = 1.0
    return box


def length_of(mesh, edges):
    ends = [mesh.edges[edge].vertices for edge in edges]
    return sum((mesh.vertices[a].co - mesh.vertices[b].co).length for a, b in ends)


@pytest.mark.parametrize("options", [{}, {"adaptivity": 0.0}, {"faces": "quads"}])
def test_marks_lie_on_the_edges_that_had_them(options):
    box = marked_box()
    assert voxelize(**options) == {"FINISHED"}
    mesh = box.data
    places = np.array([vertex.co for vertex in mesh.vertices])
    middles = places[[list(edge.vertices) for edge in mesh.edges]].mean(axis=1)

    def found(name):
        data = mesh.attributes[name].data
        values = np.empty(len(data), np.float32)
        data.foreach_get("value", values)
        return values

    creases, bevels, points = map(found, ("crease_edge", "bevel_weight_edge", "crease_vert"))
    assert set(np.unique(creases)) == {0.0, 0.5}
    assert set(np.unique(bevels)) == {0.0, 0.25}
    seams = np.array([edge.use_seam for edge in mesh.edges])
    for marked, total in ((creases > 0, 8.0), (bevels > 0, 2.0), (seams, 2.0)):
        assert length_of(mesh, np.flatnonzero(marked)) == pytest.approx(total, rel=0.01)
    assert middles[creases > 0][:, 2].min() > 0.99
    assert middles[seams][:, :2].min() > 0.99
    assert middles[bevels > 0][:, :2].max() < -0.99
    (corner,) = np.flatnonzero(points)
    assert tuple(mesh.vertices[corner].co) == pytest.approx((1, -1, -1), abs=0.01)
    assert points[corner] == 1.0


def test_marks_of_operands():
    other = marked_box()
    other.name, other.location = "Other", (5, 0, 0)
    box = bodies.cube("First", location=(5, 0.2, 0), size=1.0)
    assert bpy.ops.prefilter.boolean(operation="union", depth=6) == {"FINISHED"}
    assert length_of(box.data, [e.index for e in box.data.edges if e.use_seam]) == pytest.approx(
        2.0, rel=0.01
    )


def test_marks_stay_away_without_attributes():
    box = marked_box()
    voxelize(use_attributes=False)
    assert "crease_edge" not in box.data.attributes
    assert not any(edge.use_seam for edge in box.data.edges)


def test_slots_of_one_material_stay_two():
    box = bodies.cube()
    red = bpy.data.materials.new("Red")
    box.data.materials.append(red)
    box.data.materials.append(red)
    for face in box.data.polygons:
        face.material_index = int(face.center.z > 0.9)
    voxelize()
    assert [material.name for material in box.data.materials] == ["Red", "Red"]
    for face in box.data.polygons:
        assert face.material_index == int(face.center.z > 0.99)
    bodies.cube("Other", location=(1.5, 0.1, 0.2)).data.materials.append(red)
    bpy.context.view_layer.objects.active = box
    box.select_set(True)
    bpy.ops.prefilter.boolean(operation="union", depth=5)
    assert [material.name for material in box.data.materials] == ["Red", "Red"]
    top = {face.material_index for face in box.data.polygons if face.center.z > 1.1}
    assert top == {0}


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_colors_stay_where_they_were(domain):
    ball = bodies.sphere()
    colors = ball.data.color_attributes.new("Paint", "FLOAT_COLOR", domain)
    for entry in colors.data:
        entry.color = (1, 0, 0, 1)
    voxelize()
    assert ball.data.color_attributes["Paint"].domain == domain
