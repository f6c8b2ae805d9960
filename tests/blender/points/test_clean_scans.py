# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.subsample_points`, `remove_outliers`, `crop_points` and `align_scans`."""

import bodies
import bpy
import clouds
import numpy as np
import pytest
from mathutils import Euler, Matrix

HAS_CLOUDS = "resize" in bpy.types.PointCloud.bl_rna.functions


@pytest.fixture
def scan():
    """Returns a mesh of points with attributes, placed, turned and scaled."""
    positions, normals = clouds.torus(3_000)
    random = np.random.default_rng(1)
    attributes = {
        "confidence": ("FLOAT", random.random(len(positions))),
        "Col": (
            "BYTE_COLOR",
            np.column_stack([random.random((len(positions), 3)), normals[:, 0] * 0 + 1]),
        ),
    }
    made = clouds.scan(positions, normals, "Scan", attributes, location=(5, 0, 1), scale=(2, 2, 2))
    made.rotation_euler = (0.3, 0.2, 0.1)
    made["kept"] = 7
    made.data["inside"] = 8
    bpy.context.view_layer.update()
    return made


def attribute(obj, name, field, width):
    found = obj.data.attributes[name]
    values = np.empty((len(found.data), width), np.float32)
    found.data.foreach_get(field, values.ravel())
    return values


def values(obj):
    """Returns all that points have, a row for each."""
    parts = [
        clouds.points(obj),
        attribute(obj, "normal", "vector", 3),
        attribute(obj, "confidence", "value", 1),
        attribute(obj, "Col", "color", 4),
    ]
    return np.concatenate(parts, axis=1)


def test_points_keep_their_attributes(scan):
    before = values(scan)
    names = set(scan.data.attributes.keys())
    assert bpy.ops.prefilter.subsample_points(spacing=0.5) == {"FINISHED"}
    after = values(scan)
    assert 20 < len(after) < 1000
    assert {row.tobytes() for row in after} <= {row.tobytes() for row in before}
    assert set(scan.data.attributes.keys()) == names
    assert (scan["kept"], scan.data["inside"]) == (7, 8)
    assert scan.data.color_attributes.active_color_name == "Col"
    assert (scan.name, scan.data.name) == ("Scan", "Scan")
    assert scan.data.users == 1
    world = clouds.vertices(scan)
    between = np.linalg.norm(world[:, None] - world[None], axis=2)
    np.fill_diagonal(between, np.inf)
    # In world space: the object is twice as large as its mesh.
    assert 0.5 - 1e-5 < between.min() < 0.6


def test_scans_are_thinned_together():
    """Two scans of one thing have no more points than one of them would have."""
    positions = clouds.torus(4_000)[0]
    first = clouds.scan(positions, name="First")
    second = clouds.scan(positions, name="Second")
    first.select_set(True)
    assert bpy.ops.prefilter.subsample_points(spacing=0.1, method="grid") == {"FINISHED"}
    together = np.concatenate([clouds.points(first), clouds.points(second)])
    assert len(together) == len({row.tobytes() for row in together})


def test_other_objects_keep_shared_points(scan):
    count = len(clouds.points(scan))
    other = bpy.data.objects.new("Other", scan.data)
    bpy.context.collection.objects.link(other)
    assert bpy.ops.prefilter.subsample_points(spacing=0.5) == {"FINISHED"}
    assert len(clouds.points(other)) == count > len(clouds.points(scan))


def test_undo(scan):
    count = len(clouds.points(scan))
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.prefilter.subsample_points(spacing=0.5) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert len(clouds.points(bpy.data.objects["Scan"])) == count


@pytest.mark.skipif(not HAS_CLOUDS, reason="Python cannot make point clouds before Blender 5.0")
def test_point_clouds(tmp_path):
    positions, normals = clouds.torus(2_000)
    path = clouds.file(tmp_path / "Torus.xyz", positions, normals)
    assert bpy.ops.prefilter.import_points(filepath=str(path)) == {"FINISHED"}
    obj = bpy.context.object
    assert obj.type == "POINTCLOUD"
    assert bpy.ops.prefilter.subsample_points(spacing=0.2) == {"FINISHED"}
    kept = clouds.points(obj)
    assert 50 < len(kept) < 1_000
    found = attribute(obj, "normal", "vector", 3)
    # The file's decimals may differ from the points in the last bit.
    distances = np.linalg.norm(kept[:, None] - positions[None], axis=2)
    assert distances.min(axis=1).max() < 1e-5
    np.testing.assert_allclose(found, normals[distances.argmin(axis=1)], atol=1e-5)


