# SPDX-License-Identifier: GPL-3.0-or-later

"""`paint_texture`: colors of points on the texture of a mesh."""

import numpy as np
import prefilter
import pytest
from clouds import torus

QUAD = prefilter.Surface(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
    [(0, 1, 2), (0, 2, 3)],
    [(0, 0), (1, 0), (1, 1), (0, 1)],
)


def scattered(count, seed=0):
    points = np.random.default_rng(seed).random((count, 3)) * (1, 1, 0)
    return points, np.column_stack([points[:, 0], points[:, 1], 0.5 + 0 * points[:, 0]])


def looked_up(image, uvs):
    """Colors at UVs, by clamped bilinear lookups in numpy."""
    height, width = image.shape[:2]
    x, y = uvs[:, 0] * width - 0.5, uvs[:, 1] * height - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    total = 0
    for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
        share = np.abs(1 - dx - (x - i)) * np.abs(1 - dy - (y - j))
        texels = image[np.clip(j + dy, 0, height - 1), np.clip(i + dx, 0, width - 1)]
        total = total + share[:, None] * texels
    return total


def test_lookups_have_the_colors_of_other_points():
    points, colors = scattered(20_000)
    image = prefilter.paint_texture(QUAD, points, colors, 32, 16, smoothing=0.001)
    assert image.shape == (16, 32, 3)
    others, expected = scattered(1000, seed=1)
    inside = (np.abs(others[:, :2] - 0.5) < 0.42).all(axis=1)
    np.testing.assert_allclose(looked_up(image, others[inside]), expected[inside], atol=5e-3)


def test_it_fills_gaps_and_averages_noise():
    points, colors = scattered(40_000)
    noisy = colors + 0.2 * np.random.default_rng(2).normal(size=colors.shape)
    kept = np.hypot(points[:, 0] - 0.5, points[:, 1] - 0.5) > 0.2
    image = prefilter.paint_texture(QUAD, points[kept], noisy[kept], 32, 32, smoothing=20.0)
    v, u = (np.mgrid[:32, :32] + 0.5) / 32
    assert np.abs(image[..., 0] - u)[4:-4, 4:-4].max() < 0.08
    assert np.abs(image[..., 1] - v)[4:-4, 4:-4].max() < 0.08


def test_a_scan_on_its_own_surface():
    cloud = torus(30_000)
    colors = (127.5 + 127.4 * cloud.normals).astype(np.uint8)
    positions, triangles = prefilter.reconstruct(*cloud.both, depth=6, adaptivity=0.1)
    # One chart a triangle, in a grid of squares: whatever lies beside a chart is another's.
    side = int(np.ceil(np.sqrt(len(triangles))))
    corner = np.stack([np.arange(len(triangles)) % side, np.arange(len(triangles)) // side], axis=1)
    shape = np.array([(0.2, 0.2), (0.8, 0.2), (0.2, 0.8)])
    uvs = (corner[:, None] + shape) / side
    surface = prefilter.Surface(positions, triangles, uvs)
    texture = prefilter.paint_texture(surface, cloud.points, colors, 10 * side, 10 * side)
    random = np.random.default_rng(3)
    chosen = random.integers(len(triangles), size=5000)
    weights = random.dirichlet(np.ones(3), 5000)
    there = np.einsum("nk,nkd->nd", weights, positions[triangles[chosen]])
    found = looked_up(texture, np.einsum("nk,nkd->nd", weights, uvs[chosen]))
    ring = there / np.hypot(there[:, 0], there[:, 1])[:, None] * (1, 1, 0)
    normal = there - ring
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    error = np.abs(found - (0.5 + 0.5 * normal))
    assert error.mean() < 0.02
    assert np.quantile(error, 0.99) < 0.1


def test_forms_and_limits():
    points, colors = scattered(500)
    one = prefilter.paint_texture(QUAD, points, colors[:, 0], 8, 4)
    assert one.shape == (4, 8)
    assert colors[:, 0].min() <= one.min() <= one.max() <= colors[:, 0].max()
    many = prefilter.paint_texture(QUAD, points, colors, 8, 4)
    np.testing.assert_allclose(many[..., 0], one, atol=1e-4)
    for threads in (1, 3):
        again = prefilter.paint_texture(QUAD, points, colors, 8, 4, threads=threads)
        np.testing.assert_array_equal(again, many)
    single = prefilter.paint_texture(QUAD, points[:1], [[0.25, 0.5, 0.75]], 4, 4)
    np.testing.assert_allclose(single, np.broadcast_to([0.25, 0.5, 0.75], (4, 4, 3)), atol=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"surface": None}, "surface: a NoneType; a Surface is needed"),
        ({"colors": np.ones((3, 3))}, "colors: shape"),
        ({"points": np.empty((0, 3)), "colors": np.empty((0, 3))}, "points: none has a finite"),
        ({"points": np.full((5, 3), np.nan), "colors": np.ones((5, 3))}, "points: none has"),
        ({"colors": np.ones((5, 5)), "points": np.ones((5, 3))}, "values: found 25 for 5 points"),
        ({"smoothing": 0.0}, "smoothing: found 0; a number above 0"),
        ({"reach": -1.0}, "reach: found -1; a number above 0"),
        ({"width": 0}, "width"),
    ],
)
def test_refusals(change, message):
    points, colors = scattered(5)
    given = {"surface": QUAD, "points": points, "colors": colors, "width": 8, "height": 8} | change
    with pytest.raises(ValueError, match=message):
        prefilter.paint_texture(**given)


def test_a_cancel_stops_it():
    points, colors = scattered(100_000)
    with pytest.raises(prefilter.Cancelled):
        prefilter.paint_texture(
            QUAD, points, colors, 256, 256, progress=lambda fraction: fraction < 0.3
        )
