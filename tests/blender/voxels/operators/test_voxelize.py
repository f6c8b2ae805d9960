# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.voxelize`, as scripts call it: the volume and the place of results are known."""

import importlib.util
import math

import bodies
import bpy
import numpy as np
import pytest

NAN = float("nan")


def voxelize(**options):
    return bpy.ops.prefilter.voxelize(**{"depth": 5, **options})


def assert_close_to(obj, volume, tolerance=0.02):
    assert bodies.is_closed(obj)
    assert bodies.volume(obj) == pytest.approx(volume, rel=tolerance)


def test_sphere_keeps_its_place_and_volume():
    ball = bodies.sphere(location=(3, -2, 1))
    before = bodies.volume(ball)
    assert voxelize() == {"FINISHED"}
    assert_close_to(ball, before)
    assert ball.name == "Sphere"
    assert ball.data.name == "Sphere"
    assert {mesh.name for mesh in bpy.data.meshes} == {"Sphere", "Sphere.source"}
    np.testing.assert_allclose(bodies.world_box(ball), [(2, -3, 0), (4, -1, 2)], atol=0.05)


def test_open_mesh_is_closed(capfd):
    ball = bodies.sphere()
    before = bodies.volume(ball)
    bodies.without_faces(ball, 3)
    assert voxelize() == {"FINISHED"}
    assert_close_to(ball, before, 0.05)
    assert "open edges; the result is closed" in capfd.readouterr().out


@pytest.mark.parametrize("scale", [(1, 2, 0.5), (-1, 1, 1), (-1, -2, -1), (1e-4,) * 3, (1e4,) * 3])
def test_scale(scale):
    ball = bodies.sphere(scale=scale, rotation_euler=(0.3, 0.7, 1.1), location=(1, 2, 3))
    before, box = bodies.volume(ball), bodies.world_box(ball)
    assert voxelize() == {"FINISHED"}
    assert_close_to(ball, before, 0.03)
    np.testing.assert_allclose(bodies.world_box(ball), box, atol=0.1 * np.ptp(box))
    assert tuple(ball.scale) == pytest.approx(scale)


def test_voxels_are_cubes_of_the_given_size_in_world_space(capfd):
    bodies.cube(scale=(0.5, 3, 1))
    assert voxelize(resolution="size", voxel_size=0.25) == {"FINISHED"}
    assert "in 32³ cells of 25 cm" in capfd.readouterr().out


def test_far_from_the_origin():
    ball = bodies.sphere(location=(1e6, 0, 0))
    before = bodies.volume(ball)
    voxelize()
    assert_close_to(ball, before)


@pytest.mark.parametrize("placed", [{"radius": 1e5}, {"location": (1e5, 1e5, 0)}])
def test_triangles_of_large_and_far_objects_have_areas(placed):
    ball = bodies.sphere(**placed)
    assert voxelize(depth=6, use_cleanup=False) == {"FINISHED"}
    areas = np.empty(len(ball.data.polygons), np.float32)
    ball.data.polygons.foreach_get("area", areas)
    assert areas.min() > 0


def test_modifiers_are_applied():
    box = bodies.cube()
    array = box.modifiers.new("Array", "ARRAY")
    array.use_relative_offset, array.use_constant_offset = False, True
    array.constant_offset_displace = (4, 0, 0)
    assert voxelize(depth=6) == {"FINISHED"}
    assert len(box.modifiers) == 0
    assert_close_to(box, 16.0, 0.05)


def test_shape_keys():
    box = bodies.cube()
    box.shape_key_add(name="Basis")
    key = box.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 2.0
    key.value = 1.0
    assert voxelize() == {"FINISHED"}
    assert box.data.shape_keys is None
    assert_close_to(box, 16.0, 0.05)


def test_other_users_keep_their_mesh():
    first = bodies.cube("First")
    second = bodies.body("Second", first.data, location=(5, 0, 0))
    first.select_set(False)
    mesh = first.data
    assert voxelize() == {"FINISHED"}
    assert first.data == mesh
    assert len(mesh.vertices) == 8
    assert second.data != mesh
    assert_close_to(second, 8.0)


