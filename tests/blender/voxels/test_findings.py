# SPDX-License-Identifier: GPL-3.0-or-later

"""Reports on meshes: each number against the construction of the mesh."""

import importlib
import math

import bmesh
import bodies
import bpy
import pytest
from mathutils import Matrix
from voxel_reports import outcome, rows, the_line

DONE = {"FINISHED"}
PACKAGE = "bl_ext.user_default.prefilter"


def cells_of(obj, depth):
    """Returns the side of a cell: the grid leaves two cells on all sides."""
    return max(obj.dimensions) / (2**depth - 4)


def plate(thickness, depth=6):
    """Returns a plate, so many cells thick."""
    obj = bodies.cube("Plate", size=1.0)
    side = 10.0
    cell = side / (2**depth - 4)
    for vertex in obj.data.vertices:
        x, y, z = vertex.co
        vertex.co = (side * x, side * y, thickness * cell * z)
    bpy.context.view_layer.update()
    assert cells_of(obj, depth) == pytest.approx(cell)
    return obj


def torus():
    assert bpy.ops.mesh.primitive_torus_add() == DONE
    return bpy.context.active_object


def test_parts_and_genus_of_intact_meshes():
    assert the_line(outcome(bodies.sphere())) == [
        "parts: 1 before, 1 after",
        "genus: 0 before, 0 after",
    ]
    assert the_line(outcome(torus())) == ["parts: 1 before, 1 after", "genus: 1 before, 1 after"]


@pytest.mark.parametrize("is_turned", [False, True])
@pytest.mark.parametrize("radius", [0.5, 0.02])
def test_cavities(radius, is_turned):
    """A hollow ball is one part, whichever way its faces look; a cavity of half a cell goes."""
    obj = bodies.sphere(subdivisions=3)

    def change(bm):
        made = bmesh.ops.create_icosphere(bm, subdivisions=3, radius=radius)["verts"]
        inner = list({face for vertex in made for face in vertex.link_faces})
        bmesh.ops.reverse_faces(bm, faces=bm.faces[:] if is_turned else inner)
        if is_turned:
            bmesh.ops.reverse_faces(bm, faces=inner)

    bodies.changed(obj, change)
    line = the_line(outcome(obj))
    assert line[0] == "parts: 1 before, 1 after"
    lost = ["cavities: 1 before, 0 after"] if radius < 0.1 else []
    assert line[1:] == [*lost, "genus: 0 before, 0 after"]


@pytest.mark.parametrize(("degrees", "is_told"), [(6.0, True), (16.0, False), (25.0, False)])
def test_wedges_are_no_walls(degrees, is_told):
    """No depth keeps the edge of a wedge, and nobody is told of walls of 0.01 cells."""
    obj = plate(1.0)
    far = math.tan(math.radians(degrees / 2))
    for vertex in obj.data.vertices:
        vertex.co.z = math.copysign(far * (vertex.co.x + 5.0), vertex.co.z)
    line = the_line(outcome(obj))
    assert any(row.startswith("faces thickened: ") for row in line)
    assert any(row.startswith("walls of ") for row in line) == is_told
    assert not any("no depth" in row for row in line)


@pytest.mark.parametrize(("thickness", "depth"), [(1.0, 7), (0.5, 8), (0.3, 9)])
def test_a_thin_plate(thickness, depth):
    line = the_line(outcome(plate(thickness)))
    assert line[:2] == ["parts: 1 before, 1 after", "genus: 0 before, 0 after"]
    assert line[2] == "faces thickened: 2"
    assert line[3] == f"walls of {thickness} cells: depth {depth} keeps them"
    assert len(line) == 4
    bpy.ops.object.select_all(action="DESELECT")
    assert len(the_line(outcome(plate(thickness), depth=depth))) == 2


def test_advice_of_a_voxel_size():
    obj = plate(1.0)
    line = the_line(outcome(obj, resolution="size", voxel_size=0.16))
    assert line[3].startswith("walls of 1.0 cells: voxel size 8 cm keeps")


