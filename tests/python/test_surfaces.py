# SPDX-License-Identifier: GPL-3.0-or-later

"""Surfaces: weights, placements, poses and UDIM tiles, against closed forms and slow clipping."""

from fractions import Fraction

import numpy as np
import prefilter
import pytest

SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]], float)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
SQUARE_UVS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)[HALVES]


def square(**options):
    return prefilter.Surface(SQUARE, HALVES, SQUARE_UVS, **options)


def triangle_areas(surface):
    a, b, c = np.moveaxis(surface.positions[surface.triangles], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def random_surface(seed, triangles=40, spread=3.0):
    rng = np.random.default_rng(seed)
    positions = rng.normal(size=(30, 3))
    corners = rng.integers(0, 30, (triangles, 3))
    return prefilter.Surface(positions, corners, rng.uniform(-0.5, spread, (triangles, 3, 2)))


def test_keeps_its_mesh():
    surface = square()
    np.testing.assert_array_equal(surface.positions, SQUARE)
    np.testing.assert_array_equal(surface.triangles, HALVES)
    np.testing.assert_array_equal(surface.uvs, SQUARE_UVS)
    np.testing.assert_array_equal(surface.areas, [3, 3])
    surface.positions[:] = 7
    assert surface.positions.max() == 3


class TestWeights:
    def test_of_vertices_are_averaged(self):
        surface = square(weights=np.array([0.0, 3.0, 6.0, 0.0]))
        np.testing.assert_allclose(surface.areas, [3 * 3, 3 * 2])

    @pytest.mark.parametrize("shape", [(2,), (2, 1)])
    def test_of_triangles(self, shape):
        surface = square(weights=np.array([0.5, 4.0], np.float32).reshape(shape))
        np.testing.assert_array_equal(surface.areas, [1.5, 12])

    def test_of_corners(self):
        surface = square(weights=np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 1.0]]))
        np.testing.assert_allclose(surface.areas, [6, 1])

    def test_of_vertices_where_there_are_as_many_triangles(self):
        corners = np.array([[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]])
        uvs = np.zeros((4, 3, 2))
        weights = np.array([6.0, 0.0, 0.0, 0.0])
        areas = [
            prefilter.Surface(SQUARE, corners, uvs, weights=w).areas
            for w in (weights, weights[:, None])
        ]
        np.testing.assert_allclose(areas[0], [6, 6, 6, 0])
        np.testing.assert_allclose(areas[1], [18, 0, 0, 0])

    def test_ask_more_of_a_level(self):
        """Texel 0 is 1, texel 1 is 0: their mean follows the weight of the triangles over them."""
        positions = np.array([[x, y, 0.0] for x in (0, 1, 2) for y in (0, 1)])
        corners = np.array([[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]])
        uvs = (positions[:, :2] / (2, 1))[corners]
        image = np.array([[[1.0], [0.0]], [[1.0], [0.0]]], np.float32)
        weights = np.array([3.0, 3.0, 1.0, 1.0])
        surface = prefilter.Surface(positions, corners, uvs, weights=weights)
        level = prefilter.mipmaps(image, surface, filter="pam-box")[1]
        assert level[0, 0, 0] == pytest.approx(0.75)

    def test_of_zero_everywhere_are_refused_by_a_bake(self):
        with pytest.raises(ValueError, match=r"surface: .* area of 0"):
            prefilter.mipmaps(np.ones((4, 4, 3), np.float32), square(weights=np.zeros(4)))


