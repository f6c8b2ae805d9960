# SPDX-License-Identifier: GPL-3.0-or-later

"""Each number of the report's line, counted again on the meshes before and after."""

import itertools

import bmesh
import bodies
import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector, bvhtree
from voxel_reports import outcome, the_line

DEPTH = 6
CELL = 10.0 / 60  # Of the cube that the parts are in; the grid leaves two cells on all sides.
THICKNESS = 1.5 * CELL
SITES = [(x, y, z) for x in (-3.6, 0.0, 3.6) for y in (-3.6, 0.0, 3.6) for z in (-3.6, 0.0, 3.6)]


def box(bm, size):
    made = bmesh.ops.create_cube(bm, size=CELL)["verts"]
    bmesh.ops.scale(bm, verts=made, vec=size)
    return made


def hollow_ball(bm, random):
    """A sphere without some of its faces."""
    made = bmesh.ops.create_icosphere(bm, subdivisions=2, radius=4 * CELL)["verts"]
    faces = list({face for vertex in made for face in vertex.link_faces})
    gone = [faces[0]]
    for face in faces:
        used = {vertex for one in gone for vertex in one.verts}
        if len(gone) < random.integers(1, 4) and not {*face.verts} & used:
            gone.append(face)
    bmesh.ops.delete(bm, geom=gone, context="FACES_ONLY")
    return made


def shell(bm, random):
    """A ball with a smaller one cut out of it: some are too small for cells."""
    count = len(bm.verts)
    for radius in (4.5, random.choice([0.2, 1.8])):
        made = bmesh.ops.create_icosphere(bm, subdivisions=2, radius=radius * CELL)["verts"]
    bmesh.ops.reverse_faces(bm, faces=list({face for vertex in made for face in vertex.link_faces}))
    return list(bm.verts)[count:]


def ring(bm, around=24, across=10):
    """A torus, 3.2 cells thick."""
    rows = []
    for u in np.linspace(0, 2 * np.pi, around, endpoint=False):
        rows.append([])
        for v in np.linspace(0, 2 * np.pi, across, endpoint=False):
            far = 4.5 + 1.6 * np.cos(v)
            point = CELL * np.array([far * np.cos(u), far * np.sin(u), 1.6 * np.sin(v)])
            rows[-1].append(bm.verts.new(point))
    for i in range(around):
        for j in range(across):
            a, b = rows[i], rows[(i + 1) % around]
            k = (j + 1) % across
            bm.faces.new((a[j], b[j], b[k], a[k]))
    return [vertex for row in rows for vertex in row]


def part(bm, random):
    """Adds a part of some kind; returns its vertices."""
    kind = random.choice(["block", "plate", "speck", "sheet", "hollow", "ring", "shell"])
    if kind == "block":
        return box(bm, random.uniform(4, 8, 3))
    if kind == "plate":
        return box(bm, (8, 6, random.uniform(0.05, 0.9)))
    if kind == "speck":
        return box(bm, random.uniform(0.05, 0.3, 3))
    if kind == "sheet":
        return bmesh.ops.create_grid(bm, x_segments=2, y_segments=3, size=4 * CELL)["verts"]
    if kind == "shell":
        return shell(bm, random)
    return hollow_ball(bm, random) if kind == "hollow" else ring(bm)


def many_parts(seed):
    """Parts of all kinds in any pose, far from each other, and a frame of two blocks."""
    random = np.random.default_rng(seed)
    obj = bodies.cube("Parts", size=1.0)

    def build(bm):
        bmesh.ops.delete(bm, geom=bm.verts, context="VERTS")
        for site in SITES:
            made = part(bm, random)
            turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
            pose = Matrix((turn * np.linalg.det(turn)).tolist()).to_4x4()
            bmesh.ops.transform(bm, matrix=Matrix.Translation(site) @ pose, verts=made)
        for end in (-4.9, 4.9):
            made = bmesh.ops.create_cube(bm, size=0.2)["verts"]
            bmesh.ops.translate(bm, verts=made, vec=(end, end, end))

    bodies.changed(obj, build)
    bpy.context.view_layer.update()
    assert max(obj.dimensions) == pytest.approx(60 * CELL)
    return obj


def parts_of(mesh):
    """Returns the faces of each part, by a walk."""
    beside = {}
    for face in mesh.polygons:
        for key in face.edge_keys:
            beside.setdefault(key, []).append(face.index)
    seen, parts = set(), []
    for first in range(len(mesh.polygons)):
        if first in seen:
            continue
        seen.add(first)
        faces, todo = [], [first]
        while todo:
            faces.append(todo.pop())
            keys = mesh.polygons[faces[-1]].edge_keys
            near = {other for key in keys for other in beside[key]} - seen
            seen |= near
            todo += near
        parts.append(faces)
    return parts


def loops_of(mesh, faces):
    """Returns how many loops the open edges of a part make."""
    count = {}
    for face in faces:
        for key in mesh.polygons[face].edge_keys:
            count[key] = count.get(key, 0) + 1
    after = {}
    for a, b in (key for key, sides in count.items() if sides == 1):
        after.setdefault(a, set()).add(b)
        after.setdefault(b, set()).add(a)
    assert all(len(near) == 2 for near in after.values())
    loops = 0
    while after:
        loops += 1
        todo = [next(iter(after))]
        while todo:
            todo += after.pop(todo.pop(), ())
    return loops