def test_outliers_of_all_scans_together():
    """An outlier of one scan is none if points of another one surround it."""
    positions = clouds.torus(4_000)[0]
    first = clouds.scan(positions[:3_990], name="First")
    second = clouds.scan(np.concatenate([positions[3_990:], [(3.0, 3.0, 3.0)]]), name="Second")
    first.select_set(True)
    assert bpy.ops.prefilter.remove_outliers() == {"FINISHED"}
    assert len(clouds.points(first)) > 3_980
    np.testing.assert_allclose(clouds.points(second), positions[3_990:], atol=1e-6)


@pytest.mark.parametrize("keep", ["inside", "outside"])
def test_crop_to_a_box_that_is_turned(scan, keep):
    before = clouds.vertices(scan)
    box = bodies.cube(location=(5, 1, 1))
    box.scale, box.rotation_euler = (1, 2, 0.5), (0.4, 0.5, 0.6)
    bpy.context.view_layer.update()
    scan.select_set(True)
    assert bpy.ops.prefilter.crop_points(keep=keep) == {"FINISHED"}
    local = (
        Matrix.Diagonal((1, 2, 0.5)).inverted() @ Euler((0.4, 0.5, 0.6)).to_matrix().transposed()
    )
    inside = (np.abs((before - (5, 1, 1)) @ np.array(local).T) <= 1).all(axis=1)
    assert 0.02 < inside.mean() < 0.98
    expected = before[inside if keep == "inside" else ~inside]
    np.testing.assert_allclose(clouds.vertices(scan), expected, atol=1e-5)
    assert bpy.data.objects[box.name] is box


def test_refusals(scan):
    scan.scale = (1e12,) * 3
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="Spacing: found 1e-06; a number above"):
        bpy.ops.prefilter.subsample_points(spacing=1e-6)
    scan.location.x, scan.scale = 0, (1, 1, 1)
    far = bodies.cube(location=(100, 0, 0))
    scan.select_set(True)
    with pytest.raises(RuntimeError, match="no point would be left"):
        bpy.ops.prefilter.crop_points()
    far.scale.z = 0
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="has no volume to crop to"):
        bpy.ops.prefilter.crop_points()
    assert len(clouds.points(scan)) == 3_000
    bpy.context.view_layer.objects.active = scan
    assert not bpy.ops.prefilter.align_scans.poll()


def test_scans_move_onto_the_active_one():
    shape = np.array([1, 1.3, 1])
    motion = (
        Matrix.Translation((0.04, -0.02, 0.03)) @ Euler((0.03, -0.02, 0.04)).to_matrix().to_4x4()
    )
    moved = clouds.scan(clouds.torus(6_000, 1)[0] * shape, name="Moved")
    still = clouds.scan(clouds.torus(6_000, 2)[0] * shape, name="Still")
    apart = clouds.scan(clouds.torus(500, 3)[0] + (0, 0, 40), name="Apart")
    place = Matrix.Translation((1000, 2000, 30))
    for obj, own in ((moved, motion), (still, Matrix()), (apart, Matrix())):
        obj.matrix_world = place @ own
        obj.select_set(True)
    bpy.context.view_layer.objects.active = still
    bpy.context.view_layer.update()
    assert bpy.ops.prefilter.align_scans(reach=0.3) == {"FINISHED"}
    np.testing.assert_allclose(np.array(still.matrix_world), np.array(place))
    np.testing.assert_allclose(np.array(apart.matrix_world), np.array(place), atol=1e-3)
    np.testing.assert_allclose(np.array(moved.matrix_world), np.array(place), atol=4e-3)


def test_imports_of_some_classes_and_returns(tmp_path):
    text = "x,y,z,classification,return_number,number_of_returns\n" + "".join(
        f"{k},{k % 7},{k % 3},{k % 4},{k % 2 + 1},2\n" for k in range(100)
    )
    path = tmp_path / "tile.csv"
    path.write_text(text)
    options = {"classes": "2, 3", "returns": "last"}
    assert bpy.ops.prefilter.import_points(filepath=str(path), **options) == {"FINISHED"}
    expected = [k for k in range(100) if k % 4 in (2, 3) and k % 2 == 1]
    np.testing.assert_array_equal(clouds.points(bpy.context.object)[:, 0], expected)
    with pytest.raises(RuntimeError, match="Classes: found 'ground'; whole numbers from 0 to 255"):
        bpy.ops.prefilter.import_points(filepath=str(path), classes="ground")
