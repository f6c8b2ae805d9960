# SPDX-License-Identifier: GPL-3.0-or-later

"""Faces and edges of a report: stored with a result, and selected in its sources."""

import base64
import zlib

import bpy
import numpy as np
import prefilter
from mathutils.bvhtree import BVHTree
from mathutils.kdtree import KDTree
from numpy.typing import NDArray

from ..bridge import kept_sources
from ..core.translations import tr
from ..core.wording import Sentence
from .findings import OPEN, Report, total_genus

Indices = NDArray[np.int32]


def keep(made: bpy.types.Object, report: Report, after: prefilter.MeshTopology) -> None:
    """Stores a report with an object, if the object keeps its sources.

    Args:
        made: The object.
        report: The report on its sources.
        after: Topology of its surface.
    """
    stored = made.prefilter_found
    stored.is_there = kept_sources.original_of(made) is not None
    stored.places.clear()
    if not stored.is_there:
        return
    findings = report.findings
    before = total_genus(findings)
    advice = "" if report.advice is None else tr(report.advice)
    stored.advice = advice[:1].upper() + advice[1:]
    stored.parts = (sum(each.parts for each in findings), after.solids)
    stored.cavities = (sum(each.cavities for each in findings), after.cavities)
    stored.genus = (-1 if before is None else before, -1 if after.genus is None else after.genus)
    for i, each in enumerate(findings):
        for kind, rows in each.places.items():
            entry = stored.places.add()
            entry.kind = kind
            entry.operand = each.name if i else ""
            entry.count = len(rows)
            entry.rows = _pack(rows)


def select(result: bpy.types.Object, index: int, context: bpy.types.Context) -> bpy.types.Object:
    """Shows the source of a result in its stead, and selects faces or edges there in Edit Mode.

    Args:
        result: The result.
        index: Index of the entry of the report.
        context: The context.

    Raises:
        ValueError: The source is gone, or cannot be edited.
    """
    entry = result.prefilter_found.places[index]
    source = _source_of(result, entry.operand)
    if source is None:
        raise ValueError(Sentence("object '{}': its source is gone", result.name))
    if source.data.library is not None:
        text = "object '{}' is linked from '{}'; make it local first"
        raise ValueError(Sentence(text, source.name, source.data.library.filepath))
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    if not result.prefilter_made_of.is_source_shown:
        kept_sources.show(result, context, source=True)
    source.hide_set(False)
    for obj in context.selected_objects:
        obj.select_set(False)
    source.select_set(True)
    context.view_layer.objects.active = source
    context.view_layer.update()
    rows, is_edges = _unpack(entry.rows), entry.kind == OPEN
    if is_edges:
        _select_edges(source, rows.reshape(-1, 2), context)
    else:
        _select_faces(source, rows, context)
    context.tool_settings.mesh_select_mode = (False, is_edges, not is_edges)
    bpy.ops.object.mode_set(mode="EDIT")
    return source


def _source_of(result: bpy.types.Object, operand: str) -> bpy.types.Object | None:
    obj = bpy.data.objects.get(operand) if operand else kept_sources.original_of(result)
    return obj if obj is not None and obj.type == "MESH" else None


def _pack(rows: Indices) -> str:
    """Encodes indices as text: array properties have a fixed length."""
    steps = np.diff(rows.ravel(), prepend=0).astype("<i4")
    return base64.b85encode(zlib.compress(steps.tobytes())).decode()


def _unpack(text: str) -> Indices:
    steps = np.frombuffer(zlib.decompress(base64.b85decode(text)), "<i4")
    return np.cumsum(steps).astype(np.int32)


def _select_faces(obj: bpy.types.Object, faces: Indices, context: bpy.types.Context) -> None:
    """Selects the faces of an object's mesh at the given faces of its evaluated mesh."""
    mesh = obj.data
    shown = obj.evaluated_get(context.evaluated_depsgraph_get()).data
    faces = faces[faces < len(shown.polygons)]
    if len(shown.polygons) != len(mesh.polygons) and len(mesh.polygons):
        tree = BVHTree.FromPolygons(
            [vertex.co for vertex in mesh.vertices], [face.vertices for face in mesh.polygons]
        )
        nearest = (tree.find_nearest(shown.polygons[i].center)[2] for i in faces.tolist())
        faces = np.unique([i for i in nearest if i is not None]).astype(np.int32)
    is_face = _flags(len(mesh.polygons), faces)
    starts, totals = (np.empty(len(mesh.polygons), np.int32) for _ in range(2))
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.polygons.foreach_get("loop_total", totals)
    is_corner = np.zeros(len(mesh.loops), bool)
    for start, total in zip(starts[is_face].tolist(), totals[is_face].tolist(), strict=True):
        is_corner[start : start + total] = True
    vertices, edges = (np.empty(len(mesh.loops), np.int32) for _ in range(2))
    mesh.loops.foreach_get("vertex_index", vertices)
    mesh.loops.foreach_get("edge_index", edges)
    _select(
        mesh,
        _flags(len(mesh.vertices), vertices[is_corner]),
        _flags(len(mesh.edges), edges[is_corner]),
        is_face,
    )


def _select_edges(obj: bpy.types.Object, pairs: Indices, context: bpy.types.Context) -> None:
    """Selects the edges of an object's mesh at the given edges of its evaluated mesh."""
    mesh = obj.data
    shown = obj.evaluated_get(context.evaluated_depsgraph_get()).data
    pairs = pairs[(pairs < len(shown.vertices)).all(axis=1)]
    positions, ends = _positions(mesh), np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    if len(shown.vertices) == len(mesh.vertices):
        # The report was made on welded vertices: compare edges by positions.
        ids = np.unique(positions, axis=0, return_inverse=True)[1].reshape(-1)
        reported = np.sort(ids[pairs], axis=1).astype(np.int64)
        own = np.sort(ids[ends], axis=1).astype(np.int64)
        count = len(positions)
        chosen = np.isin(own @ [count, 1], reported @ [count, 1])
    else:
        tree = KDTree(len(mesh.edges))
        for i, center in enumerate(positions[ends].mean(axis=1)):
            tree.insert(center, i)
        tree.balance()
        centers = _positions(shown)[pairs].mean(axis=1)
        chosen = _flags(len(mesh.edges), np.array([tree.find(each)[1] for each in centers], int))
    is_vertex = _flags(len(mesh.vertices), ends[chosen].ravel())
    _select(mesh, is_vertex, chosen, np.zeros(len(mesh.polygons), bool))


def _positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    return positions


def _flags(count: int, chosen: NDArray[np.integer]) -> NDArray[np.bool_]:
    flags = np.zeros(count, bool)
    flags[chosen] = True
    return flags


def _select(
    mesh: bpy.types.Mesh,
    vertices: NDArray[np.bool_],
    edges: NDArray[np.bool_],
    faces: NDArray[np.bool_],
) -> None:
    """Selects only these elements, and unhides them."""
    for items, flags in ((mesh.vertices, vertices), (mesh.edges, edges), (mesh.polygons, faces)):
        is_hidden = np.empty(len(items), bool)
        items.foreach_get("hide", is_hidden)
        items.foreach_set("hide", is_hidden & ~flags)
        items.foreach_set("select", flags)
    mesh.update()
