# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.reconstruct`, as scripts call it, on points of solids that are known."""

import bodies
import bpy
import clouds
import numpy as np
import prefilter
import pytest
from mathutils import Matrix

DEPTH = 6
CELL = 2.8 / (2**DEPTH - 4)
"""The torus is 2.8 wide, with two empty cells on each side."""


def reconstruct(**options):
    return bpy.ops.prefilter.reconstruct(**{"depth": DEPTH, **options})


def surface(name="Scan"):
    return bpy.data.objects[f"{name}.surface"]


def assert_torus(obj, within=0.5 * CELL):
    """Asserts that an object is the closed torus, right side out."""
    assert bodies.is_closed(obj)
    distances = np.abs(clouds.torus_distance(clouds.vertices(obj)))
    assert distances.mean() < 0.3 * within
    assert np.quantile(distances, 0.99) < within
    assert bodies.volume(obj) == pytest.approx(clouds.TORUS_VOLUME, rel=0.03)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"wavelet": "d4", "use_fit": False},
        {"use_smooth": False, "isovalue": "half"},
        {"resolution": "size", "voxel_size": 0.05},
        {"isovalue": "custom", "custom_isovalue": 0.5},
        {"memory_limit": 200},
    ],
)
def test_closed_and_near_the_points(options):
    clouds.scan(*clouds.torus())
    assert reconstruct(**options) == {"FINISHED"}
    assert_torus(surface(), CELL)


def test_messages(capfd):
    clouds.scan(*clouds.torus(5_000))
    reconstruct()
    out = capfd.readouterr().out
    assert "Reconstructed 'Scan.surface' from 5000 points at depth 6, in cells of" in out
    assert f": {len(surface().data.polygons)} triangles" in out
    assert "Warning" not in out


def test_depth_follows_from_the_points_unless_it_is_named(capfd):
    points, normals = clouds.torus(5_000)
    clouds.scan(points, normals)
    report = prefilter.ReconstructionReport()
    prefilter.reconstruct(points, normals, report=report)
    assert report.depth not in (4, 9)
    for options, depth in (
        ({}, report.depth),
        ({"depth": 4}, 4),
        ({"resolution": "auto", "depth": 4}, report.depth),
        ({"resolution": "depth"}, 9),
    ):
        assert bpy.ops.prefilter.reconstruct(points="keep", **options) == {"FINISHED"}
        assert f"from 5000 points at depth {depth}, in cells of" in capfd.readouterr().out
        bpy.ops.object.select_all(action="DESELECT")
        bpy.data.objects["Scan"].select_set(True)
        bpy.context.view_layer.objects.active = bpy.data.objects["Scan"]


def test_the_new_object_is_active_and_shaded_smooth():
    scan = clouds.scan(*clouds.torus(5_000), location=(1, 2, 3))
    scan.data.materials.append(bpy.data.materials.new("Clay"))
    scan.select_set(True)
    reconstruct()
    made = surface()
    assert bpy.context.view_layer.objects.active == made
    assert bpy.context.selected_objects == [made]
    np.testing.assert_allclose(made.matrix_world, scan.matrix_world)
    assert [material.name for material in made.data.materials] == ["Clay"]
    assert all(face.use_smooth for face in made.data.polygons)
    assert len(scan.data.vertices) == 5_000


@pytest.mark.parametrize("points", ["keep", "hide", "delete"])
def test_points_are_kept_hidden_or_deleted(points):
    clouds.scan(*clouds.torus(5_000))
    reconstruct(points=points)
    scan = bpy.data.objects.get("Scan")
    assert (scan is None) == (points == "delete")
    if scan is not None:
        assert (scan.hide_get(), scan.hide_render) == (points == "hide",) * 2
        assert not scan.select_get()


def test_flat_shading():
    clouds.scan(*clouds.torus(5_000))
    reconstruct(use_smooth_shading=False)
    assert not any(face.use_smooth for face in surface().data.polygons)


PLACED = {"location": (5, -3, 2), "rotation_euler": (0.3, 0.5, 0.7), "scale": (2, -1, 0.5)}


def test_in_the_space_of_its_object():
    """Turned, stretched and mirrored: in its own space the surface is the torus."""
    scan = clouds.scan(*clouds.torus(), **PLACED)
    reconstruct()
    made = surface()
    np.testing.assert_allclose(made.matrix_world, scan.matrix_world, atol=1e-6)
    made.matrix_world = Matrix.Identity(4)
    bpy.context.view_layer.update()
    assert_torus(made, 2 * CELL)


