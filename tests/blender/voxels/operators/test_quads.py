# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.voxelize` and `prefilter.boolean` with quads: transferred values match positions."""

import bodies
import bpy
import numpy as np
import pytest


def voxelize(**options):
    return bpy.ops.prefilter.voxelize(**{"depth": 5, "faces": "quads", **options})


def assert_of_quads(obj):
    assert {len(face.vertices) for face in obj.data.polygons} == {4}
    assert bodies.is_closed(obj)
    assert not obj.data.validate(verbose=True)


def colored(obj):
    """Gives each side of a cube a material, the corners UVs from the place, and vertices colors."""
    mesh = obj.data
    for side, face in enumerate(mesh.polygons):
        mesh.materials.append(bpy.data.materials.new(f"Side {side}"))
        face.material_index = side
    uvs = mesh.uv_layers.new(name="Places")
    colors = mesh.color_attributes.new("Tint", "FLOAT_COLOR", "POINT")
    for loop in mesh.loops:
        x, y, z = mesh.vertices[loop.vertex_index].co
        uvs.data[loop.index].uv = (0.5 + x / 4 + z / 8, 0.5 + y / 4 + z / 8)
    for vertex in mesh.vertices:
        colors.data[vertex.index].color = (*(0.5 + 0.25 * np.array(vertex.co)), 1.0)
    group = obj.vertex_groups.new(name="Top")
    group.add([vertex.index for vertex in mesh.vertices if vertex.co.z > 0], 1.0, "REPLACE")


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 2, 1)])
def test_quads_get_values_at_their_corners(scale, capfd):
    box = bodies.cube(rotation_euler=(0.3, 0.7, 1.1), scale=scale)
    colored(box)
    assert voxelize() == {"FINISHED"}
    assert_of_quads(box)
    assert bodies.volume(box) == pytest.approx(8.0 * abs(np.prod(scale)), rel=1e-3)
    mesh = box.data
    assert f"{len(mesh.polygons)} quads" in capfd.readouterr().out
    sides = [np.array(material.name.split()[1], int) for material in mesh.materials]
    assert sides == list(range(6))
    uvs = mesh.uv_layers["Places"].data
    colors = mesh.attributes["Tint"]
    # The sides of Blender's cube: -x, +y, +x, -y, -z, +z.
    axes, signs = [0, 1, 0, 1, 2, 2], [-1, 1, 1, -1, -1, 1]
    for face in mesh.polygons:
        axis, sign = axes[face.material_index], signs[face.material_index]
        for corner in face.loop_indices:
            vertex = mesh.loops[corner].vertex_index
            x, y, z = place = np.array(mesh.vertices[vertex].co)
            assert place[axis] == pytest.approx(sign, abs=1e-3)
            expected = (0.5 + x / 4 + z / 8, 0.5 + y / 4 + z / 8)
            assert tuple(uvs[corner].uv) == pytest.approx(expected, abs=1e-3)
            color = colors.data[vertex if colors.domain == "POINT" else corner].color
            assert tuple(color)[:3] == pytest.approx(0.5 + 0.25 * place, abs=2e-3)
    weights = [
        sum(one.weight for one in vertex.groups) - (vertex.co.z + 1) / 2 for vertex in mesh.vertices
    ]
    assert np.abs(weights).max() < 2e-3


def test_edges_of_quads_are_sharp_from_end_to_end():
    box = bodies.cube(rotation_euler=(0.3, 0.7, 1.1))
    voxelize()
    mesh = box.data
    sharp = bodies.sharp_edges(box)
    lengths = [
        (mesh.vertices[a].co - mesh.vertices[b].co).length
        for a, b in (mesh.edges[edge].vertices for edge in np.flatnonzero(sharp))
    ]
    assert sum(lengths) == pytest.approx(24.0, rel=1e-3)


def test_booleans_of_quads():
    box = bodies.cube()
    ball = bodies.sphere(radius=0.7, location=(1, 1, 1), subdivisions=4)
    bpy.context.view_layer.objects.active = box
    box.select_set(True)
    assert bpy.ops.prefilter.boolean(operation="difference", depth=6, faces="quads") == {"FINISHED"}
    assert_of_quads(box)
    assert bodies.volume(box) == pytest.approx(8.0 - np.pi * 0.7**3 / 6, rel=3e-3)
    assert ball.hide_get()


@pytest.mark.parametrize("interpolant", ["plane", "occupancy", "linear"])
def test_quads_of_all_interpolants(interpolant):
    ball = bodies.sphere()
    before = bodies.volume(ball)
    ball.data.materials.append(bpy.data.materials.new("Red"))
    assert voxelize(interpolant=interpolant, use_smooth_shading=False) == {"FINISHED"}
    assert_of_quads(ball)
    assert bodies.volume(ball) == pytest.approx(before, rel=0.03)
