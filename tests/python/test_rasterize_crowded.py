# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawings with more crossings than pixels can show, against brute-force sampling."""

import numpy as np
import prefilter
import pytest

SIDE = 12


def ring(random: np.random.Generator, jitter: float) -> np.ndarray:
    """A polygon near a common circle."""
    turns = np.arange(24) / 24 * 2 * np.pi
    radii = 4.5 + random.normal(0, jitter, 24)
    return SIDE / 2 + 0.1 + radii[:, None] * np.stack([np.cos(turns), np.sin(turns)], 1)


def windings(contours, points):
    """Winding numbers of points."""
    result = np.zeros(len(points), int)
    x, y = points.T
    for contour in contours:
        for (x0, y0), (x1, y1) in zip(contour, np.roll(contour, -1, 0), strict=True):
            if y0 == y1:
                continue
            rises = (y0 <= y) & (y < y1)
            falls = (y1 <= y) & (y < y0)
            right = x < x0 + (y - y0) * ((x1 - x0) / (y1 - y0))
            result += (rises & right).astype(int) - (falls & right)
    return result


def sample_points(x, y, count):
    """Points of a pixel, spread so that no grid line covers more of them than another."""
    index = np.arange(count)
    return np.stack([x + (index + 0.5) / count, y + (index * 0.6180339887498949 + 0.2) % 1], 1)


def shape_of(contours, **arguments):
    shape = prefilter.Shape(**arguments)
    for contour in contours:
        shape.add_polygon(contour)
    return shape


def test_nearly_equal_outlines():
    """Eighty outlines once took time cubic in their number."""
    random = np.random.default_rng(1)
    rings = [ring(random, 0.3) for _ in range(80)]
    colors = [np.array([*(0.1 * random.random(3)), 0.1]) for _ in rings]
    shapes = [shape_of([r], color=tuple(c)) for r, c in zip(rings, colors, strict=True)]
    image = prefilter.rasterize(shapes, SIDE, SIDE)
    for x, y in ((10, 6), (6, 10), (2, 4), (9, 9), (3, 2)):
        points = sample_points(x, y, 1 << 13)
        expected = np.zeros((len(points), 4))
        for contour, color in zip(rings, colors, strict=True):
            inside = windings([contour], points) != 0
            expected[inside] = color + (1 - color[3]) * expected[inside]
        assert np.abs(image[y, x] - expected.mean(0)).max() < 0.5 / 255
    # Exact in pixels without an outline.
    assert image[6, 6, 3] == pytest.approx(1 - 0.9**80, abs=1e-6)


@pytest.mark.parametrize("rule", ["nonzero", "evenodd"])
def test_a_tangle_of_lines(rule):
    random = np.random.default_rng(2)
    corners = random.uniform(-4, SIDE + 4, (500, 2))
    image = prefilter.rasterize([shape_of([corners], fill_rule=rule)], SIDE, SIDE)[..., 0]
    for x, y in ((5, 5), (6, 3), (2, 8), (9, 9)):
        numbers = windings([corners], sample_points(x, y, 1 << 16))
        inside = numbers != 0 if rule == "nonzero" else numbers % 2 != 0
        assert abs(image[y, x] - inside.mean()) < 0.5 / 255


def test_stroke_of_a_scribble():
    """The stroke overlaps itself thousands of times, or covers the whole image."""
    random = np.random.default_rng(3)
    path = prefilter.Shape()
    path.move_to(6, 6)
    for point in random.uniform(0, SIDE, (1500, 2)):
        path.line_to(*point)
    for width in (0.02, 1.0, 40.0):
        image = prefilter.rasterize([path.stroked(width)], SIDE, SIDE)
        assert image.min() > -1e-6
        assert image.max() < 1 + 1e-6
    assert np.abs(image - 1).max() < 1e-6


@pytest.mark.parametrize("alpha", [1.0, 0.1])
def test_equal_triangles(alpha):
    """Each triangle hides those below it, according to its opacity."""
    corners = np.array([(1.3, 1.7), (10.6, 2.9), (4.2, 11.4)])
    shapes = [shape_of([corners], color=(alpha, 0, 0, alpha)) for _ in range(2000)]
    image = prefilter.rasterize(shapes, SIDE, SIDE)
    once = prefilter.rasterize([shape_of([corners])], SIDE, SIDE)[..., 0]
    assert np.abs(image[..., 3] - once).max() < 1.5 / 255
    assert (image[once == 0] == 0).all()


def test_methods_and_overlaps_agree():
    random = np.random.default_rng(4)
    contours = [random.uniform(0, SIDE, (3, 2)) for _ in range(2000)]
    shape = shape_of(contours)
    image = prefilter.rasterize([shape], SIDE, SIDE)
    added = prefilter.rasterize([shape], SIDE, SIDE, overlap="add", background=(0.5,))
    assert np.abs(added - (0.5 + 0.5 * image)).max() < 1e-6
    wavelet = prefilter.rasterize([shape], SIDE, SIDE, method="wavelet")
    assert np.abs(wavelet - image).max() < 1e-6
    coarse = prefilter.rasterize([shape], SIDE, SIDE, method="wavelet", depth=2)
    assert np.abs(coarse[:4, :4] - image[:4, :4].mean()).max() < 1e-6


def test_can_be_canceled():
    random = np.random.default_rng(5)
    shape = shape_of([random.uniform(0, 512, (3000, 2))])
    with pytest.raises(prefilter.Cancelled):
        prefilter.rasterize([shape], 512, 512, progress=lambda fraction: fraction < 0.5)