def test_several_objects(capfd):
    boxes = [bodies.cube(f"Cube{i}", location=(3 * i, 0, 0)) for i in range(3)]
    assert voxelize() == {"FINISHED"}
    for box in boxes:
        assert_close_to(box, 8.0)
    assert "Voxelized 3 objects" in capfd.readouterr().out


def test_instances_of_geometry_nodes():
    box = bodies.cube()
    small = bodies.cube("Small", size=1.0)
    small.select_set(False)
    bodies.on_points(box, small, [(4, 0, 0), (-4, 0, 0), (0, 4, 0)])
    assert voxelize(depth=6) == {"FINISHED"}
    assert_close_to(box, 8.0 + 3.0, 0.05)


def test_collection_instance():
    source = bodies.cube(location=(1, 0, 0))
    collection = bpy.data.collections.new("Group")
    bpy.context.scene.collection.objects.unlink(source)
    collection.objects.link(source)
    empty = bodies.body("Instance", None, location=(0, 0, 5), scale=(1, -1, 1))
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    assert voxelize() == {"FINISHED"}
    made = bpy.data.objects["Instance.voxels"]
    assert_close_to(made, 8.0)
    np.testing.assert_allclose(bodies.world_box(made), [(0, -1, 4), (2, 1, 6)], atol=0.2)
    assert empty.hide_get()
    assert bpy.context.view_layer.objects.active == made


def test_text():
    bpy.ops.object.text_add()
    text = bpy.context.object
    text.data.body, text.data.extrude = "I", 0.2
    assert voxelize(depth=6) == {"FINISHED"}
    made = bpy.data.objects["Text.voxels"]
    assert bodies.is_closed(made)
    assert bodies.volume(made) > 0


def test_metaball_and_curve():
    bpy.ops.object.metaball_add()
    bpy.ops.curve.primitive_bezier_circle_add(location=(6, 0, 0))
    bpy.context.object.data.bevel_depth = 0.3
    for obj in bpy.context.scene.objects:
        obj.select_set(True)
    assert voxelize(depth=6) == {"FINISHED"}
    assert bodies.is_closed(bpy.data.objects["Mball.voxels"])
    ring = bpy.data.objects["BézierCircle.voxels"]
    assert_close_to(ring, 2 * math.pi**2 * 0.3**2, 0.2)


def test_inside_out(capfd):
    ball = bodies.sphere()
    before = bodies.volume(ball)
    bodies.turned(ball)
    assert voxelize() == {"FINISHED"}
    assert_close_to(ball, before)
    assert "Warning: object 'Sphere' was inside out" in capfd.readouterr().out


def test_edges_with_many_faces():
    box = bodies.cube()
    other = bodies.cube("Other", location=(2, 2, 0))
    for obj in (box, other):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = box
    bpy.ops.object.join()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.remove_doubles()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert voxelize() == {"FINISHED"}
    assert_close_to(box, 16.0, 0.05)


def test_materials_of_the_nearest_faces():
    box = bodies.cube()
    for name in ("Red", "Blue"):
        box.data.materials.append(bpy.data.materials.new(name))
    for face in box.data.polygons:
        face.material_index = int(face.center.x > 0.5)
    assert voxelize(adaptivity=0.0) == {"FINISHED"}
    assert [material.name for material in box.data.materials] == ["Red", "Blue"]
    ends = [face for face in box.data.polygons if max(map(abs, face.center[1:])) < 0.7]
    assert len(ends) > 900
    for face in ends:
        assert face.material_index == int(face.center.x > 0)


