# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.paint_texture`: the colors of scans on a texture of a mesh."""

import bodies
import bpy
import clouds
import numpy as np
import pytest


def colored(count=20_000, name="Scan", **placed):
    """Points of a torus, whose colors are their normals."""
    points, normals = clouds.torus(count)
    colors = np.column_stack([normals * 0.5 + 0.5, np.ones(count)])
    return clouds.scan(points, normals, name, {"Col": ("FLOAT_COLOR", colors)}, **placed)


def pixels(image):
    values = np.empty((image.size[1], image.size[0], 4), np.float32)
    image.pixels.foreach_get(values.ravel())
    return values


def as_linear(values):
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def test_a_reconstructed_surface_gets_the_colors_of_its_scan():
    scan = colored(location=(500, 20, 3), scale=(2, 2, 2))
    assert bpy.ops.prefilter.reconstruct(adaptivity=0.1) == {"FINISHED"}
    surface = bpy.context.object
    scan.hide_set(False)
    scan.select_set(True)
    surface.select_set(True)
    bpy.context.view_layer.objects.active = surface
    assert bpy.ops.prefilter.paint_texture(size=512, smoothing=0.01) == {"FINISHED"}
    assert bpy.context.view_layer.objects.active == surface
    assert scan.select_get()
    image = bpy.data.images[f"{surface.name}.colors"]
    texture = as_linear(pixels(image)[..., :3])
    mesh = surface.data
    nodes = mesh.materials[0].node_tree.nodes
    assert [node.image for node in nodes if node.type == "TEX_IMAGE"] == [image]
    errors = []
    for loop, uv in zip(mesh.loops, mesh.uv_layers.active.data, strict=True):
        normal = mesh.vertices[loop.vertex_index].normal
        column, row = (min(int(x * 512), 511) for x in uv.uv)
        errors.append(np.abs(texture[row, column] - (np.array(normal) * 0.5 + 0.5)).max())
    assert np.mean(errors) < 0.05


def test_charts_lie_beside_each_other():
    """Blender's default angle makes charts of the rims of Suzanne's ears overlap."""
    colored()
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    monkey.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    monkey.data.uv_layers.remove(monkey.data.uv_layers[0])
    bpy.data.objects["Scan"].select_set(True)
    size = 1024
    assert bpy.ops.prefilter.paint_texture(size=size) == {"FINISHED"}
    mesh = monkey.data
    mesh.calc_loop_triangles()
    loops = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("loops", loops.ravel())
    uvs = np.empty((len(mesh.loops), 2), np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", uvs.ravel())
    assert triangles_at_texels(uvs[loops].astype(float) * size, size).max() == 1


def turn(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def triangles_at_texels(corners, size):
    """How many triangles hold the center of each texel."""
    counts = np.zeros((size, size), int)
    for a, b, c in corners:
        twice_area = turn(b - a, c - a)
        if abs(twice_area) < 1e-9:
            continue
        low = np.floor(np.minimum.reduce([a, b, c])).astype(int)
        high = np.ceil(np.maximum.reduce([a, b, c])).astype(int)
        y, x = np.mgrid[low[1] : high[1], low[0] : high[0]]
        centers = np.stack([x, y], axis=-1) + 0.5
        first = turn(b - centers, c - centers) / twice_area
        second = turn(c - centers, a - centers) / twice_area
        counts[y, x] += (first > 0) & (second > 0) & (first + second < 1)
    return counts


def test_a_uv_map_that_is_there_stays():
    colored()
    cube = bodies.cube()
    layer = cube.data.uv_layers.new(name="Own")
    before = np.empty(2 * len(layer.uv), np.float32)
    layer.uv.foreach_get("vector", before)
    bpy.data.objects["Scan"].select_set(True)
    assert bpy.ops.prefilter.paint_texture(size=16) == {"FINISHED"}
    after = np.empty_like(before)
    cube.data.uv_layers["Own"].uv.foreach_get("vector", after)
    np.testing.assert_array_equal(before, after)
    assert len(cube.data.uv_layers) == 1


def test_refusals():
    scan = colored()
    assert not bpy.ops.prefilter.paint_texture.poll()
    bodies.cube()
    scan.select_set(False)
    assert not bpy.ops.prefilter.paint_texture.poll()
    scan.select_set(True)
    assert bpy.ops.prefilter.paint_texture.poll()
    scan.data.attributes.remove(scan.data.attributes["Col"])
    with pytest.raises(RuntimeError, match="object 'Scan': its points have no colors"):
        bpy.ops.prefilter.paint_texture()
