# SPDX-License-Identifier: GPL-3.0-or-later

"""Meshes: which faces become a surface, and where they lie."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes

LEFT = ((0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0))
RIGHT = ((0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0))


def uv_range(surface):
    corners = surface.uvs.reshape(-1, 2)
    return [*corners.min(axis=0), *corners.max(axis=0)]


@pytest.fixture
def picture():
    return scenes.image("Paint", scenes.noise(4, 4))


@pytest.fixture
def find(addon):
    meshes = addon("bridge.meshes")

    def image_surfaces(objects, image, *, all_faces=False, **options):
        return meshes.image_surfaces(
            objects,
            image,
            scenes.depsgraph(),
            meshes.SurfaceOptions(**options),
            all_faces=all_faces,
        )

    return image_surfaces


def test_one_square(find, picture):
    found = find([scenes.textured_quad(picture)], picture)
    (surface,) = found.surfaces
    assert surface.triangles.shape == (2, 3)
    assert surface.uvs.shape == (2, 3, 2)
    assert surface.area == pytest.approx(1)
    assert uv_range(surface) == [0, 0, 1, 1]
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
    assert uv_range(surface) == [0, 0, 0.5, 1]
    (surface,) = find([pair], other).surfaces
    assert surface.area == pytest.approx(9)
    assert uv_range(surface) == [0.5, 0, 1, 1]


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
    assert uv_range(surface) == [0, 0, 0.5, 1]


def test_render_map_is_not_the_active_one(find, picture):
    quad = scenes.textured_quad(picture)
    scenes.add_uv_map(quad.data, "Second", [RIGHT])
    quad.data.uv_layers.active_index = 0
    quad.data.uv_layers["Second"].active_render = True
    (surface,) = find([quad], picture).surfaces
    assert uv_range(surface) == [0.5, 0, 1, 1]


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
    assert uv_range(surface) == pytest.approx([1, 2, 4, 6])


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


class TestInstances:
    def test_of_a_collection(self, find, picture):
        quad = scenes.textured_quad(picture)
        instancer = scenes.collection_instance(quad)
        instancer.scale = (2, -3, 5)
        instancer.location = (0, 0, 7)
        found = find([instancer], picture)
        (surface,) = found.surfaces
        assert surface.area == pytest.approx(6)
        assert surface.positions[:, 2] == pytest.approx(7)
        assert found.objects == ["Quad"]
        assert find([quad], picture).surfaces[0].area == pytest.approx(1)

    def test_of_a_collection_in_a_collection(self, find, picture):
        inner = scenes.collection_instance(scenes.textured_quad(picture), "Inner")
        inner.scale = (2, 2, 2)
        outer = scenes.collection_instance(inner, "Outer")
        outer.scale = (3, 1, 1)
        (surface,) = find([outer], picture).surfaces
        assert surface.area == pytest.approx(4 * 3)

    def test_of_an_object_by_geometry_nodes(self, find, picture):
        leaf = scenes.textured_quad(picture, "Leaf")
        leaf.scale = (0.5, 1, 1)
        ground = scenes.quads("Ground", sizes=[3])
        scenes.scatter(ground, leaf)
        found = find([ground], picture)
        (surface,) = found.surfaces
        assert surface.area == pytest.approx(4)  # Object Info takes no transform along.
        assert found.objects == ["Leaf"]
        assert len(find([ground, leaf], picture).surfaces) == 2
        assert find([leaf], picture).surfaces[0].area == pytest.approx(0.5)

    def test_of_geometry_that_no_object_has(self, find, picture):
        quad = scenes.textured_quad(picture)
        quad.scale = (2, 3, 1)
        scenes.scatter(quad)
        found = find([quad], picture)
        (surface,) = found.surfaces
        assert surface.area == pytest.approx(4 * 6)
        assert found.objects == ["Quad"]
        assert found.problems == []

    def test_of_children_at_vertices(self, find, picture):
        parent = scenes.quads("Parent")
        child = scenes.textured_quad(picture, "Child", select=False)
        child.parent = parent
        parent.instance_type = "VERTS"
        (surface,) = find([parent], picture).surfaces
        assert surface.area == pytest.approx(4)

    def test_after_a_subdivision_that_they_depend_on(self, find, picture):
        leaf = scenes.cube(picture, "Leaf")
        scenes.subdivided(leaf)
        ground = scenes.textured_quad(picture, "Ground")
        modifier = scenes.scatter(ground)
        nodes = modifier.node_group.nodes
        info = nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = leaf
        put = next(node for node in nodes if node.type == "INSTANCE_ON_POINTS")
        modifier.node_group.links.new(info.outputs["Geometry"], put.inputs["Instance"])
        found = find([leaf, ground], picture)
        assert sorted(found.objects) == ["Ground", "Leaf"]
        areas = dict(zip(found.objects, (s.area for s in found.surfaces), strict=True))
        assert areas["Leaf"] == pytest.approx(9.1215, rel=1e-3)
        # Geometry that is no object is taken as it is.
        assert areas["Ground"] == pytest.approx(4 * 8.1250, rel=1e-3)

    def test_many_are_one_surface(self, find, picture):
        leaf = scenes.textured_quad(picture, "Leaf")
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=120, y_subdivisions=120)
        ground = bpy.context.object
        scenes.scatter(ground, leaf)
        (surface,) = find([ground], picture).surfaces
        assert surface.triangle_count == 2
        assert surface.area == pytest.approx(121**2)


class TestImportance:
    @pytest.fixture
    def quad(self, picture):
        return scenes.textured_quad(picture)

    def area(self, find, quad, picture):
        (surface,) = find([quad], picture, importance="Care").surfaces
        return surface.areas

    def test_of_a_vertex_group(self, find, quad, picture):
        group = quad.vertex_groups.new(name="Other")
        group = quad.vertex_groups.new(name="Care")
        group.add([0, 1], 0.5, "REPLACE")
        group.add([2], 1.0, "REPLACE")
        areas = self.area(find, quad, picture)
        assert sorted(areas) == pytest.approx([0.5 * 1.5 / 3, 0.5 * 2.0 / 3])

    @pytest.mark.parametrize(
        ("kind", "field", "values", "total"),
        [
            ("FLOAT", "value", [3.0] * 4, 3.0),
            ("INT", "value", [2] * 4, 2.0),
            ("BOOLEAN", "value", [True] * 4, 1.0),
            ("FLOAT_COLOR", "color", [0, 1, 0, 0.5] * 4, 0.7152),
            ("BYTE_COLOR", "color", [1, 1, 1, 0] * 4, 1.0),
        ],
    )
    @pytest.mark.parametrize("domain", ["POINT", "CORNER"])
    def test_of_attributes(self, find, quad, picture, kind, field, values, total, domain):
        attribute = quad.data.attributes.new("Care", kind, domain)
        attribute.data.foreach_set(field, values)
        assert sum(self.area(find, quad, picture)) == pytest.approx(total, rel=1e-6)

    def test_of_faces(self, find, picture):
        pair = scenes.quads("Pair", [LEFT, RIGHT])
        pair.data.materials.append(scenes.material("Paper", picture))
        attribute = pair.data.attributes.new("Care", "FLOAT", "FACE")
        attribute.data.foreach_set("value", [0.0, 2.0])
        assert list(self.area(find, pair, picture)) == [0, 0, 1, 1]

    def test_of_corners_inside_of_a_face(self, find, quad, picture):
        attribute = quad.data.attributes.new("Care", "FLOAT", "CORNER")
        attribute.data.foreach_set("value", [1.0, 0.0, 0.0, 0.0])
        assert sum(self.area(find, quad, picture)) == pytest.approx(2 * 0.5 / 3)

    def test_missing_on_one_object(self, find, quad, picture):
        quad.data.attributes.new("Care", "FLOAT", "POINT")
        other = scenes.textured_quad(picture, "Other")
        found = find([quad, other], picture, importance="Care")
        assert [surface.area for surface in found.surfaces] == [0, 1]
        assert found.problems == [
            "object 'Other' has no vertex group or attribute 'Care'; all of it counts as 1"
        ]

    @pytest.mark.parametrize(
        ("kind", "domain", "message"),
        [
            (None, None, "Importance: found no vertex group or attribute named 'Care' on 'Quad'"),
            ("FLOAT", "EDGE", "attribute 'Care' is on the domain EDGE; POINT, FACE or CORNER"),
            ("FLOAT_VECTOR", "POINT", "attribute 'Care' is of the type FLOAT_VECTOR; a number"),
        ],
    )
    def test_that_is_none(self, find, quad, picture, kind, domain, message):
        if kind:
            quad.data.attributes.new("Care", kind, domain)
        with pytest.raises(ValueError, match=message):
            find([quad], picture, importance="Care")

    def test_negative_names_the_object(self, find, quad, picture):
        quad.data.attributes.new("Care", "FLOAT", "POINT").data[2].value = -1
        with pytest.raises(ValueError, match="object 'Quad': importance 'Care': vertex 2 has -1"):
            find([quad], picture, importance="Care")
