# SPDX-License-Identifier: GPL-3.0-or-later

"""The places that a report is about: kept with a result, and selected in what it was made of."""

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
    """Keeps with an object what was found in the meshes that it was made of, if these are kept.

    Args:
        made: The object.
        report: What was found.
        after: How its surface hangs together.
    """
    found = made.prefilter_found
    found.is_there = kept_sources.original_of(made) is not None
    found.places.clear()
    if not found.is_there:
        return
    findings = report.findings
    before = total_genus(findings)
    advice = "" if report.advice is None else tr(report.advice)
    found.advice = advice[:1].upper() + advice[1:]
    found.parts = (sum(one.parts for one in findings), after.solids)
    found.cavities = (sum(one.cavities for one in findings), after.cavities)
    found.genus = (-1 if before is None else before, -1 if after.genus is None else after.genus)
    for i, one in enumerate(findings):
        for kind, rows in one.places.items():
            place = found.places.add()
            place.kind = kind
            place.operand = one.name if i else ""
            place.count = len(rows)
            place.rows = _packed(rows)


def select(result: bpy.types.Object, index: int, context: bpy.types.Context) -> bpy.types.Object:
    """Shows what an object was made of, and selects places there in Edit Mode.

    Args:
        result: The object.
        index: Of the places.
        context: The context.

    Raises:
        ValueError: What they are on is gone, or cannot be edited.
    """
    place = result.prefilter_found.places[index]
    source = _source_of(result, place.operand)
    if source is None:
        raise ValueError(Sentence("object '{}': what it was made of is gone", result.name))
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
    rows, is_edges = _unpacked(place.rows), place.kind == OPEN
    if is_edges:
        _select_edges(source, rows.reshape(-1, 2), context)
    else:
        _select_faces(source, rows, context)
    context.tool_settings.mesh_select_mode = (False, is_edges, not is_edges)
    bpy.ops.object.mode_set(mode="EDIT")
    return source


def _source_of(result: bpy.types.Object, operand: str) -> bpy.types.Object | None:
    found = bpy.data.objects.get(operand) if operand else kept_sources.original_of(result)
    return found if found is not None and found.type == "MESH" else None


def _packed(rows: Indices) -> str:
    """Returns numbers as a text, as properties keep arrays of one length only."""
    steps = np.diff(rows.ravel(), prepend=0).astype("<i4")
    return base64.b85encode(zlib.compress(steps.tobytes())).decode()


def _unpacked(text: str) -> Indices:
    steps = np.frombuffer(zlib.decompress(base64.b85decode(text)), "<i4")
    return np.cumsum(steps).astype(np.int32)


def _select_faces(obj: bpy.types.Object, faces: Indices, context: bpy.types.Context) -> None:
    """Selects faces of an object as it is evaluated: those of its mesh where these are."""
    mesh = obj.data
    shown = obj.evaluated_get(context.evaluated_depsgraph_get()).data
    faces = faces[faces < len(shown.polygons)]
    if len(shown.polygons) != len(mesh.polygons) and len(mesh.polygons):
        tree = BVHTree.FromPolygons(
            [vertex.co for vertex in mesh.vertices], [face.vertices for face in mesh.polygons]
        )
        near = (tree.find_nearest(shown.polygons[i].center)[2] for i in faces.tolist())
        faces = np.unique([i for i in near if i is not None]).astype(np.int32)
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
    """Selects edges of an object as it is evaluated: those of its mesh where these are."""
    mesh = obj.data
    shown = obj.evaluated_get(context.evaluated_depsgraph_get()).data
    pairs = pairs[(pairs < len(shown.vertices)).all(axis=1)]
    places, ends = _positions(mesh), np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    if len(shown.vertices) == len(mesh.vertices):
        # Of vertices at one place the report names the first.
        names = np.unique(places, axis=0, return_inverse=True)[1].reshape(-1)
        wanted = np.sort(names[pairs], axis=1).astype(np.int64)
        known = np.sort(names[ends], axis=1).astype(np.int64)
        count = len(places)
        chosen = np.isin(known @ [count, 1], wanted @ [count, 1])
    else:
        tree = KDTree(len(mesh.edges))
        for i, middle in enumerate(places[ends].mean(axis=1)):
            tree.insert(middle, i)
        tree.balance()
        middles = _positions(shown)[pairs].mean(axis=1)
        chosen = _flags(len(mesh.edges), np.array([tree.find(one)[1] for one in middles], int))
    is_vertex = _flags(len(mesh.vertices), ends[chosen].ravel())
    _select(mesh, is_vertex, chosen, np.zeros(len(mesh.polygons), bool))


def _positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    places = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", places.ravel())
    return places


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
    """Selects these alone, and shows what of them is hidden."""
    for items, flags in ((mesh.vertices, vertices), (mesh.edges, edges), (mesh.polygons, faces)):
        is_hidden = np.empty(len(items), bool)
        items.foreach_get("hide", is_hidden)
        items.foreach_set("hide", is_hidden & ~flags)
        items.foreach_set("select", flags)
    mesh.update()