class TestPlaced:
    def test_is_the_transformed_mesh(self):
        rng = np.random.default_rng(3)
        surface = random_surface(1)
        matrix = np.eye(4)
        matrix[:3] = rng.normal(size=(3, 4)) * [3, -1, 0.1, 2]
        placed = surface.placed(matrix)
        moved = surface.positions @ matrix[:3, :3].T + matrix[:3, 3]
        np.testing.assert_allclose(placed.positions, moved, rtol=1e-13)
        np.testing.assert_allclose(placed.areas, triangle_areas(placed), rtol=1e-12)

    def test_many_times_adds_areas(self):
        rng = np.random.default_rng(4)
        weights = rng.uniform(0, 2, 40)
        base = random_surface(2)
        surface = prefilter.Surface(base.positions, base.triangles, base.uvs, weights=weights)
        matrices = rng.normal(size=(5, 3, 4))
        matrices[3] *= -2
        wanted = sum(triangle_areas(base.placed(matrix)) for matrix in matrices) * weights
        np.testing.assert_allclose(surface.placed(matrices).areas, wanted, rtol=1e-12)

    def test_flat_scales(self):
        matrix = np.diag([1.0, 1.0, 0.0, 1.0])
        surface = random_surface(5)
        placed = surface.placed(matrix)
        np.testing.assert_allclose(placed.areas, triangle_areas(placed), atol=1e-15)
        np.testing.assert_array_equal(surface.placed(np.diag([0.0, 0, 0, 1])).areas, 0)


class TestMerged:
    def test_poses_become_one(self):
        base = random_surface(6)
        poses = [base.placed(np.diag([s, 1, 2, 1])) for s in (1.0, 2.0, 0.3)]
        (merged,) = prefilter.Surface.merged(poses)
        np.testing.assert_allclose(merged.areas, sum(pose.areas for pose in poses), rtol=1e-14)
        np.testing.assert_array_equal(merged.positions, poses[0].positions)

    def test_is_the_same_to_a_filter_as_the_list(self):
        image = np.random.default_rng(7).uniform(size=(16, 16, 3)).astype(np.float32)
        base = random_surface(8, spread=1.0)
        poses = [base.placed(np.diag([s, 1, 2 - s, 1])) for s in (0.1, 0.5, 1.5)]
        merged = prefilter.Surface.merged(poses)
        assert len(merged) == 1
        for one, many in zip(
            prefilter.mipmaps(image, merged), prefilter.mipmaps(image, poses), strict=True
        ):
            np.testing.assert_allclose(one, many, atol=2e-6)

    def test_others_stay_apart_in_order(self):
        a, b = random_surface(9), random_surface(10)
        merged = prefilter.Surface.merged([a, b, a])
        assert [s.area for s in merged] == pytest.approx([2 * a.area, b.area])
        assert prefilter.Surface.merged([]) == []

    def test_areas_that_are_too_large(self):
        flat = square().placed(np.diag([4e153, 4e153, 1, 1]))
        with pytest.raises(ValueError, match="surfaces: the area of triangle 0 is too large"):
            prefilter.Surface.merged([flat] * 4)


def clipped_area(corners, column, row):
    """Twice the area of a triangle's part in a tile, in exact arithmetic."""
    polygon = [(Fraction(u) - column, Fraction(v) - row) for u, v in corners]
    for axis in (0, 1):
        for sign, line in ((1, 0), (-1, 1)):
            kept = []
            for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True):
                x, y = sign * (a[axis] - line), sign * (b[axis] - line)
                if x >= 0:
                    kept.append(a)
                if x * y < 0:
                    t = x / (x - y)
                    kept.append(tuple(p + t * (q - p) for p, q in zip(a, b, strict=True)))
            polygon = kept
    pairs = zip(polygon, polygon[1:] + polygon[:1], strict=True)
    return abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in pairs))