def test_scans_are_joined():
    """Parts of one torus, each in an object that is placed otherwise."""
    points, normals = clouds.torus(30_000)
    for i, placed in enumerate([{}, PLACED, {"rotation_euler": (1, 2, 3)}]):
        part = clouds.scan(points[:1], name=f"Part{i}", **placed)
        matrix = np.array(part.matrix_world)
        bpy.data.objects.remove(part)
        linear, offset = matrix[:3, :3], matrix[:3, 3]
        chosen = slice(i, None, 3)
        local = (points[chosen] - offset) @ np.linalg.inv(linear).T
        # The inverse of the inverse transpose.
        clouds.scan(local, normals[chosen] @ linear, name=f"Part{i}", **placed)
    bpy.context.view_layer.objects.active = bpy.data.objects["Part1"]
    assert reconstruct() == {"FINISHED"}
    made = surface("Part1")
    placed = bpy.data.objects["Part1"].matrix_world
    np.testing.assert_allclose(made.matrix_world, placed, atol=1e-6)
    assert_torus(made)


def test_in_a_sheared_space():
    """A stretched parent of a turned object; no object by itself can have such a space."""
    parent = bodies.cube("Parent", scale=(1, 1, 3))
    scan = clouds.scan(*clouds.torus(), rotation_euler=(0.5, 0, 0))
    scan.parent = parent
    bpy.context.view_layer.update()
    sheared = np.array(scan.matrix_world)[:3, :3]
    reconstruct()
    made = clouds.vertices(surface())
    assert np.abs(clouds.torus_distance(made @ np.linalg.inv(sheared).T)).mean() < CELL


def test_far_from_the_origin():
    points, normals = clouds.torus()
    clouds.scan(points, normals, location=(1e5, 2e5, -1e5))
    reconstruct()
    made = surface()
    made.location = (0, 0, 0)
    bpy.context.view_layer.update()
    assert_torus(made)


def test_normals_of_any_length():
    points, normals = clouds.torus()
    clouds.scan(points, normals * np.linspace(0.1, 50, len(points))[:, None])
    reconstruct()
    assert_torus(surface())


def test_estimated_normals(capfd):
    clouds.scan(clouds.torus()[0])
    reconstruct()
    assert_torus(surface())
    assert "normals were estimated for 'Scan'" in capfd.readouterr().out


def test_estimated_normals_of_a_part(capfd):
    points, normals = clouds.torus()
    clouds.scan(points[1::2], name="Without")
    clouds.scan(points[::2], normals[::2])
    reconstruct()
    assert_torus(surface())
    assert "normals were estimated for 'Without'" in capfd.readouterr().out


def test_attributes_are_carried():
    points, normals = clouds.torus()
    colors = np.concatenate([(points + 2) / 4, np.full((len(points), 1), 0.5)], axis=1)
    clouds.scan(
        points,
        normals,
        attributes={
            "Paint": ("BYTE_COLOR", colors),
            "Light": ("FLOAT_COLOR", 4 * colors),
            "intensity": ("FLOAT", 100 * points[:, 0]),
        },
    )
    reconstruct()
    made = surface()
    mesh = made.data
    places = clouds.vertices(made)
    for name, data_type, scale in (("Paint", "BYTE_COLOR", 1), ("Light", "FLOAT_COLOR", 4)):
        attribute = mesh.attributes[name]
        assert (attribute.data_type, attribute.domain) == (data_type, "POINT")
        found = np.empty((len(places), 4), np.float32)
        attribute.data.foreach_get("color", found.ravel())
        np.testing.assert_allclose(found[:, :3] / scale, (places + 2) / 4, atol=0.03)
        np.testing.assert_allclose(found[:, 3] / scale, 0.5, atol=0.01)
    assert mesh.attributes["intensity"].data_type == "FLOAT"
    found = np.empty(len(places), np.float32)
    mesh.attributes["intensity"].data.foreach_get("value", found)
    np.testing.assert_allclose(found / 100, places[:, 0], atol=0.1)
    assert mesh.color_attributes.active_color_name == "Paint"


def test_points_that_lack_a_color_are_white():
    points, normals = clouds.torus()
    left = points[:, 0] < 0
    black = np.tile([0.0, 0.0, 0.0, 1.0], (left.sum(), 1))
    clouds.scan(points[left], normals[left], attributes={"Paint": ("FLOAT_COLOR", black)})
    clouds.scan(points[~left], normals[~left], name="Plain")
    reconstruct()
    made = surface("Plain")
    found = np.array([entry.color for entry in made.data.attributes["Paint"].data])
    places = clouds.vertices(made)
    clear = np.abs(places[:, 0]) > 0.1
    np.testing.assert_allclose(found[clear, 0], places[clear, 0] > 0, atol=1e-3)


def test_confidence():
    """A second torus, a little larger, with no confidence: it is as if it were not there."""
    points, normals = clouds.torus()
    both = np.concatenate([points, points + 0.1 * normals])
    confidence = np.repeat([1.0, 0.0], len(points))
    clouds.scan(both, np.tile(normals, (2, 1)), attributes={"confidence": ("FLOAT", confidence)})
    reconstruct()
    assert_torus(surface(), 2 * CELL)


