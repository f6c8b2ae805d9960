# SPDX-License-Identifier: GPL-3.0-or-later

"""Parts, genus and borders of meshes, against known shapes and against a walk over edges."""

import numpy as np
import prefilter
import pytest

from bench.solids import box, torus
from bench.voxels.thin_shapes import grating, plate


def joined(*meshes):
    """Returns meshes as one."""
    starts = np.cumsum([0, *(len(positions) for positions, _ in meshes)])
    return (
        np.concatenate([positions for positions, _ in meshes]),
        np.concatenate(
            [np.asarray(t) + start for (_, t), start in zip(meshes, starts[:-1], strict=True)]
        ),
    )


def merged(positions, triangles):
    """Returns a mesh with vertices at the same position merged."""
    places, names = np.unique(positions, axis=0, return_inverse=True)
    return places, names.reshape(-1)[triangles]


def single_edges(triangles):
    """Returns the edges of exactly one triangle, ignoring degenerate triangles."""
    counts = {}
    for corners in triangles.tolist():
        if len(set(corners)) == 3:
            for k in range(3):
                edge = tuple(sorted((corners[k], corners[k - 1])))
                counts[edge] = counts.get(edge, 0) + 1
    return sorted([a, b] for (a, b), count in counts.items() if count == 1)


def shape(solid, shift=(0, 0, 0)):
    return solid.positions + np.array(shift, float), solid.triangles


def walked_parts(triangles):
    """Returns the part of each triangle, by walking from neighbor to neighbor over edges."""
    beside = {}
    for t, corners in enumerate(triangles.tolist()):
        for k in range(3):
            beside.setdefault(frozenset((corners[k], corners[k - 1])), []).append(t)
    parts = np.full(len(triangles), -1)
    count = 0
    for first in range(len(triangles)):
        if parts[first] >= 0 or len(set(triangles[first].tolist())) < 3:
            continue
        todo = [first]
        parts[first] = count
        while todo:
            corners = triangles[todo.pop()].tolist()
            for k in range(3):
                for other in beside[frozenset((corners[k], corners[k - 1]))]:
                    if parts[other] < 0 and len(set(triangles[other].tolist())) == 3:
                        parts[other] = count
                        todo.append(other)
        count += 1
    return count, parts


BOX = box((0, 0, 0), (1, 1, 1))
TORUS = torus(2.0, 0.5, 24, 10)
SOUP = np.arange(3 * len(TORUS.triangles)).reshape(-1, 3)
STRIP = [[i % 10, (i + 1) % 10, (i + 2) % 10] for i in range(10)]
MOEBIUS = [[i % 9, (i + 1) % 9, (i + 2) % 9] for i in range(9)]


AT_VERTEX = merged(*joined(shape(BOX), shape(BOX, (1, 1, 1))))
AT_EDGE = merged(*joined(shape(BOX), shape(BOX, (1, 1, 0))))


@pytest.mark.parametrize(
    ("mesh", "parts", "genus", "borders"),
    [
        (shape(BOX), 1, 0, 0),
        (shape(TORUS), 1, 1, 0),
        (shape(grating(1.0).solid), 1, 16, 0),
        (shape(plate(1.0).solid), 1, 0, 0),
        (joined(shape(TORUS), shape(BOX, (9, 0, 0)), shape(TORUS, (20, 0, 0))), 3, 2, 0),
        (AT_VERTEX, 2, 0, 0),
        (AT_EDGE, 1, None, 0),
        ((BOX.positions, BOX.triangles[2:]), 1, 0, 1),
        ((TORUS.positions, TORUS.triangles[1:]), 1, 1, 1),
        ((TORUS.positions[TORUS.triangles].reshape(-1, 3), SOUP), 1, 1, 0),
        ((np.random.default_rng(1).normal(size=(10, 3)), STRIP), 1, 0, 2),
        ((np.random.default_rng(1).normal(size=(9, 3)), MOEBIUS), 1, None, 1),
        ((np.eye(3), [[0, 1, 2]]), 1, 0, 1),
        ((np.eye(3), [[0, 1, 1]]), 0, 0, 0),
    ],
)
def test_what_is_known(mesh, parts, genus, borders):
    found = prefilter.mesh_topology(*mesh)
    assert (found.parts, found.genus, found.borders) == (parts, genus, borders)


def test_without_welding_the_triangles_of_a_soup_are_parts():
    soup = BOX.positions[BOX.triangles].reshape(-1, 3)
    corners = np.arange(36).reshape(-1, 3)
    assert prefilter.mesh_topology(soup, corners).parts == 1
    found = prefilter.mesh_topology(soup, corners, weld=False)
    assert (found.parts, found.genus, found.borders) == (12, 0, 12)


