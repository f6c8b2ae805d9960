# SPDX-License-Identifier: GPL-3.0-or-later

"""Limit surfaces, against closed forms and a slow refinement written from the rules."""

from collections import defaultdict

import numpy as np
import prefilter
import pytest

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
CUBE_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
UNIT = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
OCTAHEDRON = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
OCTAHEDRON_FACES = [
    [a, b, c] if a * 1 + (b - 2) + (c - 4) in (0, 2) else [a, c, b]
    for a in (0, 1)
    for b in (2, 3)
    for c in (4, 5)
]
UV_RULES = (
    "none",
    "preserve-corners",
    "preserve-corners-and-junctions",
    "preserve-corners-junctions-and-concave",
    "preserve-boundaries",
    "smooth-all",
)


def limit(positions, polygons, uvs=None, **options):
    corners = np.concatenate(polygons)
    sizes = np.array([len(polygon) for polygon in polygons])
    uvs = np.zeros((len(corners), 2)) if uvs is None else uvs
    return prefilter.Surface.from_subdivision(
        np.asarray(positions, float), sizes, corners, np.asarray(uvs, float), **options
    )


def grid(n):
    """A square of n x n quads in [0, 1]^2."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    positions = np.stack([x, y, np.zeros_like(x)], -1).reshape(-1, 3)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    return positions, np.stack([first, first + 1, first + n + 2, first + n + 1], 1)


def sorted_rows(points):
    rounded = np.round(points, 9) + 0.0
    return points[np.lexsort(rounded.T[::-1])]


def edges_of(faces):
    for face in faces:
        yield from ((min(e), max(e)) for e in zip(face, np.roll(face, -1).tolist(), strict=True))


def refined(points, faces, sharp):
    """Catmull and Clark's rules with DeRose, Kass and Truong's for whole-numbered sharpness."""
    faces = [list(map(int, face)) for face in faces]
    of_edge, of_vertex, faces_at = defaultdict(list), defaultdict(set), defaultdict(list)
    for k, face in enumerate(faces):
        for edge in edges_of([face]):
            of_edge[edge].append(k)
        for v in face:
            faces_at[v].append(k)
    for edge in of_edge:
        of_vertex[edge[0]].add(edge)
        of_vertex[edge[1]].add(edge)
    sharp = {e: sharp.get(e, 0) if len(of_edge[e]) == 2 else np.inf for e in of_edge}
    centers = np.array([points[face].mean(axis=0) for face in faces])
    new, place, next_sharp = [], {}, {}
    for v in range(len(points)):
        n = len(of_vertex[v])
        others = [e[0] if e[1] == v else e[1] for e in of_vertex[v]]
        creases = [o for e, o in zip(of_vertex[v], others, strict=True) if sharp[e] >= 1]
        if len(creases) > 2:
            new.append(points[v])
        elif len(creases) == 2:
            new.append(0.75 * points[v] + 0.125 * points[creases].sum(axis=0))
        else:
            around = points[others].sum(axis=0) + centers[faces_at[v]].sum(axis=0)
            new.append((n - 2) / n * points[v] + around / n**2)
    for edge, (one, *two) in of_edge.items():
        place[edge] = len(new)
        middle = points[list(edge)].mean(axis=0)
        smooth = not sharp[edge] >= 1
        new.append((middle + centers[[one, *two]].mean(axis=0)) / 2 if smooth else middle)
        for v in edge:
            next_sharp[v, place[edge]] = max(0, sharp[edge] - 1)
    first = len(new)
    new.extend(centers)
    quads = []
    for k, face in enumerate(faces):
        for i, v in enumerate(face):
            after = place[tuple(sorted((v, face[(i + 1) % len(face)])))]
            before = place[tuple(sorted((v, face[i - 1])))]
            quads.append([v, after, first + k, before])
    return np.array(new), quads, next_sharp


def limit_points(points, faces, sharp):
    """The limit masks, for meshes of quads: Halstead, Kass and DeRose; cubic B-splines."""
    neighbors, across = defaultdict(set), defaultdict(list)
    counts, creases = defaultdict(int), defaultdict(list)
    for face in faces:
        for i, v in enumerate(face):
            neighbors[v] |= {face[i - 1], face[(i + 1) % 4]}
            across[v].append(face[(i + 2) % 4])
    for edge in edges_of(faces):
        counts[edge] += 1
    for (a, b), count in counts.items():
        if count != 2 or sharp.get((a, b), sharp.get((b, a), 0)) >= 1:
            creases[a].append(b)
            creases[b].append(a)
    found = []
    for v, point in enumerate(points):
        n = len(neighbors[v])
        if len(creases[v]) > 2:
            found.append(point)
        elif len(creases[v]) == 2:
            found.append((4 * point + points[creases[v]].sum(axis=0)) / 6)
        else:
            around = 4 * points[list(neighbors[v])].sum(axis=0) + points[across[v]].sum(axis=0)
            found.append((n * n * point + around) / (n * (n + 5)))
    return np.array(found)


def slow_limit(points, faces, level, sharp=()):
    sharp = {tuple(sorted(edge)): value for edge, value in dict(sharp).items()}
    for _ in range(level):
        points, faces, sharp = refined(points, faces, sharp)
        sharp = {tuple(sorted(edge)): value for edge, value in sharp.items()}
    return limit_points(points, faces, sharp)


class TestPositions:
    @pytest.mark.parametrize("level", [1, 2, 4])
    def test_corner_of_a_cube(self, level):
        """(9 v + 4 (sum of neighbors) + (sum of vertices across faces)) / 24 = v / 2."""
        positions = limit(CUBE, CUBE_FACES, level=level).positions
        for corner in CUBE / 2:
            assert np.abs(positions - corner).max(axis=1).min() < 1e-14

    @pytest.mark.parametrize("level", [1, 2, 3])
    def test_against_the_rules(self, level):
        rng = np.random.default_rng(1)
        cube = CUBE + rng.normal(scale=0.3, size=CUBE.shape)
        found = limit(cube, CUBE_FACES, level=level)
        np.testing.assert_allclose(
            sorted_rows(found.positions),
            sorted_rows(slow_limit(cube, CUBE_FACES, level)),
            atol=1e-13,
        )

    def test_against_the_rules_with_triangles_pentagons_and_boundary(self):
        rng = np.random.default_rng(2)
        faces = [[0, 1, 2, 3, 4], [1, 0, 5], [2, 1, 5, 6], [3, 2, 6], [3, 6, 7, 4]]
        points = rng.normal(size=(8, 3))
        found = limit(points, faces, level=2, boundary="edge-only")
        np.testing.assert_allclose(
            sorted_rows(found.positions), sorted_rows(slow_limit(points, faces, 2)), atol=1e-13
        )

    def test_semi_sharp_creases_against_the_rules(self):
        sharp = {(0, 1): 1, (1, 3): 1, (3, 2): 1, (2, 0): 1, (4, 6): 2, (4, 5): 2, (0, 4): 9}
        edges, values = np.array(list(sharp)), np.array(list(sharp.values()), float)
        points = CUBE + np.random.default_rng(3).normal(scale=0.2, size=CUBE.shape)
        found = limit(points, CUBE_FACES, level=3, creases=(edges, values))
        wanted = slow_limit(points, CUBE_FACES, 3, sharp)
        near = np.linalg.norm(found.positions[:, None] - wanted, axis=2).min(axis=1)
        assert np.median(near) < 1e-13
        # Where unlike creases meet, whole numbers are no longer enough for the rules above.
        assert np.mean(near < 1e-13) > 0.9

    def test_plane_stays_plane(self):
        positions, faces = grid(4)
        moved = positions @ np.array([[1, 0, 0.5], [0.3, 1, -2], [0, 0, 0]])
        found = limit(moved, faces, level=3)
        normal = np.cross([1, 0, 0.5], [0.3, 1, -2])
        np.testing.assert_allclose(found.positions @ normal, 0, atol=1e-14)

    def test_square_keeps_its_area_but_for_round_corners(self):
        positions, faces = grid(3)
        assert limit(positions, faces).area == pytest.approx(1, rel=1e-14)
        assert limit(positions, faces, boundary="edge-only").area < 0.99

    def test_infinite_creases_stay_straight(self):
        edges = np.array(sorted(set(edges_of(CUBE_FACES))))
        for sharpness in (10.0, np.inf, 1e300):
            found = limit(CUBE, CUBE_FACES, creases=(edges, np.full(12, sharpness)), level=2)
            assert found.area == pytest.approx(24, rel=1e-13)

    def test_a_sharp_corner_stays(self):
        found = limit(CUBE, CUBE_FACES, corners=(np.array([7]), np.array([10.0])))
        assert np.abs(found.positions - CUBE[7]).max(axis=1).min() == 0
        assert np.abs(found.positions - CUBE[0]).max(axis=1).min() > 0.4

    def test_area_converges_with_the_square_of_the_size(self):
        areas = np.array([limit(CUBE, CUBE_FACES, level=level).area for level in range(1, 8)])
        best = areas[-1] + (areas[-1] - areas[-2]) / 3
        ratios = (best - areas[:-2]) / (best - areas[1:-1])
        np.testing.assert_allclose(ratios[1:], 4, rtol=0.06)
        assert abs(areas[2] / best - 1) < 0.01

    def test_loop_vertex_of_an_octahedron(self):
        beta = (5 / 8 - (3 / 8) ** 2) / 4
        weight = 1 / (4 + 3 / (8 * beta))
        found = limit(OCTAHEDRON, OCTAHEDRON_FACES, scheme="loop", level=2)
        assert found.triangle_count == 8 * 16
        for corner in OCTAHEDRON * (1 - 4 * weight):
            assert np.abs(found.positions - corner).max(axis=1).min() < 1e-14

    def test_bilinear_is_the_mesh(self):
        assert limit(CUBE, CUBE_FACES, scheme="bilinear").area == pytest.approx(24, rel=1e-14)

    def test_vertices_are_shared(self):
        found = limit(CUBE, CUBE_FACES, level=2)
        assert len(found.positions) == 98  # Of a closed surface of 96 quads.
        edges = np.sort(found.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        assert np.all(np.unique(edges, axis=0, return_counts=True)[1] == 2)


class TestTextureCoordinates:
    def test_smooth_all_is_the_limit_of_a_planar_mesh(self):
        positions, faces = grid(3)
        rng = np.random.default_rng(5)
        positions[:, :2] += rng.uniform(-0.1, 0.1, (16, 2))
        uvs = positions[faces.ravel(), :2]
        found = limit(positions, faces, uvs, uv_smooth="smooth-all", boundary="edge-only")
        np.testing.assert_allclose(found.positions[found.triangles][..., :2], found.uvs, atol=1e-14)

    def test_none_is_linear(self):
        rng = np.random.default_rng(6)
        positions, faces = grid(2)
        uvs = rng.uniform(size=(9, 2))[faces.ravel()]
        smooth = limit(positions, faces, uvs, uv_smooth="none", level=2)
        linear = limit(positions, faces, uvs, scheme="bilinear", level=2)
        np.testing.assert_allclose(smooth.uvs, linear.uvs, atol=1e-14)

    @pytest.mark.parametrize("rule", UV_RULES[:-1])
    def test_one_chart_a_face_keeps_its_corners(self, rule):
        uvs = np.concatenate([np.add(UNIT, (2 * i, 0)) for i in range(6)])
        found = limit(CUBE, CUBE_FACES, uvs, uv_smooth=rule)
        sides = (found.uvs[:, 1] - found.uvs[:, 0], found.uvs[:, 2] - found.uvs[:, 0])
        chart_area = np.abs(sides[0][:, 0] * sides[1][:, 1] - sides[0][:, 1] * sides[1][:, 0]) / 2
        assert chart_area.sum() == pytest.approx(6, rel=1e-13)

    def test_rules_differ(self):
        """Four charts with corners, a concave one and a junction tell the rules apart."""
        positions, faces = grid(4)
        rng = np.random.default_rng(7)
        uvs = (positions[:, :2] + rng.uniform(-0.1, 0.1, (25, 2)))[faces]
        for k, chart in enumerate([[0], [8, 9, 12, 13], [10, 11, 14, 15]], start=1):
            uvs[chart] += 2 * k
        results = [limit(positions, faces, uvs.reshape(-1, 2), uv_smooth=r).uvs for r in UV_RULES]
        for i, one in enumerate(results):
            for other in results[:i]:
                assert np.abs(one - other).max() > 1e-3

    def test_signed_zeros_are_equal(self):
        positions, faces = grid(1)
        positions = np.concatenate([positions, positions[[1, 3]] + (1, 0, 0)])
        faces = [[0, 1, 3, 2], [1, 4, 5, 3]]
        uvs = np.concatenate([UNIT - (1, 0), UNIT])
        uvs[1, 0] = uvs[2, 0] = -0.0
        joined = limit(positions, faces, uvs, uv_smooth="smooth-all")
        uvs[1, 0] = uvs[2, 0] = 0.0
        np.testing.assert_array_equal(
            joined.uvs,
            limit(positions, faces, uvs, uv_smooth="smooth-all").uvs,
        )


class TestParts:
    def test_faces_are_parts_of_the_whole(self):
        whole = limit(CUBE, CUBE_FACES, level=2)
        masks = [np.array([1, 0, 0, 1, 0, 0], bool), np.array([0, 1, 1, 0, 1, 1], bool)]
        parts = [limit(CUBE, CUBE_FACES, level=2, faces=mask) for mask in masks]
        assert sum(part.area for part in parts) == pytest.approx(whole.area, rel=1e-14)
        for mask, part in zip(masks, parts, strict=True):
            chosen = np.repeat(mask, 4 * 4 * 2)
            np.testing.assert_array_equal(
                part.positions[part.triangles], whole.positions[whole.triangles[chosen]]
            )
            assert len(part.positions) == len(np.unique(part.triangles))

    def test_weights_of_faces(self):
        weights = np.array([0.0, 1, 2, 3, 4, 5])
        whole = limit(CUBE, CUBE_FACES, level=2)
        found = limit(CUBE, CUBE_FACES, level=2, weights=weights)
        np.testing.assert_allclose(found.areas, whole.areas * np.repeat(weights, 32), rtol=1e-14)

    def test_weights_of_vertices_are_linear(self):
        positions, faces = grid(2)
        whole = limit(positions, faces, level=2, scheme="bilinear")
        found = limit(positions, faces, level=2, weights=3 * positions[:, 0] + 1)
        x = whole.positions[whole.triangles][..., 0].mean(axis=1)
        np.testing.assert_allclose(found.areas, whole.areas * (3 * x + 1), rtol=1e-13)


class TestNastyMeshes:
    def test_unused_vertices_are_dropped(self):
        far = np.array([[1e9, 0, 0]])
        found = limit(np.concatenate([far, CUBE, far]), np.array(CUBE_FACES) + 1, level=2)
        np.testing.assert_array_equal(found.positions, limit(CUBE, CUBE_FACES, level=2).positions)

    def test_sheets_that_share_an_edge_or_a_vertex(self):
        positions = np.random.default_rng(8).normal(size=(12, 3))
        fin = [[0, 1, 2, 3], [0, 1, 4, 5], [1, 0, 6, 7], [0, 1, 8, 9]]
        bow = [[0, 1, 2], [0, 3, 4], [0, 5, 6]]
        for faces in (fin, bow, [*fin, [3, 10, 11]]):
            for rule in UV_RULES:
                uvs = np.random.default_rng(9).uniform(size=(sum(map(len, faces)), 2))
                found = limit(positions, faces, uvs, uv_smooth=rule, level=3)
                assert np.isfinite(found.area)
                assert found.area > 0
        shared = limit(positions, fin, level=2).positions
        for vertex in positions[:2]:
            assert np.abs(shared - vertex).max(axis=1).min() < 1e-12

    def test_duplicate_and_inverted_faces(self):
        for faces in (CUBE_FACES * 2, CUBE_FACES + [face[::-1] for face in CUBE_FACES]):
            assert np.isfinite(limit(CUBE, faces, level=2).area)
        flipped = [face[::-1] if i % 2 else face for i, face in enumerate(CUBE_FACES)]
        assert limit(CUBE, flipped, level=2).area > 0

    def test_no_area(self):
        assert limit(np.zeros((8, 3)), CUBE_FACES).area == 0

    def test_one_triangle(self):
        assert limit(CUBE[:3], [[0, 1, 2]]).triangle_count == 3 * 16 * 2

    def test_a_face_and_a_vertex_of_many(self):
        n = 3000
        angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
        ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
        disk = limit(ring, [np.arange(n)], level=1)
        assert disk.area == pytest.approx(np.pi, rel=1e-3)
        fan = [[i, (i + 1) % n, n] for i in range(n)]
        cone = limit(np.concatenate([ring, [[0, 0, 0]]]), fan, level=1)
        assert cone.area == pytest.approx(np.pi, rel=1e-3)


BAD = [
    ({"positions": CUBE[:, :2]}, r"positions: shape \(8, 2\)"),
    ({"positions": np.full((8, 3), np.nan)}, "positions: vertex 0 holds nan"),
    ({"positions": CUBE * 1e200}, "positions: the area of triangle 0 is too large"),
    (
        {
            "face_sizes": np.empty(0, int),
            "face_vertices": np.empty(0, int),
            "face_uvs": np.empty((0, 2)),
        },
        "face_sizes: the mesh has no faces",
    ),
    ({"face_sizes": np.full(6, 5)}, "face_sizes: add up to 30, but face_vertices has 24"),
    ({"face_sizes": np.array([4, 4, 4, 4, 4, 2, 2])}, "face_sizes: face 5 has 2 corners; 3 to"),
    ({"face_sizes": np.array([4, 4, 4, 4, 4, -4, 8])}, "face_sizes: face 5 has -4 corners"),
    ({"face_sizes": np.full(5, 4)}, "face_sizes: add up to 20, but face_vertices has 24"),
    ({"face_sizes": np.full(6, 4.0)}, "face_sizes: dtype float64; integers"),
    ({"face_vertices": np.full(24, 8)}, "face 0 names vertex 8, but there are 8 vertices"),
    ({"face_vertices": np.zeros(24, int)}, "face_vertices: face 0 names vertex 0 twice"),
    ({"face_uvs": np.zeros((23, 2))}, r"face_uvs: shape \(23, 2\); \(24, 2\)"),
    ({"face_uvs": np.full((24, 2), np.inf)}, "face_uvs: corner 0 holds inf"),
    ({"level": 0}, "level: 0; 1 to 10"),
    ({"level": 11}, "level: 11; 1 to 10"),
    ({"level": 2**40}, "level: .*1 to 10"),
    ({"level": 2.0}, "level: 2.0; a whole number"),
    ({"creases": ([[0, 7]], [1.0])}, "creases: crease 0 is between vertices 0 and 7; an edge"),
    ({"creases": ([[0, 0]], [1.0])}, "creases: crease 0 is between vertices 0 and 0; an edge"),
    ({"creases": ([[0, 99]], [1.0])}, "creases: crease 0 names vertex 99, but there are 8"),
    ({"creases": ([[0, 1]], [-1.0])}, "creases: crease 0 has sharpness -1; 0 and up"),
    ({"creases": ([[0, 1]], [np.nan])}, "creases: crease 0 has sharpness nan"),
    ({"creases": ([[0, 1]], [1.0, 2.0])}, r"creases: sharpness: shape \(2,\); \(1,\)"),
    ({"creases": [[0, 1]]}, "creases: list; a pair"),
    ({"corners": ([-1], [1.0])}, "corners: corner 0 names vertex -1"),
    ({"corners": ([1], [-0.5])}, "corners: corner 0 has sharpness -0.5"),
    ({"scheme": "doo-sabin"}, "scheme: 'doo-sabin' is not one of catmull-clark, loop, bilinear"),
    ({"scheme": "loop"}, "face_sizes: face 0 has 4 corners; the scheme loop needs triangles"),
    ({"scheme": None}, "scheme: None; a name"),
    ({"boundary": "none"}, "boundary: 'none' is not one of edge-and-corner, edge-only"),
    ({"uv_smooth": "all"}, "uv_smooth: 'all' is not one of none, preserve-corners"),
    ({"weights": np.ones((6, 4))}, r"weights: shape \(6, 4\) of float64; .*\(6, 1\) for faces"),
    ({"weights": -np.ones(6)}, "weights: face 0 has -1"),
    ({"weights": np.full(8, np.inf)}, "weights: vertex 0 has inf"),
    ({"faces": np.zeros(6, bool)}, "faces: none is chosen"),
    ({"faces": np.zeros(5, bool)}, r"faces: shape \(5,\) of bool; \(6,\)"),
    ({"faces": np.arange(6, dtype=np.int64)}, r"faces: shape \(6,\) of int64"),
    ({"progress": 3}, "progress: 3; a callable"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
def test_bad_arguments(change, message):
    arguments = {
        "positions": CUBE,
        "face_sizes": np.full(6, 4),
        "face_vertices": np.ravel(CUBE_FACES),
        "face_uvs": np.zeros((24, 2)),
    }
    with pytest.raises(ValueError, match=message):
        prefilter.Surface.from_subdivision(**(arguments | change))


def test_memory_is_refused_before_it_is_asked_for():
    positions, faces = grid(300)
    with pytest.raises(ValueError, match=r"level: 10 makes .* GB; .* level 3 is the highest"):
        limit(positions, faces, level=10)


def test_progress_and_canceling():
    seen = []
    limit(CUBE, CUBE_FACES, level=7, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1
    with pytest.raises(prefilter.Cancelled):
        limit(CUBE, CUBE_FACES, progress=lambda fraction: False)
