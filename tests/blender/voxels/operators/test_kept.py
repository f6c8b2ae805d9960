# SPDX-License-Identifier: GPL-3.0-or-later

"""Data that results keep besides the shape: modifiers, and marks of edges and vertices."""

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


VALUES = {
    "FLOAT": -0.75,
    "INT": 70000,
    "INT8": -3,
    "BOOLEAN": True,
    "FLOAT2": (0.5, -0.25),
    "FLOAT_VECTOR": (0.0, 2.0, -1.0),
    "FLOAT4": (0.0, 0.0, 0.5, 1.0),
    "FLOAT_COLOR": (0.25, 0.5, 0.75, 1.0),
    "BYTE_COLOR": (1.0, 0.0, 1.0, 1.0),
    "INT16_2D": (-7, 300),
    "INT32_2D": (100000, -1),
    "QUATERNION": (0.5, -0.5, 0.5, 0.5),
    "FLOAT4X4": tuple(range(16)),
}
"""One value of each attribute type, except strings."""
FIELDS = {"FLOAT2": "vector", "FLOAT_VECTOR": "vector", "FLOAT4": "vector"}


def types():
    """Returns all types of attributes that this Blender has."""
    items = bpy.types.Attribute.bl_rna.properties["data_type"].enum_items
    return [item.identifier for item in items]


def field_of(data_type):
    return "color" if data_type.endswith("COLOR") else FIELDS.get(data_type, "value")


def values_of(attribute):
    width = np.size(VALUES[attribute.data_type])
    dtype = np.int32 if attribute.data_type.startswith("INT") else np.float32
    dtype = bool if attribute.data_type == "BOOLEAN" else dtype
    found = np.zeros(len(attribute.data) * width, dtype)
    attribute.data.foreach_get(field_of(attribute.data_type), found)
    return found.reshape(-1, width)


def others_of(data_type):
    """Returns the neutral value of a type: 0, or no rotation."""
    others = np.zeros(np.size(VALUES[data_type]))
    others[0] = data_type == "QUATERNION"
    return others


def fill(attribute, chosen, others=0):
    """Gives some elements the value of their type."""
    values = np.zeros_like(values_of(attribute))
    values[:] = others
    values[chosen] = VALUES[attribute.data_type]
    attribute.data.foreach_set(field_of(attribute.data_type), values.ravel())


def test_all_attribute_types_are_tested():
    assert set(types()) - set(VALUES) == {"STRING"}


@pytest.mark.parametrize("options", [{}, {"faces": "quads"}])
def test_attributes_of_edges_lie_on_the_edges_that_had_them(options):
    box = marked_box()
    tops = [all(box.data.vertices[v].co.z > 0 for v in edge.vertices) for edge in box.data.edges]
    of_types = [name for name in types() if name in VALUES]
    for data_type in of_types:
        fill(box.data.attributes.new(f"All {data_type}", data_type, "EDGE"), np.array(tops))
    assert voxelize(**options) == {"FINISHED"}
    mesh = box.data
    places = np.array([vertex.co for vertex in mesh.vertices])
    lows = places[[list(edge.vertices) for edge in mesh.edges]][:, :, 2].min(axis=1)
    for data_type in of_types:
        attribute = mesh.attributes[f"All {data_type}"]
        assert (attribute.data_type, attribute.domain) == (data_type, "EDGE")
        values = values_of(attribute)
        is_marked = values.any(axis=1)
        assert length_of(mesh, np.flatnonzero(is_marked)) == pytest.approx(8.0, rel=0.01)
        assert lows[is_marked].min() > 0.99
        expected = np.broadcast_to(VALUES[data_type], values[is_marked].shape)
        np.testing.assert_array_equal(values[is_marked], expected)


@pytest.mark.parametrize("domain", ["POINT", "CORNER", "FACE"])
def test_attributes_of_all_types_arrive(domain, capfd):
    box = bodies.cube(rotation_euler=(0.3, 0.7, 1.1))
    mesh = box.data
    where = {
        "POINT": [vertex.co.x for vertex in mesh.vertices],
        "CORNER": [mesh.vertices[loop.vertex_index].co.x for loop in mesh.loops],
        "FACE": [face.center.x for face in mesh.polygons],
    }
    for data_type in types():
        attribute = mesh.attributes.new(f"All {data_type}", data_type, domain)
        if data_type in VALUES:
            fill(attribute, np.array(where[domain]) > 0.5, others_of(data_type))
    assert voxelize(adaptivity=0.0) == {"FINISHED"}
    told = "object 'Cube': attributes of types that cannot be kept: 'All STRING'"
    assert told in capfd.readouterr().out
    mesh = box.data
    assert "All STRING" not in mesh.attributes
    places = np.array([vertex.co.x for vertex in mesh.vertices])
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    for data_type, value in VALUES.items():
        if data_type not in types():
            continue
        attribute = mesh.attributes[f"All {data_type}"]
        values = values_of(attribute)
        if domain == "FACE":
            share = np.array([face.normal.x > 0.5 for face in mesh.polygons], float)
        else:
            share = (places[corners] if attribute.domain == "CORNER" else places) / 2 + 0.5
        is_sure = (share < 1e-3) | (share > 1 - 1e-3)
        assert is_sure.sum() > 100
        expected = np.where((share > 0.5)[:, None], value, others_of(data_type))
        np.testing.assert_allclose(values[is_sure], expected[is_sure], atol=3e-3, rtol=3e-3)


