# SPDX-License-Identifier: GPL-3.0-or-later

"""The margin of a UV map's mask, against the share of each pixel within it of a chart."""

from dataclasses import replace

import numpy as np
import prefilter
import pytest
from prefilter.options.shapes import RasterizeSettings
from prefilter.workflows.shapes.layers import uv_layers

SIDE = 32
FINE = 16  # Places along a side of a pixel at which the distance is known.
CHART = np.array([[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.5, 0.45], [0.3, 0.7]])


def mask(polygons, margin, **changes):
    settings = replace(RasterizeSettings(), width=SIDE, height=SIDE, uv_margin=margin, **changes)
    drawn = uv_layers("map", polygons, settings).drawn(settings, lambda fraction: True)
    assert drawn.color == (1.0, 1.0, 1.0, 1.0)
    return prefilter.rasterize(drawn.shapes, drawn.width, drawn.height)[..., 0]


def distances(polygon):
    """Distance from each position to the polygon, in pixels; 0 inside of it."""
    at = (np.arange(SIDE * FINE) + 0.5) / FINE
    x, y = np.meshgrid(at, at)
    corners = polygon * SIDE
    nearest = np.full(x.shape, np.inf)
    inside = np.zeros(x.shape, bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        dx, dy = bx - ax, by - ay
        along = (((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)).clip(0, 1)
        nearest = np.minimum(nearest, np.hypot(x - ax - along * dx, y - ay - along * dy))
        if dy != 0:
            crosses = (ay > y) != (by > y)
            inside ^= crosses & (x < ax + (y - ay) * dx / dy)
    return np.where(inside, 0.0, nearest)


@pytest.mark.parametrize("margin", [0.0, 0.5, 2.0, 5.3])
def test_charts_reach_as_far_as_the_margin(margin):
    near = distances(CHART) <= margin
    share = near.reshape(SIDE, FINE, SIDE, FINE).mean(axis=(1, 3))
    found = mask([CHART], margin)
    np.testing.assert_allclose(found, share, rtol=0, atol=0.03)
    # The total area of a convex chart with its margin, by Steiner's formula.
    square = np.array([[0.3, 0.4], [0.6, 0.4], [0.6, 0.7], [0.3, 0.7]])
    side = 0.3 * SIDE
    whole = side * side + 4 * side * margin + np.pi * margin**2
    np.testing.assert_allclose(mask([square], margin).sum(), whole, rtol=1e-5)


def test_margins_that_meet_count_once():
    halves = [
        np.array([[0.2, 0.2], [0.5, 0.2], [0.5, 0.8], [0.2, 0.8]]),
        np.array([[0.55, 0.2], [0.8, 0.2], [0.8, 0.8], [0.55, 0.8]]),
    ]
    found = mask(halves, 3.0)
    assert found.max() <= 1.0 + 1e-6
    np.testing.assert_allclose(found[10:22, 8:26], 1.0, atol=1e-5)


def test_a_margin_comes_in_from_the_tile_beside():
    beside = np.array([[1.01, 0.2], [1.5, 0.2], [1.5, 0.8], [1.01, 0.8]])
    assert not mask([beside], 0.0).any()
    assert mask([beside], 2.0)[16, -1] == 1.0
    np.testing.assert_allclose(mask([beside], 2.0, tile=1002)[16, :16], 1.0, atol=1e-6)