def test_sheets():
    assert bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4) == DONE
    line = the_line(outcome(bpy.context.active_object))
    assert line == [
        *("parts: 1 before, 1 after", "genus: 0 before, 0 after"),
        *("faces thickened: 16", "sheets: no depth keeps them"),
    ]


def test_walls_beside_sheets():
    """The advised depth preserves the walls, though sheets have a greater area."""
    obj = plate(0.5)

    def change(bm):
        for k in range(4):
            made = bmesh.ops.create_grid(bm, x_segments=1, y_segments=1, size=4.9)
            bmesh.ops.translate(bm, verts=made["verts"], vec=(0.0, 0.0, k + 1.0))

    bodies.changed(obj, change)
    assert the_line(outcome(obj))[-1] == "walls of 0.5 cells: depth 8 keeps them"


def test_holes_and_lost_parts():
    obj = bodies.sphere(subdivisions=4)

    def change(bm):
        bm.faces.ensure_lookup_table()
        # Two of an icosphere's triangles have no vertex in common.
        first = bm.faces[0]
        other = next(f for f in bm.faces if not {*f.verts} & {*first.verts})
        bmesh.ops.delete(bm, geom=[first, other], context="FACES_ONLY")
        for k in range(3):
            made = bmesh.ops.create_cube(bm, size=0.004)
            bmesh.ops.translate(bm, verts=made["verts"], vec=(0.9, 0.9, 0.3 * k))

    bodies.changed(obj, change)
    line = the_line(outcome(obj))
    assert "holes closed: 2" in line
    assert "parts: 4 before, 4 after" in line
    assert not any("lost" in row for row in line)
    found = outcome(obj)  # The result of before, whole.
    assert the_line(found)[0] == "parts: 4 before, 4 after"


def test_parts_are_lost_without_a_thickness():
    obj = bodies.sphere(subdivisions=3)

    def change(bm):
        for k in range(3):
            made = bmesh.ops.create_cube(bm, size=0.01)
            bmesh.ops.translate(bm, verts=made["verts"], vec=(0.9, 0.9, 0.3 * k))

    bodies.changed(obj, change)
    found = outcome(obj, thickness=0.0)
    assert any("parts lost: 3" in one for one in found.warnings)
    line = the_line(found)
    assert line[0] == "parts: 4 before, 1 after"
    assert line[-1].startswith("walls of 0.3 cells: depth ")


def test_objects_that_fall_apart():
    obj = plate(0.9)
    obj.rotation_euler = (0.02, 0.03, 0.4)
    bpy.context.view_layer.update()
    line = the_line(outcome(obj, thickness=0.0, interpolant="plane"))
    before, after = (int(word) for word in line[0].split() if word.isdigit())
    assert (before, after > before) == (1, True)
    # The box around it is 1.3 times as wide, and so are the cells.
    assert line[-1] == "walls of 0.7 cells: depth 8 keeps them"


def recounted(mesh):
    """Returns the parts and the genus of a closed mesh, by walks over its faces."""
    beside = {}
    for face in mesh.polygons:
        for key in face.edge_keys:
            beside.setdefault(key, []).append(face.index)
    assert all(len(faces) == 2 for faces in beside.values())
    seen, parts = set(), 0
    for first in mesh.polygons:
        todo = [] if first.index in seen else [first.index]
        parts += len(todo)
        seen.update(todo)
        while todo:
            keys = mesh.polygons[todo.pop()].edge_keys
            near = {other for key in keys for other in beside[key]} - seen
            seen |= near
            todo += near
    euler = len(mesh.vertices) - len(beside) + len(mesh.polygons)
    return parts, parts - euler // 2


