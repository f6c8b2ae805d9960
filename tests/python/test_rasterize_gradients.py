# SPDX-License-Identifier: GPL-3.0-or-later

"""Gradients against quadrature of their colors over the true shape."""

import numpy as np
import prefilter
import pytest
from outlines import Rows, blob, image_of_colors, mapped, polygon, to_shape

WIDTH, HEIGHT = 9, 8
SHAPE = blob(3, 3, (2.1, 1.4), (6.6, 5.7), count=3)
STOPS = [(0.1, 0.2), (0.45, 0.9), (0.45, 0.5), (0.8, 0.1)]  # with a discontinuity
TURN = np.array([(0.8, -0.5, 2.0), (0.4, 1.1, -1.0)])


def spread_offset(offset, spread):
    if spread == "repeat":
        return offset - np.floor(offset)
    if spread == "reflect":
        return 1.0 - np.abs(1.0 - np.mod(offset, 2.0))
    return np.clip(offset, 0.0, 1.0)


def color_at(offset, spread):
    offset = spread_offset(offset, spread)
    # Both sides of the discontinuity become stops, slightly apart.
    places = [place + 1e-12 * k for k, (place, _) in enumerate(STOPS)]
    return np.interp(offset, places, [value for _, value in STOPS])


def seams(spread):
    """Offsets within a small shape at which colors are not smooth."""
    places = {place for place, _ in STOPS} | {0.0, 1.0}
    if spread == "pad":
        return sorted(places)
    result = {place + k for place in places for k in (-1, 0, 1)}
    if spread == "reflect":
        result = places | {2 - place for place in places} | {-place for place in places}
    return sorted(place for place in result if -0.7 <= place <= 1.7)


def set_stops(shape, kind, *arguments, **options):
    getattr(shape, kind)(*arguments, [(place, (value,)) for place, value in STOPS], **options)


def drawn(shape, name):
    return prefilter.rasterize([shape], WIDTH, HEIGHT, filter=name)[..., 0]


def inverse(matrix):
    return np.linalg.inv(np.vstack([matrix, (0, 0, 1)]))[:2]


@pytest.mark.parametrize(
    ("spread", "transform"), [("pad", TURN), ("repeat", None), ("reflect", TURN)]
)
def test_linear_gradients(spread, transform):
    start, end = np.array([2.3, 1.9]), np.array([5.9, 4.2])
    matrix = np.eye(2, 3) if transform is None else transform
    axis = (end - start) / ((end - start) @ (end - start))
    across = np.array([-axis[1], axis[0]]) * 100
    along = end - start
    bands = [
        mapped(
            [polygon([p - across, p - across + 99 * along, p + across + 99 * along, p + across])],
            matrix,
        )[0]
        for p in (start + s * along for s in seams(spread))
    ]
    back = inverse(matrix)

    def color(x, y):
        u = back[0, 0] * x + back[0, 1] * y + back[0, 2] - start[0]
        v = back[1, 0] * x + back[1, 1] * y + back[1, 2] - start[1]
        return color_at(u * axis[0] + v * axis[1], spread)

    shape = to_shape([SHAPE])
    set_stops(shape, "linear_gradient", start, end, spread=spread, transform=transform)
    rows = Rows([SHAPE, *bands], WIDTH, HEIGHT, 10)
    for name, bar in (("box", 1e-6), ("mitchell", 1e-5)):
        expected = image_of_colors(rows, WIDTH, HEIGHT, name, rows.winding[0] != 0, color)
        assert np.abs(drawn(shape, name) - expected).max() < bar, name


def test_radial_gradients_where_they_are_smooth():
    center, radius = np.array([31.0, -20.0]), 60.0

    def color(x, y):
        return 0.2 + 0.7 * np.hypot(x - center[0], y - center[1]) / radius

    shape = to_shape([SHAPE])
    shape.radial_gradient(center, radius, [(0.0, (0.2,)), (1.0, (0.9,))])
    rows = Rows([SHAPE], WIDTH, HEIGHT)
    for name in ("box", "mitchell"):
        expected = image_of_colors(rows, WIDTH, HEIGHT, name, rows.inside(), color)
        assert np.abs(drawn(shape, name) - expected).max() < 1e-6, name


@pytest.mark.parametrize("spread", ["pad", "repeat"])
@pytest.mark.parametrize("transform", [None, (0.9, -0.4), (0.05, 0.3)])
def test_radial_gradients_against_dense_points(spread, transform):
    """Circles and ellipses, near the center and far from it."""
    center, first, radius = np.array([20.3, 17.8]), 4.0, 21.0
    matrix = np.eye(2, 3)
    if transform is not None:
        matrix[:, :2] = [(1.0, transform[1]), (transform[0] - 1.0, 1.0)]
        matrix[:, 2] = center - matrix[:, :2] @ center
    stops = [(0.0, (0.1, 0.9)), (0.3, (0.8, 0.2)), (1.0, (0.4, 0.6))]
    shape = prefilter.Shape()
    shape.add_polygon([(0, 0), (40, 0), (40, 36), (0, 36)])
    shape.radial_gradient(
        center, radius, stops, focus=center, focus_radius=first, spread=spread, transform=matrix
    )
    actual = prefilter.rasterize([shape], 40, 36)
    finer = 24
    x = (np.arange(40 * finer) + 0.5) / finer
    y = (np.arange(36 * finer) + 0.5) / finer
    points = np.stack(np.meshgrid(x, y), -1) @ inverse(matrix)[:, :2].T + inverse(matrix)[:, 2]
    offset = (np.linalg.norm(points - center, axis=-1) - first) / (radius - first)
    offset = spread_offset(offset, spread)
    for channel in range(2):
        values = np.interp(offset, [s[0] for s in stops], [s[1][channel] for s in stops])
        expected = values.reshape(36, finer, 40, finer).mean((1, 3))
        off = np.abs(actual[..., channel] - expected)
        assert np.median(off) < 2e-5
        # Pixels with a bend or jump of the color.
        assert off.max() < (0.005 if spread == "pad" else 0.08)
