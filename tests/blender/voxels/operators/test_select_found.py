# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.select_found`: the places of a report are selected where the mesh was built so."""

import bmesh
import bodies
import bpy
import pytest

DONE = {"FINISHED"}


def voxelize(obj, **options):
    assert bpy.ops.prefilter.voxelize(**{"depth": 6, **options}) == DONE
    return obj.prefilter_found


def select(found, kind, operand=""):
    """Presses the row of a kind of places; returns the object, its edges and faces selected."""
    kinds = [(place.kind, place.operand) for place in found.places]
    assert bpy.ops.prefilter.select_found(index=kinds.index((kind, operand))) == DONE
    obj = bpy.context.active_object
    assert bpy.context.mode == "EDIT_MESH"
    mesh = bmesh.from_edit_mesh(obj.data)
    edges = {i.index for i in mesh.edges if i.select}
    return obj, edges, {i.index for i in mesh.faces if i.select}


def with_plate(obj):
    """Adds a thin box to an object; returns the numbers of its two large faces."""

    def change(bm):
        made = bmesh.ops.create_cube(bm, size=1.0)
        for vertex in made["verts"]:
            vertex.co = (vertex.co.x, vertex.co.y, 2.0 + 0.01 * vertex.co.z)

    bodies.changed(obj, change)
    return {face.index for face in obj.data.polygons if face.area > 0.9 and face.center.z > 1.9}


def test_thin_faces():
    obj = bodies.cube()
    wanted = with_plate(obj)
    found = voxelize(obj)
    assert (tuple(found.parts), tuple(found.genus)) == ((2, 2), (0, 0))
    source, _, faces = select(found, "THIN")
    assert source.name == "Cube.source"
    assert faces == wanted
    assert found.places[0].count == len(wanted) == 2
    assert found.advice.startswith("Walls of 0.2 cells: depth ")


def test_open_edges_and_flipped_faces():
    obj = bodies.cube()
    bodies.without_faces(obj, 1)

    def flip(bm):
        bm.faces.ensure_lookup_table()
        bm.faces[2].normal_flip()

    bodies.changed(obj, flip)
    border = {edge.index for edge in obj.data.edges if _uses(obj.data, edge) == 1}
    found = voxelize(obj)
    source, edges, _ = select(found, "OPEN")
    assert edges == border
    assert len(edges) == 4
    again, _, faces = select(found, "TURNED")  # From Edit Mode.
    assert again == source
    assert faces == {2}


def test_lost_faces():
    obj = bodies.cube()

    def change(bm):
        made = bmesh.ops.create_cube(bm, size=0.001)
        bmesh.ops.translate(bm, verts=made["verts"], vec=(0, 0, 2))

    bodies.changed(obj, change)
    found = voxelize(obj, thickness=0.0)
    assert tuple(found.parts) == (2, 1)
    assert select(found, "LOST")[2] == set(range(6, 12))


def test_with_modifiers_the_nearest_faces_are_selected():
    obj = bodies.cube()
    wanted = with_plate(obj)
    obj.modifiers.new("Triangles", "TRIANGULATE")
    array = obj.modifiers.new("More", "SUBSURF")
    array.subdivision_type = "SIMPLE"
    array.levels = 2
    found = voxelize(obj)
    _, _, faces = select(found, "THIN")
    assert wanted <= faces
    assert all(face in wanted or face >= 6 for face in faces)


def test_operands_of_a_boolean():
    other = bodies.cube("Other", location=(5, 0, 0))
    wanted = with_plate(other)
    cube = bodies.cube()
    other.select_set(True)
    bpy.context.view_layer.objects.active = cube
    assert bpy.ops.prefilter.boolean(depth=6, operation="union") == DONE
    source, _, faces = select(cube.prefilter_found, "THIN", "Other")
    assert source == other
    assert faces == wanted


def test_intact_meshes_have_no_rows():
    obj = bodies.sphere()
    assert not voxelize(obj).places
    assert not bpy.ops.prefilter.select_found.poll()


def test_rows_are_checked():
    obj = bodies.cube()
    with_plate(obj)
    voxelize(obj)
    with pytest.raises(RuntimeError, match="no such row"):
        bpy.ops.prefilter.select_found(index=7)


def test_no_report_is_stored_without_the_original():
    obj = bodies.cube()
    with_plate(obj)
    assert not voxelize(obj, originals="replace").is_there


def _uses(mesh, edge):
    return sum(edge.key in face.edge_keys for face in mesh.polygons)