def genus_of(mesh, faces):
    """Genus of a part, with each of its holes closed by a face."""
    edges = {key for face in faces for key in mesh.polygons[face].edge_keys}
    corners = {vertex for key in edges for vertex in key}
    return 1 - (len(corners) - len(edges) + len(faces) + loops_of(mesh, faces)) // 2


def is_cavity(mesh, faces):
    """Whether a part is closed and inside out, by its volume."""
    if loops_of(mesh, faces):
        return False
    volume = 0.0
    for face in faces:
        first, *rest = (mesh.vertices[v].co for v in mesh.polygons[face].vertices)
        volume += sum(first.dot(a.cross(b)) for a, b in itertools.pairwise(rest))
    return volume < 0


def is_flat(mesh, faces):
    first = mesh.polygons[faces[0]]
    return all(
        abs((mesh.polygons[f].center - first.center).dot(first.normal)) < 1e-4 * CELL for f in faces
    )


def tree_of(mesh):
    points = [vertex.co for vertex in mesh.vertices]
    return bvhtree.BVHTree.FromPolygons(points, [face.vertices for face in mesh.polygons])


def points_on(mesh, face, count=4):
    """Returns points of a face, not at its rim."""
    corners = [mesh.vertices[v].co for v in mesh.polygons[face].vertices]
    center = sum(corners, Vector()) / len(corners)
    return [center + k / count * (c - center) for c in corners for k in range(count)]


def is_thin(mesh, face, tree):
    """Whether a ray from the face inward leaves before the least thickness."""
    inward = -mesh.polygons[face].normal
    for point in points_on(mesh, face):
        _, normal, _, far = tree.ray_cast(point + 1e-3 * CELL * inward, inward, 100.0)
        if far is not None and normal.dot(inward) > 0:
            assert abs(far / THICKNESS - 1) > 0.05, "too close to tell"
            if far < THICKNESS:
                return True
    return False


def is_lost(mesh, faces, tree, result):
    """Whether no point of a part is within a cell of the result, or inside."""
    points = [p for face in faces for p in points_on(mesh, face, 24)]
    far = min(tree.find_nearest(point)[3] for point in points)
    _, normal, index, _ = tree.find_nearest(points[0])
    away = points[0] - result.polygons[index].center
    is_inside = normal.dot(away) < 0
    assert is_inside or abs(far / CELL - 1) > 0.02, "too close to tell"
    return not is_inside and far > CELL


def expected_line(before, after, **counts):
    """Returns the line without its advice."""
    parts = [parts_of(mesh) for mesh in (before, after)]
    genus = [
        sum(genus_of(mesh, faces) for faces in own)
        for mesh, own in zip((before, after), parts, strict=True)
    ]
    cavities = [
        sum(is_cavity(mesh, faces) for faces in own)
        for mesh, own in zip((before, after), parts, strict=True)
    ]
    solids = [len(own) - count for own, count in zip(parts, cavities, strict=True)]
    rows = [f"parts: {solids[0]} before, {solids[1]} after"]
    if cavities[0] != cavities[1]:
        rows.append(f"cavities: {cavities[0]} before, {cavities[1]} after")
    rows.append(f"genus: {genus[0]} before, {genus[1]} after")
    return rows + [f"{text}: {count}" for text, count in counts.items() if count]


def without_advice(line):
    return [row for row in line if not row.startswith(("walls of ", "sheets: "))]


@pytest.mark.parametrize("seed", range(4))
def test_thickened_faces_and_closed_holes(seed):
    obj = many_parts(seed)
    before = obj.data.copy()
    line = the_line(outcome(obj))
    parts = parts_of(before)
    solid = [faces for faces in parts if not is_flat(before, faces)]
    sheets = [faces for faces in parts if is_flat(before, faces)]
    tree = tree_of(before)
    thin = sum(is_thin(before, face, tree) for faces in solid for face in faces)
    counts = {
        "faces thickened": thin + sum(len(faces) for faces in sheets),
        "holes closed": sum(loops_of(before, faces) for faces in solid),
    }
    assert all(counts.values())
    expected = expected_line(before, obj.data, **counts)
    assert without_advice(line) == expected
    # All solids are kept, and no hole is made.
    for row in line:
        if row.startswith(("parts: ", "genus: ")):
            assert row.split()[1] == row.split()[3]


@pytest.mark.parametrize("seed", range(4))
def test_lost_faces_without_a_thickness(seed):
    obj = many_parts(seed)
    before = obj.data.copy()
    found = outcome(obj, thickness=0.0)
    tree = tree_of(obj.data)
    parts = parts_of(before)
    solid = [faces for faces in parts if not is_flat(before, faces)]
    counts = {
        "holes closed": sum(loops_of(before, faces) for faces in solid),
        "parts lost": sum(is_lost(before, faces, tree, obj.data) for faces in parts),
    }
    assert counts["parts lost"] > 1
    assert without_advice(the_line(found)) == expected_line(before, obj.data, **counts)