def test_materials_and_uvs_end_at_edges():
    box = bodies.cube(rotation_euler=(0.3, 0.2, 0.1))
    for side, face in enumerate(box.data.polygons):
        box.data.materials.append(bpy.data.materials.new(f"Side {side}"))
        face.material_index = side
    layer = box.data.uv_layers.new(name="Map")
    for face in box.data.polygons:
        flat = [axis for axis in range(3) if abs(face.normal[axis]) < 0.5]
        for corner in face.loop_indices:
            place = box.data.vertices[box.data.loops[corner].vertex_index].co
            uv = [(place[axis] + 1) / 2 for axis in flat]
            layer.data[corner].uv = (uv[0] + 2 * face.index, uv[1])
    sides = {tuple(round(x) for x in face.normal): face.index for face in box.data.polygons}
    assert voxelize(depth=6) == {"FINISHED"}
    made = box.data.uv_layers["Map"]
    area = 0.0
    for face in box.data.polygons:
        # Compare with the cube, as some corners of the surface are blunt.
        axis = int(np.abs(face.center).argmax())
        side = sides[tuple(int(np.sign(face.center[axis])) * (axis == k) for k in range(3))]
        assert face.material_index == side
        a, b, c = (np.array(made.data[corner].uv) for corner in face.loop_indices)
        assert (
            2 * side - 1e-4 <= min(a[0], b[0], c[0]) <= max(a[0], b[0], c[0]) <= 2 * side + 1.0001
        )
        area += abs(np.linalg.det([b - a, c - a])) / 2
    assert area == pytest.approx(6.0, rel=1e-3)


@pytest.mark.parametrize("adaptivity", [0.0, 0.05])
@pytest.mark.parametrize("kind", ["uv_sphere", "cylinder", "torus"])
def test_uvs_end_at_slits_of_charts(kind, adaptivity):
    """The charts of Blender's round shapes meet themselves at a seam: no face reaches across."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(rotation=(0.3, 0.2, 0.1))
    obj = bpy.context.object
    assert voxelize(depth=6, adaptivity=adaptivity) == {"FINISHED"}
    uvs = np.empty((len(obj.data.loops), 2), np.float32)
    obj.data.uv_layers.active.data.foreach_get("uv", uvs.ravel())
    places = np.empty((len(obj.data.loops), 3), np.float32)
    corners = [obj.data.vertices[loop.vertex_index].co for loop in obj.data.loops]
    places[:] = [corner[:] for corner in corners]
    extents = np.ptp(uvs.reshape(-1, 3, 2), axis=1).max(axis=1)
    sizes = np.ptp(places.reshape(-1, 3, 3), axis=1).max(axis=1)
    assert extents.max() < 0.55
    assert (extents[sizes < 0.1] < 0.1).all()


def test_vertex_groups_and_attributes():
    ball = bodies.sphere(subdivisions=4)
    group = ball.vertex_groups.new(name="Top")
    for vertex in ball.data.vertices:
        if vertex.co.z > 0:
            group.add([vertex.index], vertex.co.z, "REPLACE")
    heights = ball.data.attributes.new("Height", "FLOAT", "POINT")
    heights.data.foreach_set("value", [vertex.co.z for vertex in ball.data.vertices])
    halves = ball.data.attributes.new("Half", "INT", "FACE")
    halves.data.foreach_set("value", [int(face.center.x > 0) for face in ball.data.polygons])
    assert voxelize() == {"FINISHED"}
    assert ball.vertex_groups.keys() == ["Top"]
    for vertex in ball.data.vertices:
        weight = sum(element.weight for element in vertex.groups)
        assert weight == pytest.approx(max(vertex.co.z, 0.0), abs=0.05)
        assert ball.data.attributes["Height"].data[vertex.index].value == pytest.approx(
            vertex.co.z, abs=0.05
        )
    made = ball.data.attributes["Half"]
    assert made.domain == "FACE"
    for face in ball.data.polygons:
        if abs(face.center.x) > 0.1:
            assert made.data[face.index].value == int(face.center.x > 0)
    voxelize(use_attributes=False)
    assert len(ball.vertex_groups) == 0
    assert "Height" not in ball.data.attributes


def test_material_of_an_object_slot():
    box = bodies.cube()
    box.data.materials.append(bpy.data.materials.new("Of the mesh"))
    box.material_slots[0].link = "OBJECT"
    box.material_slots[0].material = bpy.data.materials.new("Of the object")
    voxelize()
    assert box.material_slots[0].material.name == "Of the object"


def test_colors_are_interpolated():
    ball = bodies.sphere(subdivisions=4)
    colors = ball.data.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
    for i, loop in enumerate(ball.data.loops):
        x, y, z = ball.data.vertices[loop.vertex_index].co
        colors.data[i].color = ((x + 1) / 2, (y + 1) / 2, (z + 1) / 2, 1.0)
    assert voxelize() == {"FINISHED"}
    made = ball.data.color_attributes["Paint"]
    assert made.domain == "CORNER"
    found = np.array([entry.color[:3] for entry in made.data])
    vertices = [ball.data.vertices[loop.vertex_index] for loop in ball.data.loops]
    places = np.array([vertex.co.normalized() for vertex in vertices])
    np.testing.assert_allclose(found, (places + 1) / 2, atol=0.03)
    assert ball.data.color_attributes.active_color.name == "Paint"


def test_without_transfer():
    box = bodies.cube()
    box.data.materials.append(bpy.data.materials.new("Red"))
    box.data.color_attributes.new("Paint", "BYTE_COLOR", "POINT")
    voxelize(use_materials=False, use_colors=False)
    assert len(box.data.materials) == 0
    assert len(box.data.color_attributes) == 0


def test_flat_shading():
    box = bodies.cube()
    voxelize(use_smooth_shading=False)
    assert not any(face.use_smooth for face in box.data.polygons)


@pytest.mark.parametrize("degrees", [20, 50, 120])
def test_edges_are_sharp_above_the_angle(degrees):
    """The angles between the result's own faces count; all are below 120 degrees."""
    box = bodies.cube(rotation_euler=(0.2, 0.3, 0.1))
    voxelize(use_smooth_shading=True, smooth_angle=math.radians(degrees), interpolant="occupancy")
    assert all(face.use_smooth for face in box.data.polygons)
    angles, is_sharp = bodies.face_angles(box), bodies.sharp_edges(box)
    clear = np.abs(angles - degrees) > 0.5
    assert clear.mean() > 0.95
    np.testing.assert_array_equal(is_sharp[clear], angles[clear] > degrees)
    assert is_sharp.any() == (degrees < 90)


