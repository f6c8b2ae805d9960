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