def eye_fronts(monkey):
    """Returns the middles of faces that look ahead of the parts before the monkey's face."""
    mesh = bmesh.new()
    mesh.from_mesh(monkey.data)
    ahead = [face for face in mesh.faces if face.normal.y < -0.9]
    first = min(face.calc_center_median().y for face in ahead)
    found = [face.calc_center_median().copy() for face in ahead]
    mesh.free()
    return [point for point in found if point.y < first + 0.05 and abs(point.x) > 0.2]


@pytest.mark.parametrize("faces", ["triangles", "quads"])
def test_a_monkey_loses_no_eyes(faces):
    """They reach into the head, and so become one part with it."""
    assert bpy.ops.mesh.primitive_monkey_add() == DONE
    monkey = bpy.context.active_object
    fronts, cell = eye_fronts(monkey), cells_of(monkey, 7)
    assert {point.x > 0 for point in fronts} == {True, False}
    found = outcome(monkey, faces=faces, depth=7)
    line = the_line(found)
    parts, genus = recounted(monkey.data)
    assert line[0] == f"parts: 3 before, {parts} after"
    assert line[1] == f"genus: 0 before, {genus} after"
    assert (parts, genus) == (1, 0)
    # Its ears are thin, and its eyelids are wedges.
    assert line[-1] == "walls of 0.9 cells: depth 8 keeps them"
    assert not any("lost" in row for row in line)
    for point in fronts:
        _, place, _, _ = monkey.closest_point_on_mesh(point)
        assert (place - point).length < 0.1 * cell


def test_sheets_that_cross_their_surroundings():
    """There are walls of any thickness where they do, and few of them."""
    assert bpy.ops.mesh.primitive_uv_sphere_add() == DONE
    ball = bpy.context.active_object
    assert bpy.ops.mesh.primitive_grid_add(size=3.0, rotation=(0.3, 1.35, 0.0)) == DONE
    ball.select_set(True)
    assert bpy.ops.object.join() == DONE
    line = the_line(outcome(bpy.context.active_object, depth=8))
    assert line[-1] == "sheets: no depth keeps them"


def test_a_boolean_sums_up():
    other = torus()
    cube = bodies.cube(size=0.4)
    other.select_set(True)
    choices = importlib.import_module(f"{PACKAGE}.voxels.choices")
    boolean = importlib.import_module(f"{PACKAGE}.voxels.boolean")
    command = importlib.import_module(f"{PACKAGE}.core.command")
    settings = choices.BooleanSettings(depth=6, operation="union")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found = command.run_work(boolean.Boolean.read(cube, [other], settings, depsgraph))
    assert the_line(found) == ["parts: 2 before, 2 after", "genus: 1 before, 1 after"]


def test_the_volume_is_that_of_the_surface():
    """Cells keep a film where faces coincide, but the surface does not."""
    cubes = [bodies.cube(size=1.0), bodies.cube(size=1.0)]
    for cube, side in zip(cubes, (4.0, 2.0), strict=True):
        cube.data.transform(Matrix.Diagonal((side, side, 1.0, 1.0)))
    choices = importlib.import_module(f"{PACKAGE}.voxels.choices")
    boolean = importlib.import_module(f"{PACKAGE}.voxels.boolean")
    command = importlib.import_module(f"{PACKAGE}.core.command")
    settings = choices.BooleanSettings(depth=6, operation="difference")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found = command.run_work(boolean.Boolean.read(cubes[0], cubes[1:], settings, depsgraph))
    told = float(str(found.summary).split("volume ")[1].split()[0])
    assert told == pytest.approx(bodies.volume(cubes[0]), rel=1e-3)
    assert told == pytest.approx(12, rel=0.005)


def test_volumes_have_no_surface(tmp_path):
    volumes = importlib.import_module(f"{PACKAGE}.bridge.files.volumes")
    if not volumes.is_available():
        pytest.skip("no module for OpenVDB")
    found = outcome(plate(1.0), output="volume", filepath=str(tmp_path / "out.vdb"))
    (line,) = [one for one in found.notes if "thickened" in one]
    assert rows(line)[0] == "faces thickened: 2"