def test_volume_object(tmp_path, addon):
    volumes = addon("bridge.files.volumes")
    ball = bodies.sphere(location=(1, 2, 3))
    ball.rotation_euler = (0.3, 0.2, 0.1)
    bpy.context.view_layer.update()
    before = len(ball.data.vertices)
    path = tmp_path / "ball.vdb"
    if not volumes.is_available():
        with pytest.raises(RuntimeError, match="no Python module for OpenVDB"):
            voxelize(output="volume", filepath=str(path))
        assert len(bpy.data.volumes) == 0
        return
    assert voxelize(output="volume", filepath=str(path)) == {"FINISHED"}
    made = bpy.data.objects["Sphere.volume"]
    assert made.type == "VOLUME"
    assert tuple(made.location) == pytest.approx((1, 2, 3))
    assert len(ball.data.vertices) == before
    assert made.data.grids.load()
    assert made.data.grids[0].name == "density"
    grid, cells = read_density(path)
    spacing = grid.transform.voxelSize()[0]
    assert cells.min() >= 0
    assert cells.max() == 1
    assert cells.sum() * spacing**3 == pytest.approx(bodies.volume(ball), rel=1e-4)
    middle = np.average(np.argwhere(cells > 0), axis=0, weights=cells[cells > 0])
    np.testing.assert_allclose(grid.transform.indexToWorld(tuple(middle)), 0, atol=1e-3)


def read_density(path):
    """Returns an OpenVDB file's grid of that name, and 32 x 32 x 32 values of it."""
    for name in ("openvdb", "pyopenvdb"):
        if importlib.util.find_spec(name):
            module = importlib.import_module(name)
    grid = module.read(str(path), "density")
    cells = np.empty((32, 32, 32), np.float32)
    grid.copyToArray(cells)
    return grid, cells


def test_volume_of_an_object_of_a_linked_collection(tmp_path, addon):
    if not addon("bridge.files.volumes").is_available():
        pytest.skip("there is no Python module for OpenVDB")
    box = bodies.cube()
    collection = bpy.data.collections.new("Linked")
    collection.objects.link(box)
    path = tmp_path / "library.blend"
    bpy.data.libraries.write(str(path), {collection})
    bpy.data.objects.remove(box)
    bpy.data.collections.remove(collection)
    with bpy.data.libraries.load(str(path), link=True) as (there, here):
        here.collections = there.collections
    bpy.context.scene.collection.children.link(here.collections[0])
    bpy.data.objects["Cube"].select_set(True)
    assert voxelize(output="volume", filepath=str(tmp_path / "cube.vdb")) == {"FINISHED"}
    made = bpy.data.objects["Cube.volume"]
    assert list(made.users_collection) == [bpy.context.scene.collection]
    assert made.select_get()