def test_trim():
    points, normals = clouds.torus()
    kept = points[:, 2] < 0.1
    for name, trim in (("Closed", 0.0), ("Open", 3.0)):
        for obj in bpy.context.selected_objects:
            obj.select_set(False)
        clouds.scan(points[kept], normals[kept], name=name)
        reconstruct(trim=trim, use_watertight=True)
        made = surface(name)
        assert bodies.is_closed(made) == (name == "Closed")
    assert clouds.vertices(made)[:, 2].max() < 0.1 + 4 * CELL


def test_point_cloud():
    points, normals = clouds.torus()
    made = clouds.scan(points, normals)
    try:
        bpy.ops.object.convert(target="POINTCLOUD")
    except TypeError:
        pytest.skip("this Blender makes no point clouds")
    cloud = bpy.context.object
    assert cloud.type == "POINTCLOUD"
    reconstruct()
    assert_torus(surface(made.name))
    assert cloud.hide_get()


def test_points_of_geometry_nodes():
    """A mesh whose nodes make a point cloud of it, which shows the points as balls."""
    scan = clouds.scan(*clouds.torus())
    group = bpy.data.node_groups.new("Balls", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    nodes = group.nodes
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    balls = nodes.new("GeometryNodeMeshToPoints")
    group.links.new(start.outputs[0], balls.inputs["Mesh"])
    group.links.new(balls.outputs[0], end.inputs[0])
    scan.modifiers.new("Balls", "NODES").node_group = group
    assert reconstruct() == {"FINISHED"}
    assert_torus(surface())
    assert "radius" not in surface().data.attributes


def test_modifiers_that_move_points():
    scan = clouds.scan(*clouds.torus())
    scan.modifiers.new("Wave", "CAST").factor = 0.0
    moved = scan.modifiers.new("Away", "DISPLACE")
    moved.direction, moved.mid_level, moved.strength = "X", 0.0, 3.0
    reconstruct()
    made = surface()
    made.location.x -= 3.0
    bpy.context.view_layer.update()
    assert_torus(made)


def test_inward_normals(capfd):
    points, normals = clouds.torus()
    scan = clouds.scan(points, -normals)
    reconstruct(points="keep")
    out = capfd.readouterr().out
    assert "Warning: most normals point inward, as in a room, and were kept; the setting" in out
    assert "Info: normals are as given" in out
    made = surface()
    assert bodies.volume(made) < 0
    bpy.data.objects.remove(made)
    scan.select_set(True)
    reconstruct(direction="outward")
    assert "Warning: most normals point inward; all were flipped" in capfd.readouterr().out
    assert_torus(surface())


def test_normals_face_the_scanner():
    """The scanner is at its known position, or at the origin of the scan."""
    points, _ = clouds.torus()
    scan = clouds.scan(points)
    reconstruct(points="keep", direction="viewpoint")
    origin = bodies.volume(surface())
    for value in ("nonsense", [1.0, 2.0], [0.0, 0.0, float("nan")]):
        scan["scan_viewpoint"] = value
        bpy.data.objects.remove(surface())
        scan.select_set(True)
        reconstruct(points="keep", direction="viewpoint")
        assert bodies.volume(surface()) == origin
    scan["scan_viewpoint"] = [0.0, 0.0, 90.0]
    bpy.data.objects.remove(surface())
    scan.select_set(True)
    reconstruct()
    assert bodies.volume(surface()) != origin


def test_heights_point_up(capfd):
    points, _ = clouds.torus()
    points[:, 2] = 0.2 * np.sin(3 * points[:, 0])
    clouds.scan(points)
    reconstruct()
    assert "Info: normals point up" in capfd.readouterr().out


def test_points_that_do_not_count(capfd):
    points, normals = clouds.torus()
    points[3], points[4, 1], normals[5], normals[6] = np.nan, np.inf, 0.0, np.nan
    clouds.scan(points, normals)
    reconstruct()
    assert_torus(surface())
    out = capfd.readouterr().out
    assert "Warning: left out, because they have no finite position: 2 points" in out
    assert "normals that are zero or no numbers were estimated: those of 2 points" in out


def test_stray_points(capfd):
    points, normals = clouds.torus()
    random = np.random.default_rng(2)
    stray = random.uniform(-2, 2, (200, 3))
    clouds.scan(np.concatenate([points, stray]), np.concatenate([normals, stray]))
    reconstruct()
    distances = np.abs(clouds.torus_distance(clouds.vertices(surface())))
    assert np.quantile(distances, 0.9) < CELL
    assert "Warning: left out as outliers, because they are sampled" in capfd.readouterr().out


def test_poll():
    scan = clouds.scan(*clouds.torus(1_000))
    assert bpy.ops.prefilter.reconstruct.poll()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Switch to Object Mode first"):
        reconstruct()
    bpy.ops.object.mode_set(mode="OBJECT")
    scan.select_set(False)
    bodies.cube().select_set(True)
    with pytest.raises(RuntimeError, match="Select objects with vertices and no faces, or point"):
        reconstruct()


def test_meshes_with_faces_are_no_scans():
    clouds.scan(*clouds.torus(5_000))
    box = bodies.cube()
    assert reconstruct() == {"FINISHED"}
    assert len(box.data.vertices) == 8
    assert not box.hide_get()
    assert_torus(surface(), 2 * CELL)


def not_finite():
    return clouds.scan(np.full((100, 3), np.nan), clouds.sphere(100)[1])


def flat():
    return clouds.scan(*clouds.sphere(100), scale=(1, 1, 0))


def with_faces():
    scan = clouds.scan(*clouds.sphere(100))
    scan.data.edges.add(99)
    chain = np.stack([np.arange(99), np.arange(1, 100)], axis=1)
    scan.data.edges.foreach_set("vertices", chain.ravel().astype(np.int32))
    scan.modifiers.new("Skin", "SCREW")
    return scan


@pytest.mark.parametrize(
    ("make", "options", "words"),
    [
        (not_finite, {}, "point"),
        (flat, {}, "object 'Scan': its scale is 0 along an axis"),
        (with_faces, {}, "object 'Scan': its modifiers make faces"),
        (
            lambda: clouds.scan(*clouds.torus(100)),
            {"resolution": "size", "voxel_size": 1e-6},
            "Voxel Size: 1e-06 would need more than 4096 cells.*use 0.0006.* or more",
        ),
    ],
)
def test_bad_input(make, options, words):
    scan = make()
    with pytest.raises(RuntimeError, match=words):
        reconstruct(**options)
    assert [obj.name for obj in bpy.data.objects] == ["Scan"]
    assert [mesh.name for mesh in bpy.data.meshes] == ["Scan"]
    assert not scan.hide_get()
    assert scan.select_get()


def test_points_of_a_plane():
    """Watertight, it is closed somewhere below; else the plane alone is left, as if trimmed."""
    random = np.random.default_rng(1)
    points = np.concatenate([random.uniform(-1, 1, (5_000, 2)), np.zeros((5_000, 1))], axis=1)
    scan = clouds.scan(points, np.tile([0.0, 0.0, 1.0], (5_000, 1)))
    reconstruct(points="keep", use_watertight=True)
    assert bodies.is_closed(surface())
    for options in ({}, {"trim": 2.0}):
        bpy.data.objects.remove(surface())
        scan.select_set(True)
        reconstruct(points="keep", **options)
        made = clouds.vertices(surface())
        assert not bodies.is_closed(surface())
        assert np.abs(made).max(axis=0) == pytest.approx((1, 1, 0), abs=0.15)
        scan.select_set(True)


def test_trimming_without_a_new_run():
    points, normals = clouds.torus()
    kept = points[:, 2] < 0.1
    clouds.scan(points[kept], normals[kept])
    reconstruct(use_watertight=True)
    made = surface()
    before = len(made.data.vertices)
    bpy.context.view_layer.objects.active = made
    assert bpy.ops.prefilter.trim_reconstruction.poll()
    assert bpy.ops.prefilter.trim_reconstruction(limit=1e6) == {"FINISHED"}
    assert len(made.data.vertices) == before
    assert bpy.ops.prefilter.trim_reconstruction() == {"FINISHED"}
    assert not bodies.is_closed(made)
    assert clouds.vertices(made)[:, 2].max() < 0.1 + 4 * CELL
    left = np.empty(len(made.data.vertices), np.float32)
    made.data.attributes["distance"].data.foreach_get("value", left)
    # Triangles that close small holes are kept up to 4.
    assert 1.49 < left.max() < 4
    with pytest.raises(RuntimeError, match="would be left"):
        bpy.ops.prefilter.trim_reconstruction(limit=0.0, hole=0.0)
    made.data.attributes.remove(made.data.attributes["density"])
    assert not bpy.ops.prefilter.trim_reconstruction.poll()


def test_undo():
    bpy.context.preferences.edit.use_global_undo = True
    clouds.scan(*clouds.torus(5_000))
    bpy.ops.ed.undo_push(message="before")
    reconstruct()
    bpy.ops.ed.undo_push(message="after")
    assert surface().data.polygons
    bpy.ops.ed.undo()
    assert [obj.name for obj in bpy.data.objects] == ["Scan"]
    assert not bpy.data.objects["Scan"].hide_get()