def test_rotations_are_interpolated():
    """Half of the way between no turn and one by 90 degrees is one by 45; signs are no matter."""
    box = bodies.cube()
    turns = box.data.attributes.new("Turn", "QUATERNION", "POINT")
    half = np.sqrt(0.5)
    for vertex in box.data.vertices:
        sign = -1.0 if vertex.co.y > 0 else 1.0
        turn = (half, 0.0, 0.0, half) if vertex.co.x > 0 else (1.0, 0.0, 0.0, 0.0)
        turns.data[vertex.index].value = [sign * one for one in turn]
    voxelize(adaptivity=0.0)
    mesh = box.data
    values = values_of(mesh.attributes["Turn"])
    np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1.0, atol=1e-6)
    places = np.array([vertex.co.x for vertex in mesh.vertices])
    # A mean of both that is made as long as one again.
    share = (places + 1) / 2
    expected = np.stack([1 - share + half * share, half * share], axis=1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    np.testing.assert_allclose(np.abs(values[:, [0, 3]]), expected, atol=2e-3)


def freestyle(mesh, element):
    """Returns which edges, or faces, are marked for Freestyle."""
    elements, attribute = (
        (mesh.edges, "freestyle_edge") if element == "edge" else (mesh.polygons, "freestyle_face")
    )
    if hasattr(elements[0], "use_freestyle_mark"):
        return np.array([one.use_freestyle_mark for one in elements])
    if attribute not in mesh.attributes:
        return np.zeros(len(elements), bool)
    return np.array([one.value for one in mesh.attributes[attribute].data])


def mark_for_freestyle(mesh, element, chosen):
    elements, attribute = (
        (mesh.edges, "freestyle_edge") if element == "edge" else (mesh.polygons, "freestyle_face")
    )
    if hasattr(elements[0], "use_freestyle_mark"):
        elements.foreach_set("use_freestyle_mark", chosen)
    else:
        made = mesh.attributes.new(attribute, "BOOLEAN", "EDGE" if element == "edge" else "FACE")
        made.data.foreach_set("value", chosen)


def test_marks_for_freestyle():
    box = marked_box()
    mesh = box.data
    tops = [all(mesh.vertices[v].co.z > 0 for v in edge.vertices) for edge in mesh.edges]
    mark_for_freestyle(mesh, "edge", tops)
    mark_for_freestyle(mesh, "face", [face.center.z > 0.9 for face in mesh.polygons])
    assert voxelize() == {"FINISHED"}
    mesh = box.data
    edges = np.flatnonzero(freestyle(mesh, "edge"))
    assert length_of(mesh, edges) == pytest.approx(8.0, rel=0.01)
    expected = [face.center.z > 0.99 for face in mesh.polygons]
    np.testing.assert_array_equal(freestyle(mesh, "face"), expected)


def test_marks_of_operands():
    other = marked_box()
    other.name, other.location = "Other", (5, 0, 0)
    box = bodies.cube("First", location=(5, 0.2, 0), size=1.0)
    assert bpy.ops.prefilter.boolean(operation="union", depth=6) == {"FINISHED"}
    assert length_of(box.data, [e.index for e in box.data.edges if e.use_seam]) == pytest.approx(
        2.0, rel=0.01
    )


def test_marks_are_not_transferred_without_attributes():
    box = marked_box()
    voxelize(use_attributes=False)
    assert "crease_edge" not in box.data.attributes
    assert not any(edge.use_seam for edge in box.data.edges)


def test_two_slots_of_one_material_stay_separate():
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
def test_colors_keep_their_positions(domain):
    ball = bodies.sphere()
    colors = ball.data.color_attributes.new("Paint", "FLOAT_COLOR", domain)
    for entry in colors.data:
        entry.color = (1, 0, 0, 1)
    voxelize()
    assert ball.data.color_attributes["Paint"].domain == domain
