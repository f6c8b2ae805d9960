# SPDX-License-Identifier: GPL-3.0-or-later

"""Subdivision modifiers: the limit surface, against Blender's own evaluation of it."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes
from scipy.spatial import cKDTree

UV_RULES = (
    "NONE",
    "PRESERVE_CORNERS",
    "PRESERVE_CORNERS_AND_JUNCTIONS",
    "PRESERVE_CORNERS_JUNCTIONS_AND_CONCAVE",
    "PRESERVE_BOUNDARIES",
    "SMOOTH_ALL",
)


@pytest.fixture
def picture():
    return scenes.image("Paint", scenes.noise(4, 4))


@pytest.fixture
def find(addon):
    meshes = addon("bridge.meshes")

    def image_surfaces(objects, image, **options):
        options = meshes.SurfaceOptions(**options)
        return meshes.image_surfaces(objects, image, scenes.depsgraph(), options)

    return image_surfaces


def evaluated_corners(obj):
    """The position and the UV of each corner of the mesh that Blender makes, in world space."""
    mesh = obj.evaluated_get(scenes.depsgraph()).to_mesh()
    positions = np.array([obj.matrix_world @ vertex.co for vertex in mesh.vertices])
    vertices = [loop.vertex_index for loop in mesh.loops]
    uvs = np.array([element.vector for element in mesh.uv_layers.active.uv])
    return np.concatenate([positions[vertices], uvs], axis=1)


def assert_same_corners(surface, obj):
    """Both were refined as often, so their corners are the same ones.

    That takes a modifier with levels 3. Blender approximates the limit near boundaries, closer by
    four with each step of quality, and next to infinite creases where quality is above levels.
    """
    positions = surface.positions[surface.triangles].reshape(-1, 3)
    ours = np.concatenate([positions, surface.uvs.reshape(-1, 2)], axis=1)
    theirs = evaluated_corners(obj)
    for one, other in ((ours, theirs), (theirs, ours)):
        distances, _ = cKDTree(one).query(other)
        assert distances.max() < 2e-6


def add_creases(obj):
    """Adds creases that are infinitely sharp, or smooth again after three levels."""
    edges = obj.data.attributes.new("crease_edge", "FLOAT", "EDGE")
    values = np.resize([0.0, 0.25, 0.0, 0.5, 1.0], len(obj.data.edges))
    edges.data.foreach_set("value", values)
    points = obj.data.attributes.new("crease_vert", "FLOAT", "POINT")
    points.data[1].value = 0.5
    points.data[2].value = 1.0


def split_charts(obj):
    """Moves the UVs of some faces away, for seams of every kind."""
    layer = obj.data.uv_layers.active.uv
    for face in obj.data.polygons:
        for corner in face.loop_indices:
            layer[corner].vector.x += face.index % 3


@pytest.mark.parametrize("rule", UV_RULES)
@pytest.mark.parametrize("boundary", ["ALL", "PRESERVE_CORNERS"])
def test_open_mesh_against_blender(find, picture, rule, boundary):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4)
    grid = bpy.context.object
    grid.data.materials.append(scenes.material("Cloth", picture))
    heights = np.random.default_rng(1).uniform(-0.3, 0.3, len(grid.data.vertices))
    for vertex, height in zip(grid.data.vertices, heights, strict=True):
        vertex.co.z = height
    split_charts(grid)
    grid.scale = (1, 2, -0.5)
    scenes.subdivided(grid, levels=3, quality=9, uv_smooth=rule, boundary_smooth=boundary)
    (surface,) = find([grid], picture).surfaces
    assert_same_corners(surface, grid)


@pytest.mark.parametrize("use_creases", [True, False])
def test_creases_against_blender(find, picture, use_creases):
    cube = scenes.cube(picture)
    add_creases(cube)
    scenes.subdivided(cube, levels=3, quality=3, use_creases=use_creases)
    (surface,) = find([cube], picture).surfaces
    assert_same_corners(surface, cube)


def test_ngons_poles_and_triangles_against_blender(find, picture):
    bpy.ops.mesh.primitive_cone_add(vertices=7)
    cone = bpy.context.object
    cone.data.materials.append(scenes.material("Clay", picture))
    scenes.subdivided(cone, levels=3, quality=3)
    (surface,) = find([cone], picture).surfaces
    assert_same_corners(surface, cone)


def test_area_is_near_that_of_blenders_highest_level(find, picture):
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    monkey.data.materials.append(scenes.material("Fur", picture))
    modifier = scenes.subdivided(monkey, levels=1)
    (surface,) = find([monkey], picture).surfaces
    modifier.levels = 5
    (fine,) = find([monkey], picture, subdivision_limit=False).surfaces
    assert surface.area == pytest.approx(fine.area, rel=3e-3)
    modifier.levels = 1
    (coarse,) = find([monkey], picture, subdivision_limit=False).surfaces
    assert abs(coarse.area - fine.area) > 5 * abs(surface.area - fine.area)


def test_shares_that_faces_have_do_not_depend_on_the_viewport_level(find, picture):
    cube = scenes.cube(picture)
    modifier = scenes.subdivided(cube, levels=1)
    areas = []
    for modifier.levels in (0, 1, 4):
        (surface,) = find([cube], picture).surfaces
        areas.append(surface.area)
    assert areas[0] == areas[1] == areas[2]


def test_modifier_is_on_again_afterward(find, picture):
    cube = scenes.cube(picture)
    modifier = scenes.subdivided(cube, levels=2)
    find([cube], picture)
    assert modifier.show_viewport
    assert len(cube.evaluated_get(scenes.depsgraph()).data.polygons) == 96
    cube.data.vertices[0].co.x = float("nan")
    with pytest.raises(ValueError, match="object 'Cube': positions: vertex 0 holds nan"):
        find([cube], picture)
    assert modifier.show_viewport
    assert len(cube.evaluated_get(scenes.depsgraph()).data.polygons) == 96


def test_only_where_it_is_on_top_and_on(find, picture):
    cube = scenes.cube(picture)
    modifier = scenes.subdivided(cube, levels=1)
    limit = find([cube], picture).surfaces[0].triangle_count
    assert limit == 6 * 2 * 4**3
    modifier.show_viewport = False
    assert find([cube], picture).surfaces[0].area == pytest.approx(24)
    modifier.show_viewport = True
    assert find([cube], picture, subdivision_limit=False).surfaces[0].triangle_count == 48
    modifier.subdivision_type = "SIMPLE"
    assert find([cube], picture).surfaces[0].area == pytest.approx(24)
    modifier.subdivision_type = "CATMULL_CLARK"
    array = cube.modifiers.new("Array", "ARRAY")
    assert find([cube], picture).surfaces[0].triangle_count == 96
    array.show_viewport = False
    assert find([cube], picture).surfaces[0].triangle_count == limit


def test_modifiers_below_count(find, picture):
    cube = scenes.cube(picture)
    array = cube.modifiers.new("Array", "ARRAY")
    array.relative_offset_displace = (3, 0, 0)
    scenes.subdivided(cube)
    (surface,) = find([cube], picture).surfaces
    assert surface.triangle_count == 2 * 6 * 2 * 4**3


def test_driven_modifier_is_taken_as_it_is(find, picture):
    cube = scenes.cube(picture)
    modifier = scenes.subdivided(cube, levels=1)
    modifier.driver_add("show_viewport").driver.expression = "1"
    (surface,) = find([cube], picture).surfaces
    assert surface.triangle_count == 48


def test_faces_of_another_material_shape_the_surface(find, picture):
    cube = scenes.cube(picture)
    other = scenes.image("Other", scenes.noise(4, 4))
    cube.data.materials.append(scenes.material("Other", other))
    for face in cube.data.polygons:
        face.material_index = face.index % 2
    scenes.subdivided(cube)
    (first,) = find([cube], picture).surfaces
    (second,) = find([cube], other).surfaces
    assert first.area == pytest.approx(second.area, rel=1e-6)
    assert first.area + second.area == pytest.approx(9.1215, rel=1e-4)


def test_edit_mode(find, picture):
    cube = scenes.cube(picture)
    modifier = scenes.subdivided(cube, levels=1)
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(cube.data)
    for vertex in edited.verts:
        vertex.co *= 2
    bmesh.update_edit_mesh(cube.data)
    (surface,) = find([cube], picture).surfaces
    assert surface.area == pytest.approx(4 * 9.1215, rel=1e-4)
    modifier.show_in_editmode = False
    assert find([cube], picture).surfaces[0].area == pytest.approx(4 * 24)


def test_instances_are_limit_surfaces_too(find, picture):
    cube = scenes.cube(picture)
    scenes.subdivided(cube)
    instancer = scenes.collection_instance(cube)
    instancer.scale = (2, 2, 2)
    (surface,) = find([instancer], picture).surfaces
    assert surface.area == pytest.approx(4 * 9.1215, rel=1e-4)


def test_fine_meshes_are_refined_less(find, picture, addon, monkeypatch):
    cube = scenes.cube(picture)
    scenes.subdivided(cube, levels=1)
    counts = []
    for limit in (800, 400, 100, 40):
        monkeypatch.setattr(addon("bridge.subdivision"), "_MAX_TRIANGLES", limit)
        counts.append(find([cube], picture).surfaces[0].triangle_count)
    assert counts == [768, 192, 48, 48]


@pytest.mark.parametrize("domain", ["POINT", "FACE", "CORNER"])
def test_importance(find, picture, domain):
    cube = scenes.cube(picture)
    attribute = cube.data.attributes.new("Care", "FLOAT", domain)
    attribute.data.foreach_set("value", np.full(len(attribute.data), 3.0))
    scenes.subdivided(cube)
    (surface,) = find([cube], picture, importance="Care").surfaces
    assert surface.area == pytest.approx(3 * 9.1215, rel=1e-4)
    attribute.data.foreach_set("value", np.arange(len(attribute.data), dtype=np.float32))
    (uneven,) = find([cube], picture, importance="Care").surfaces
    assert np.ptp(uneven.areas / find([cube], picture).surfaces[0].areas) > 2


def test_wire_and_loose_vertices(find, picture):
    cube = scenes.cube(picture)
    cube.data.vertices.add(2)
    cube.data.edges.add(1)
    cube.data.edges[-1].vertices = (8, 9)
    crease = cube.data.attributes.new("crease_edge", "FLOAT", "EDGE")
    crease.data[len(cube.data.edges) - 1].value = 1.0
    scenes.subdivided(cube)
    (surface,) = find([cube], picture).surfaces
    assert surface.area == pytest.approx(9.1215, rel=1e-4)
