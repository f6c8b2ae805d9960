"""Meshes: which faces become a surface, seen by catching what the library is given."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes

LEFT = ((0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0))
RIGHT = ((0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0))


class Caught:
    """Stands in for `prefilter.Surface`."""

    def __init__(self, positions, triangles, uvs):
        self.positions, self.triangles, self.uvs = positions, triangles, uvs

    @property
    def area(self):
        a, b, c = np.moveaxis(self.positions[self.triangles], 1, 0)
        return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2

    @property
    def uv_range(self):
        corners = self.uvs.reshape(-1, 2)
        return [*corners.min(axis=0), *corners.max(axis=0)]


@pytest.fixture
def picture():
    return scenes.image("Paint", scenes.noise(4, 4))


@pytest.fixture
def find(addon, monkeypatch):
    meshes = addon("bridge.meshes")
    monkeypatch.setattr(meshes.prefilter, "Surface", Caught)

    def image_surfaces(objects, image, **options):
        return meshes.image_surfaces(objects, image, scenes.depsgraph(), **options)

    return image_surfaces


def test_one_square(find, picture):
    found = find([scenes.textured_quad(picture)], picture)
    (surface,) = found.surfaces
    assert surface.triangles.shape == (2, 3)
    assert surface.uvs.shape == (2, 3, 2)
    assert surface.area == pytest.approx(1)
    assert surface.uv_range == [0, 0, 1, 1]
    assert found.objects == ["Quad"]
    assert found.extensions == ["REPEAT"]
    assert found.problems == []
    for corner, vertex in zip(surface.uvs.reshape(-1, 2), surface.triangles.ravel(), strict=True):
        np.testing.assert_allclose(surface.positions[vertex][:2], corner, atol=1e-6)


def test_only_the_faces_of_the_material(find, picture):
    other = scenes.image("Other", scenes.noise(4, 4))
    pair = scenes.quads("Pair", [LEFT, RIGHT], sizes=[1, 3])
    pair.data.materials.append(scenes.material("Left", picture))
    pair.data.materials.append(scenes.material("Right", other))
    pair.data.polygons[1].material_index = 1
    (surface,) = find([pair], picture).surfaces
    assert surface.area == pytest.approx(1)
    assert surface.uv_range == [0, 0, 0.5, 1]
    (surface,) = find([pair], other).surfaces
    assert surface.area == pytest.approx(9)
    assert surface.uv_range == [0.5, 0, 1, 1]


def test_slot_linked_to_the_object(find, picture):
    quad = scenes.quads("Quad")
    quad.data.materials.append(None)
    quad.material_slots[0].link = "OBJECT"
    quad.material_slots[0].material = scenes.material("Own", picture)
    assert len(find([quad], picture).surfaces) == 1


def test_uv_map_of_the_node(find, picture):
    quad = scenes.textured_quad(picture)
    scenes.add_uv_map(quad.data, "Second", [LEFT])
    node = quad.active_material.node_tree.nodes.new("ShaderNodeUVMap")
    node.uv_map = "Second"
    tree = quad.active_material.node_tree
    image_node = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(node.outputs[0], image_node.inputs["Vector"])
    (surface,) = find([quad], picture).surfaces
    assert surface.uv_range == [0, 0, 0.5, 1]


def test_render_map_is_not_the_active_one(find, picture):
    quad = scenes.textured_quad(picture)
    scenes.add_uv_map(quad.data, "Second", [RIGHT])
    quad.data.uv_layers.active_index = 0
    quad.data.uv_layers["Second"].active_render = True
    (surface,) = find([quad], picture).surfaces
    assert surface.uv_range == [0.5, 0, 1, 1]


def test_mapping_moves_the_uvs(find, picture):
    quad = scenes.textured_quad(picture)
    tree = quad.active_material.node_tree
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Location"].default_value = (1, 2, 0)
    mapping.inputs["Scale"].default_value = (3, 4, 1)
    uv_map = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(uv_map.outputs[0], mapping.inputs["Vector"])
    image_node = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(mapping.outputs[0], image_node.inputs["Vector"])
    (surface,) = find([quad], picture).surfaces
    assert surface.uv_range == pytest.approx([1, 2, 4, 6])


def test_areas_are_in_world_space(find, picture):
    quad = scenes.textured_quad(picture)
    quad.scale = (2, -3, 1)
    quad.rotation_euler = (0.3, 0.5, 0.7)
    quad.location = (1000, 0, 0)
    (surface,) = find([quad], picture).surfaces
    assert surface.area == pytest.approx(6, rel=1e-5)
    assert surface.positions[:, 0].min() > 900


def test_two_objects_that_share_a_mesh(find, picture):
    quad = scenes.textured_quad(picture)
    twin = bpy.data.objects.new("Twin", quad.data)
    twin.scale = (2, 2, 2)
    bpy.context.scene.collection.objects.link(twin)
    found = find([quad, twin], picture)
    assert [surface.area for surface in found.surfaces] == pytest.approx([1, 4])
    assert found.objects == ["Quad", "Twin"]


def test_modifiers_are_applied(find, picture):
    quad = scenes.textured_quad(picture)
    array = quad.modifiers.new("Array", "ARRAY")
    array.count = 5
    (surface,) = find([quad], picture).surfaces
    assert surface.area == pytest.approx(5)


def test_edit_mode_sees_unsaved_edits(find, picture):
    quad = scenes.textured_quad(picture)
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(quad.data)
    for vertex in edited.verts:
        vertex.co *= 2
    bmesh.update_edit_mesh(quad.data)
    (surface,) = find([quad], picture).surfaces
    assert surface.area == pytest.approx(4)


def test_concave_polygons_keep_their_area(find, picture):
    mesh = bpy.data.meshes.new("Dart")
    mesh.from_pydata([(0, 0, 0), (2, 0, 0), (0.5, 0.5, 0), (0, 2, 0)], [], [range(4)])
    scenes.add_uv_map(mesh, "UVMap", [scenes.UNIT_SQUARE])
    dart = bpy.data.objects.new("Dart", mesh)
    bpy.context.scene.collection.objects.link(dart)
    mesh.materials.append(scenes.material("Paper", picture))
    (surface,) = find([dart], picture).surfaces
    assert surface.area == pytest.approx(1)


def test_all_faces_where_no_material_uses_the_image(find, picture):
    bare = scenes.quads("Bare", [LEFT, RIGHT])
    assert find([bare], picture).surfaces == []
    (surface,) = find([bare], picture, all_faces=True).surfaces
    assert surface.area == pytest.approx(2)
    textured = scenes.textured_quad(picture)
    assert find([bare, textured], picture, all_faces=True).objects == ["Quad"]


def test_extensions_most_common_first(find, picture):
    objects = [scenes.textured_quad(picture, name) for name in ("A", "B", "C")]
    for obj, extension in zip(objects, ("CLIP", "EXTEND", "EXTEND"), strict=True):
        tree = obj.active_material.node_tree
        next(n for n in tree.nodes if n.type == "TEX_IMAGE").extension = extension
    assert find(objects, picture).extensions == ["EXTEND", "CLIP"]


def test_problems_are_named(find, picture):
    no_map = scenes.textured_quad(picture, "NoMap")
    no_map.data.uv_layers.remove(no_map.data.uv_layers[0])
    empty = bpy.data.objects.new("Empty", bpy.data.meshes.new("Empty"))
    bpy.context.scene.collection.objects.link(empty)
    empty.data.materials.append(no_map.active_material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    found = find([no_map, empty, camera], picture)
    assert found.surfaces == []
    assert found.problems == [
        "object 'NoMap' has no UV map at all",
        "object 'Empty' has no faces",
    ]


def test_library_errors_name_the_object(addon, picture):
    quad = scenes.textured_quad(picture)
    quad.data.vertices[0].co.x = float("nan")
    with pytest.raises(ValueError, match=r"object 'Quad': .*positions"):
        addon("bridge.meshes").image_surfaces([quad], picture, scenes.depsgraph())