def test_volumes_are_written_all_or_none(tmp_path, addon, monkeypatch):
    if not addon("bridge.files.volumes").is_available():
        pytest.skip("there is no OpenVDB module")
    for name in ("First", "Second"):
        bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.name = name
    bpy.ops.object.select_all(action="SELECT")
    earlier = tmp_path / "out.First.vdb"
    earlier.write_bytes(b"earlier")
    staged = addon("bridge.files.staging").StagedFile
    put = staged.put

    def failing(self):
        if self.target.name == "out.Second.vdb":
            raise OSError("the disk is full")
        put(self)

    monkeypatch.setattr(staged, "put", failing)
    with pytest.raises(RuntimeError, match="the disk is full"):
        voxelize(output="volume", depth=4, filepath=str(tmp_path / "out.vdb"))
    assert [path.name for path in tmp_path.iterdir()] == ["out.First.vdb"]
    assert earlier.read_bytes() == b"earlier"
    assert len(bpy.data.volumes) == 0


def test_volume_that_cannot_be_shown_leaves_no_file(tmp_path, addon, monkeypatch):
    if not addon("bridge.files.volumes").is_available():
        pytest.skip("there is no Python module for OpenVDB")

    def gone(name):
        raise ValueError(f"object '{name}' is gone")

    bodies.cube()
    monkeypatch.setattr(addon("voxels.voxelization"), "find_object", gone)
    with pytest.raises(RuntimeError, match="object 'Cube' is gone"):
        voxelize(output="volume", filepath=str(tmp_path / "cube.vdb"))
    assert not list(tmp_path.iterdir())


def linked(tmp_path):
    box = bodies.cube()
    path = tmp_path / "library.blend"
    bpy.data.libraries.write(str(path), {box})
    bpy.data.objects.remove(box)
    with bpy.data.libraries.load(str(path), link=True) as (there, here):
        here.objects = there.objects
    obj = here.objects[0]
    bpy.context.scene.collection.objects.link(obj)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


def test_linked_object_is_refused(tmp_path):
    obj = linked(tmp_path)
    with pytest.raises(RuntimeError, match=r"object 'Cube' is linked from .*make it local"):
        voxelize()
    bodies.cube("Mine")
    obj.select_set(True)
    with pytest.raises(RuntimeError, match="object 'Cube' is linked from"):
        voxelize()


def test_linked_mesh_of_an_own_object(tmp_path):
    mesh = linked(tmp_path).data
    bpy.context.view_layer.objects.active.select_set(False)
    own = bodies.body("Own", mesh)
    assert voxelize() == {"FINISHED"}
    assert own.data.library is None
    assert len(mesh.vertices) == 8


def test_poll():
    assert not bpy.ops.prefilter.voxelize.poll()
    box = bodies.cube()
    assert bpy.ops.prefilter.voxelize.poll()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Switch to Object Mode first"):
        voxelize()
    bpy.ops.object.mode_set(mode="OBJECT")
    box.select_set(False)
    with pytest.raises(RuntimeError, match="Select an object that has a surface"):
        voxelize()


def of_edges_alone():
    mesh = bpy.data.meshes.new("Wire")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    return bodies.body("Wire", mesh)


def of_no_faces():
    return bodies.body("None", bpy.data.meshes.new("None"))


def with_a_broken_vertex():
    box = bodies.cube()
    box.data.vertices[3].co.y = NAN
    return box


def at_one_place():
    box = bodies.cube()
    for vertex in box.data.vertices:
        vertex.co = (1, 1, 1)
    return box


def flat():
    return bodies.cube(scale=(1, 0, 1))


def plane():
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
    return bodies.body("Plane", mesh)