class TestUdimTile:
    def test_areas_against_exact_clipping(self):
        rng = np.random.default_rng(11)
        for seed in range(6):
            whole = random_surface(seed, triangles=1, spread=4.0)
            uvs = whole.uvs.copy()
            if seed % 2:  # Corners and edges on the grid.
                uvs = np.round(uvs * 2) / 2
            weights = rng.uniform(1, 2, (1, 1))
            surface = prefilter.Surface(whole.positions, whole.triangles, uvs, weights=weights)
            full = abs(np.linalg.det(np.array([uvs[0, 1] - uvs[0, 0], uvs[0, 2] - uvs[0, 0]])))
            for column in range(5):
                for row in range(5):
                    part = surface.udim_tile(1001 + column + 10 * row)
                    found = 0.0 if part is None else part.area
                    exact = float(clipped_area(uvs[0], column, row)) / full * surface.area
                    assert found == pytest.approx(exact, rel=1e-12, abs=1e-15)

    def test_positions_stay_where_the_texture_is(self):
        """A surface that is its own texture: cut triangles must lie at their UVs."""
        uvs = random_surface(12, triangles=30, spread=3.0).uvs
        corners = np.arange(90).reshape(-1, 3)
        positions = np.concatenate([uvs.reshape(-1, 2), np.zeros((90, 1))], 1)
        surface = prefilter.Surface(positions, corners, uvs)
        total = 0.0
        for column, row in np.ndindex(3, 3):
            part = surface.udim_tile(1001 + column + 10 * row)
            total += part.area
            assert part.uvs.min() >= 0
            assert part.uvs.max() <= 1
            np.testing.assert_allclose(part.areas, triangle_areas(part), atol=1e-14)
            np.testing.assert_allclose(
                part.positions[part.triangles][..., :2], np.add(part.uvs, (column, row)), atol=1e-14
            )
        inside = [clipped_area(uv, c, r) for uv in uvs for c in range(3) for r in range(3)]
        assert total == pytest.approx(float(sum(inside)) / 2, rel=1e-12)

    def test_parts_of_a_disk_are_disks(self):
        """Vertices of cut edges are shared, so the Euler characteristic is a disk's."""
        n = 7
        x, y = np.meshgrid(np.linspace(0, 3, n), np.linspace(0, 3, n))
        angle = 0.3
        u = x * np.cos(angle) - y * np.sin(angle) + 1
        v = x * np.sin(angle) + y * np.cos(angle)
        positions = np.stack([x, y, np.sin(3 * x)], -1).reshape(-1, 3)
        i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
        quads = np.stack([i, i + 1, i + n + 1, i + n], 1)
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        uvs = np.stack([u, v], -1).reshape(-1, 2)[triangles]
        surface = prefilter.Surface(positions, triangles, uvs)
        part = surface.udim_tile(1012)
        edges = np.sort(part.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edge_count = len(np.unique(edges, axis=0))
        assert len(part.positions) == len(np.unique(part.triangles))
        assert len(part.positions) - edge_count + part.triangle_count == 1

    def test_whole_in_one_tile(self):
        moved = prefilter.Surface(SQUARE, HALVES, np.add(SQUARE_UVS, (3, 2)))
        part = moved.udim_tile(1024)
        np.testing.assert_array_equal(part.positions[part.triangles], SQUARE[HALVES])
        np.testing.assert_array_equal(part.uvs, SQUARE_UVS)
        assert all(moved.udim_tile(n) is None for n in (1001, 1023, 1025, 1014, 1034, 9999))

    def test_a_line_in_the_texture(self):
        """u runs from 0 over 0.5 to 2: the part below 1 is all except a similar triangle."""
        uvs = np.array([[[0, 0.25], [0.5, 0.25], [2, 0.25]]])
        surface = prefilter.Surface(SQUARE, HALVES[:1], uvs)
        beyond = (2 - 1) / 2 * (2 - 1) / 1.5
        assert surface.udim_tile(1001).area == pytest.approx(3 * (1 - beyond), rel=1e-14)
        assert surface.udim_tile(1002).area == pytest.approx(3 * beyond, rel=1e-14)
        assert surface.udim_tile(1003) is None

    @pytest.mark.parametrize(
        ("uv", "number"),
        [((0.5, 0.5), 1001), ((1, 0.5), 1002), ((1, 1), 1012), ((10, 3), 1040), ((9, 0), 1010)],
    )
    def test_a_point_belongs_to_one_tile(self, uv, number):
        surface = prefilter.Surface(SQUARE, HALVES[:1], np.full((1, 3, 2), uv, float))
        owners = [n for n in range(1001, 1060) if surface.udim_tile(n) is not None]
        assert owners == [number]
        assert surface.udim_tile(number).area == 3

    def test_bakes_as_the_image_alone_would(self):
        image = np.random.default_rng(13).uniform(size=(8, 8, 3)).astype(np.float32)
        moved = prefilter.Surface(SQUARE, HALVES, np.add(SQUARE_UVS, (1, 0)))
        for a, b in zip(
            prefilter.mipmaps(image, moved.udim_tile(1002)),
            prefilter.mipmaps(image, square()),
            strict=True,
        ):
            np.testing.assert_array_equal(a, b)
