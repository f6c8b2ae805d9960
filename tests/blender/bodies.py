# SPDX-License-Identifier: GPL-3.0-or-later

"""Small solids made in code, and measures of meshes."""

from collections.abc import Sequence

import bmesh
import bpy
import numpy as np


def body(name: str, mesh: bpy.types.Mesh, **placed: Sequence[float]) -> bpy.types.Object:
    """Makes a selected, active object of a mesh, with properties such as `location`."""
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    for key, value in placed.items():
        setattr(made, key, value)
    made.select_set(True)
    bpy.context.view_layer.objects.active = made
    bpy.context.view_layer.update()
    return made


def cube(name: str = "Cube", size: float = 2.0, **placed: Sequence[float]) -> bpy.types.Object:
    """Makes a cube around its origin."""
    return body(name, _built(name, lambda bm: bmesh.ops.create_cube(bm, size=size)), **placed)


def sphere(
    name: str = "Sphere", radius: float = 1.0, subdivisions: int = 3, **placed: Sequence[float]
) -> bpy.types.Object:
    """Makes an icosphere around its origin."""

    def build(bm: bmesh.types.BMesh) -> None:
        bmesh.ops.create_icosphere(bm, subdivisions=subdivisions, radius=radius)

    return body(name, _built(name, build), **placed)


def changed(obj: bpy.types.Object, change) -> None:
    """Has a function change the BMesh of an object."""
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    change(bm)
    bm.to_mesh(obj.data)
    bm.free()


def without_faces(obj: bpy.types.Object, count: int) -> None:
    """Removes the last faces."""

    def remove(bm: bmesh.types.BMesh) -> None:
        bm.faces.ensure_lookup_table()
        bmesh.ops.delete(bm, geom=bm.faces[-count:], context="FACES_ONLY")

    changed(obj, remove)


def turned(obj: bpy.types.Object) -> None:
    """Turns all faces inside out."""
    changed(obj, lambda bm: bmesh.ops.reverse_faces(bm, faces=bm.faces))


def welded(obj: bpy.types.Object) -> None:
    """Joins vertices at the same place, such as those that files split."""
    changed(obj, lambda bm: bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-6))


def volume(obj: bpy.types.Object) -> float:
    """Returns the signed volume in world space."""
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    found = bm.calc_volume(signed=True) * abs(obj.matrix_world.determinant())
    bm.free()
    return found


def is_closed(obj: bpy.types.Object) -> bool:
    """Returns whether each edge has two faces that run along it in opposite directions."""
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    found = len(bm.faces) > 0 and all(edge.is_contiguous for edge in bm.edges)
    bm.free()
    return found


def world_box(obj: bpy.types.Object) -> np.ndarray:
    """Returns the low and the high corner of an object's vertices in world space."""
    points = np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])
    return np.array([points.min(axis=0), points.max(axis=0)])


def on_points(obj: bpy.types.Object, instance: bpy.types.Object, points) -> None:
    """Adds a modifier of geometry nodes that puts an object at points, beside the mesh itself."""
    mesh = bpy.data.meshes.new("Points")
    mesh.from_pydata(points, [], [])
    carrier = bpy.data.objects.new("Points", mesh)
    group = bpy.data.node_groups.new("On Points", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    nodes, links = group.nodes, group.links
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    where, what = (nodes.new("GeometryNodeObjectInfo") for _ in range(2))
    where.inputs["Object"].default_value = carrier
    what.inputs["Object"].default_value = instance
    what.inputs["As Instance"].default_value = True
    put, both = nodes.new("GeometryNodeInstanceOnPoints"), nodes.new("GeometryNodeJoinGeometry")
    links.new(where.outputs["Geometry"], put.inputs["Points"])
    links.new(what.outputs["Geometry"], put.inputs["Instance"])
    links.new(start.outputs[0], both.inputs[0])
    links.new(put.outputs[0], both.inputs[0])
    links.new(both.outputs[0], end.inputs[0])
    obj.modifiers.new("On Points", "NODES").node_group = group
    bpy.context.view_layer.update()


def _built(name: str, build) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    bm = bmesh.new()
    build(bm)
    bm.to_mesh(mesh)
    bm.free()
    return mesh


def face_angles(obj: bpy.types.Object) -> np.ndarray:
    """Returns the angles between the two faces of each edge of a closed mesh, in degrees."""
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    angles = [edge.link_faces[0].normal.angle(edge.link_faces[1].normal) for edge in bm.edges]
    bm.free()
    return np.degrees(angles)


def sharp_edges(obj: bpy.types.Object) -> np.ndarray:
    """Returns for each edge whether it is marked sharp."""
    return np.array([edge.use_edge_sharp for edge in obj.data.edges])