@pytest.mark.parametrize("seed", range(8))
def test_parts_are_what_a_walk_reaches(seed):
    rng = np.random.default_rng(seed)
    positions = rng.integers(0, 3, (60, 3)).astype(np.float32)
    triangles = rng.integers(0, 60, (rng.integers(1, 40), 3))
    names = np.unique(positions, axis=0, return_inverse=True)[1].reshape(-1)
    soup = positions[triangles].reshape(-1, 3)  # where all vertices are of borders
    corners = np.arange(len(soup)).reshape(-1, 3)
    for threads, mesh, named in (
        (1, (soup, corners, True), names[triangles]),
        (4, (soup, corners, True), names[triangles]),
        (2, (positions, triangles, False), triangles),
    ):
        found = prefilter.mesh_topology(*mesh[:2], weld=mesh[2], threads=threads)
        parts, part_of = walked_parts(named)
        assert found.parts == parts
        name_of = dict(zip(mesh[1].ravel().tolist(), named.ravel().tolist(), strict=True))
        edges = [frozenset((name_of[a], name_of[b])) for a, b in found.border_edges.tolist()]
        assert sorted(map(sorted, edges)) == single_edges(named)
        np.testing.assert_array_equal(found.part_of, part_of)


def test_vertices_where_surfaces_meet_are_several():
    # A ring of boxes, each of which touches the next at a vertex: no handle.
    boxes = [(0, 0, 0), (1, 1, 1), (2, 0, 2), (1, -1, 1)]
    found = prefilter.mesh_topology(*merged(*joined(*(shape(BOX, at) for at in boxes))))
    assert (found.parts, found.genus, found.borders) == (4, 0, 0)


def turned(mesh):
    """Returns a mesh inside out."""
    positions, triangles = mesh
    return positions, np.asarray(triangles)[:, ::-1]


def scaled(mesh, factor):
    return mesh[0] * factor, mesh[1]


def hollow(scale=1.0, count=1):
    """A box of 20 with boxes of 1 cut out of it."""
    cavities = (turned(shape(BOX, (3 * k + 2, 4, 5))) for k in range(count))
    return scaled(joined(scaled(shape(BOX), 20.0), *cavities), scale)


@pytest.mark.parametrize("scale", [1e-300, 1e-100, 1.0, 1e100, 1e298])
def test_cavities_are_no_solids(scale):
    for count in range(4):
        found = prefilter.mesh_topology(*hollow(scale, count))
        assert (found.parts, found.cavities, found.solids) == (count + 1, count, 1)


def signed_volume(positions, triangles):
    """Returns six times the volume, as a whole number; positions are whole numbers."""
    corners = [[[int(x) for x in positions[v]] for v in t] for t in triangles.tolist()]
    return sum(
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
        for a, b, c in corners
    )


@pytest.mark.parametrize("seed", range(6))
def test_cavities_are_closed_parts_of_negative_volume(seed):
    """Parts of whole coordinates, far away, some inside out, some open, some of mixed faces."""
    rng = np.random.default_rng(seed)
    meshes, cavities = [], 0
    for _ in range(30):
        positions = np.round(rng.normal(size=BOX.positions.shape) * 9 + BOX.positions * 50)
        positions = positions + rng.integers(-(10**6), 10**6, 3)
        triangles = BOX.triangles[:, ::-1] if rng.integers(2) else BOX.triangles
        kind = rng.integers(4)
        if kind == 0:
            triangles = triangles[1:]
        if kind == 1:
            triangles = np.concatenate([triangles[:1, ::-1], triangles[1:]])
        cavities += kind > 1 and signed_volume(positions, triangles) < 0
        meshes.append((positions, triangles))
    positions, triangles = joined(*meshes)
    for threads in (1, 3):
        found = prefilter.mesh_topology(positions, triangles, threads=threads)
        assert (found.parts, found.cavities) == (30, cavities)


def test_sheets_of_two_faces_are_no_cavities():
    for seed in range(20):
        points = np.random.default_rng(seed).normal(size=(3, 3)) + 1000.0
        found = prefilter.mesh_topology(points, [[0, 1, 2], [2, 1, 0]])
        assert (found.parts, found.cavities) == (1, 0)


def test_closed_parts_are_not_welded():
    found = prefilter.mesh_topology(*joined(shape(BOX), shape(BOX, (1, 0, 0))))
    assert (found.parts, found.genus, found.borders) == (2, 0, 0)


def test_canceling():
    with pytest.raises(prefilter.Cancelled):
        prefilter.mesh_topology(*shape(TORUS), progress=lambda _: False)
