# SPDX-License-Identifier: GPL-3.0-or-later

"""How results shade, whose triangles are large where the surface is flat."""

import math

import bodies
import bpy
import numpy as np
import prefilter
import pytest


def corner_normals(mesh):
    normals = np.empty((len(mesh.loops), 3), np.float32)
    mesh.corner_normals.foreach_get("vector", normals.ravel())
    return normals


def arrays(mesh):
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    triangles = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", triangles)
    return positions, triangles.reshape(-1, 3)


def rounded(segments=8):
    """Returns a cube of half side 1 with rounded edges of radius 0.2, turned."""
    box = bodies.cube(rotation_euler=(0.5, 0.3, 0.2))
    bevel = box.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.2, segments
    return box


def expected(places):
    """Returns the normals of the rounded cube where it is nearest to places in its space."""
    away = places - places.clip(-0.8, 0.8)
    return away / np.linalg.norm(away, axis=1, keepdims=True)


def error(obj):
    """Returns the mean angle, in degrees, between normals as shaded and as they are.

    At the middles of triangles, by their areas.
    """
    positions, triangles = arrays(obj.data)
    shaded = corner_normals(obj.data).reshape(-1, 3, 3).mean(axis=1)
    shaded /= np.linalg.norm(shaded, axis=1, keepdims=True)
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    cosines = np.einsum("ij,ij->i", shaded, expected((a + b + c) / 3))
    return np.average(np.degrees(np.arccos(cosines.clip(-1, 1))), weights=areas)


def test_large_triangles_shade_as_small_ones():
    """Without normals of its own the flat of this cube is shaded round: 1.7 degrees off."""
    errors, counts = [], []
    for adaptivity in (0.0, 0.05):
        box = rounded(16)
        assert bpy.ops.prefilter.voxelize(depth=6, adaptivity=adaptivity) == {"FINISHED"}
        errors.append(error(box))
        counts.append(len(box.data.polygons))
        assert box.data.has_custom_normals == bool(adaptivity)
        bpy.data.objects.remove(box)
    assert counts[1] < counts[0] / 3
    assert errors[1] < 1.2 * errors[0] + 0.1


def test_normals_are_weighted_by_areas(addon):
    """Compare with sums over the faces around each vertex that no sharp edge separates."""
    box = rounded(2)
    bpy.ops.prefilter.voxelize(depth=5, adaptivity=0.1)
    positions, triangles = arrays(box.data)
    edges = prefilter.mesh_edges(positions, triangles)
    limit = np.cos(np.radians(20))
    found = addon("voxels.shading").weighted_normals(positions, triangles, edges, np.radians(20))
    a, b, c = np.moveaxis(positions.astype(float)[triangles], 1, 0)
    areas = np.cross(b - a, c - a)
    units = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    parted = 0
    for vertex in range(0, len(positions), 7):
        around = np.flatnonzero((triangles == vertex).any(axis=1))
        fans = {face: {face} for face in around}
        for _ in around:
            for one in around:
                for other in around:
                    common = set(triangles[one]) & set(triangles[other])
                    if len(common) == 2 and units[one] @ units[other] >= limit:
                        fans[one] = fans[one] | fans[other]
        for face in around:
            total = areas[sorted(fans[face])].sum(axis=0)
            corner = 3 * face + list(triangles[face]).index(vertex)
            np.testing.assert_allclose(found[corner], total / np.linalg.norm(total), atol=1e-5)
            parted += len(fans[face]) < len(around)
    assert parted > 20


@pytest.mark.parametrize("faces", ["triangles", "quads"])
def test_creases_of_just_the_angle_are_sharp_all_along(faces):
    """The sides of a prism with twelve sides meet at 30 degrees, up to rounding."""
    for angle, is_sharp in ((30.0, True), (30.2, False)):
        bpy.ops.mesh.primitive_cylinder_add(vertices=12, depth=3, rotation=(0.3, 0.2, 0.1))
        prism = bpy.context.object
        bpy.ops.prefilter.voxelize(depth=6, faces=faces, smooth_angle=math.radians(angle))
        is_crease = np.abs(bodies.face_angles(prism) - 30.0) < 0.05
        assert is_crease.sum() >= 12
        assert (bodies.sharp_edges(prism)[is_crease] == is_sharp).all()
        bpy.data.objects.remove(prism)


def test_normals_are_made_anew():
    """Computed normals are not transferred to other meshes; custom normals of users are."""
    box = rounded()
    bpy.ops.prefilter.voxelize(depth=5)
    assert box.data.has_custom_normals
    bpy.ops.prefilter.voxelize(depth=5, adaptivity=0.0)
    assert not box.data.has_custom_normals
    bpy.ops.prefilter.voxelize(depth=5, use_smooth_shading=False)
    assert not box.data.has_custom_normals


@pytest.mark.parametrize("is_painted", [False, True])
def test_painted_colors_keep_small_triangles(capfd, is_painted):
    box = bodies.cube()
    colors = box.data.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
    for i, one in enumerate(colors.data):
        one.color = (1, 0, 0, 1) if is_painted and i == 3 else (0, 0, 1, 1)
    bpy.ops.prefilter.voxelize(depth=5)
    assert (len(box.data.polygons) > 2000) == is_painted
    assert ("has painted colors" in capfd.readouterr().out) == is_painted