@pytest.mark.parametrize(
    ("make", "options", "words"),
    [
        (of_edges_alone, {}, "object 'Wire': found no faces"),
        (of_no_faces, {}, "object 'None': found no faces"),
        (with_a_broken_vertex, {}, "object 'Cube': vertex 3 .*nan.*finite"),
        (at_one_place, {}, "object 'Cube': all its faces have zero area"),
        (flat, {}, "object 'Cube': its scale is 0 along an axis"),
        (plane, {"thickness": 0.0}, "object 'Plane': the result is empty"),
        (
            bodies.cube,
            {"resolution": "size", "voxel_size": 1e-6},
            "Voxel Size: 1e-06 would need .* the limit is 4096. Use 0.000489 or more",
        ),
    ],
)
def test_bad_input(make, options, words):
    obj = make()
    mesh, count = obj.data, len(obj.data.vertices)
    with pytest.raises(RuntimeError, match=words):
        voxelize(**options)
    assert obj.data == mesh
    assert len(mesh.vertices) == count
    assert len(bpy.data.meshes) == 1


def test_objects_without_faces_are_left_out(capfd):
    box, wire = bodies.cube(), of_edges_alone()
    box.select_set(True)
    assert voxelize() == {"FINISHED"}
    assert_close_to(box, 8.0)
    assert len(wire.data.vertices) == 2
    assert "Warning: left out, as they have no faces: 'Wire'" in capfd.readouterr().out


def test_objects_of_which_nothing_is_left_are_left_out(capfd):
    box, sheet = bodies.cube(), plane()
    count = len(sheet.data.vertices)
    assert voxelize(thickness=0.0) == {"FINISHED"}
    assert_close_to(box, 8.0)
    assert len(sheet.data.vertices) == count
    assert "Warning: left out: object 'Plane': the result is empty" in capfd.readouterr().out


def test_nothing_is_left_of_any_object():
    sheet, box = plane(), at_one_place()
    for obj in (sheet, box):
        obj.select_set(True)
    found = "object 'Plane': the result is empty.*; object 'Cube': all its faces have zero area"
    with pytest.raises(RuntimeError, match=found):
        voxelize(thickness=0.0)
    assert len(bpy.data.meshes) == 2


def test_too_large_for_memory(addon, monkeypatch):
    monkeypatch.setattr(addon("core.memory"), "available_memory", lambda: 1e6)
    box = bodies.cube()
    with pytest.raises(RuntimeError, match=r"need about .* GB of memory.*use fewer or larger"):
        voxelize(depth=10)
    assert len(box.data.vertices) == 8


def test_undo():
    bpy.context.preferences.edit.use_global_undo = True
    bodies.cube()
    bpy.ops.ed.undo_push(message="before")
    voxelize(adaptivity=0.0)
    bpy.ops.ed.undo_push(message="after")
    assert len(bpy.data.objects["Cube"].data.vertices) > 8
    bpy.ops.ed.undo()
    assert len(bpy.data.objects["Cube"].data.vertices) == 8


def test_blender_finds_no_other_edges():
    """The library's are the mesh's own: nothing to repair, and as many as Blender counts."""
    ball = bodies.sphere()
    bpy.ops.prefilter.voxelize(depth=5)
    mesh = ball.data
    count = len(mesh.edges)
    assert count == 3 * len(mesh.polygons) // 2
    assert not mesh.validate(verbose=True)
    mesh.update(calc_edges=True)
    assert len(mesh.edges) == count


@pytest.mark.parametrize("is_deformed", [False, True])
def test_custom_normals_are_carried(is_deformed):
    """A ball of facets that is shaded as a ball; with a group the normals turn with the mesh."""
    ball = bodies.sphere("Ball", subdivisions=3)
    directions = np.empty((len(ball.data.vertices), 3), np.float32)
    ball.data.vertices.foreach_get("co", directions.ravel())
    ball.data.normals_split_custom_set_from_vertices(directions.tolist())
    if is_deformed:
        ball.vertex_groups.new(name="Bone").add(range(len(directions)), 1.0, "REPLACE")
    bpy.ops.prefilter.voxelize(depth=5)
    mesh = ball.data
    assert mesh.has_custom_normals
    assert len(ball.vertex_groups) == is_deformed
    normals = np.empty((len(mesh.loops), 3), np.float32)
    mesh.corner_normals.foreach_get("vector", normals.ravel())
    corners = np.array([mesh.vertices[loop.vertex_index].co.normalized() for loop in mesh.loops])
    assert np.einsum("ij,ij->i", normals, corners).min() > 0.99
