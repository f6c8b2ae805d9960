# SPDX-License-Identifier: GPL-3.0-or-later

"""Random scenes of overlapping gradients: in range, and equal to point samples."""

import numpy as np
import prefilter
import pytest

SIDE = 8


def random_color(random):
    alpha = random.choice([1.0, 0.5, random.random()])
    return (*(random.random(3) * alpha).tolist(), float(alpha))


def random_stops(random):
    offsets = np.sort(random.random(random.integers(2, 5)))
    if random.random() < 0.5:
        offsets[[0, -1]] = 0.0, 1.0
    if random.random() < 0.5:
        doubled = random.integers(0, len(offsets) - 1)
        offsets[doubled + 1] = offsets[doubled]
    return [(float(offset), random_color(random)) for offset in offsets]


def random_polygon(random):
    if random.random() < 0.5:
        left, right = np.sort(random.choice(2 * SIDE + 1, 2, replace=False)) / 2.0
        low, high = np.sort(random.choice(2 * SIDE + 1, 2, replace=False)) / 2.0
        return np.array([[left, low], [right, low], [right, high], [left, high]])
    return random.uniform(0.0, SIDE, (random.integers(3, 6), 2))


class Scene:
    """Shapes, and the color of each of them at points."""

    def __init__(self, seed, kinds, spreads):
        random = np.random.default_rng(seed)
        self.shapes, self.layers = [], []
        for _ in range(random.integers(2, 5)):
            points = random_polygon(random)
            shape = prefilter.Shape(color=(0.0, 0.0, 0.0, 1.0))
            shape.add_polygon(points)
            kind = str(random.choice(kinds))
            if kind == "color":
                shape.color = random_color(random)
                paint = (kind, shape.color)
            else:
                stops, spread = random_stops(random), str(random.choice(spreads))
                start, end = random.uniform(0.0, SIDE, (2, 2))
                radius = float(random.uniform(1.0, SIDE))
                if kind == "linear":
                    shape.linear_gradient(tuple(start), tuple(end), stops, spread=spread)
                else:
                    shape.radial_gradient(tuple(start), radius, stops, spread=spread)
                paint = (kind, stops, spread, start, end, radius)
            self.shapes.append(shape)
            self.layers.append((points, paint))

    def means(self, count):
        """Means over pixels, of this many points per side."""
        at = (np.arange(SIDE * count) + 0.5) / count
        x, y = np.meshgrid(at, at)
        sum_ = np.zeros((*x.shape, 4))
        for points, paint in self.layers:
            color = colors_at(paint, x, y)
            over = color + (1.0 - color[..., 3:]) * sum_
            sum_ = np.where(inside(points, x, y)[..., None], over, sum_)
        return sum_.reshape(SIDE, count, SIDE, count, 4).mean(axis=(1, 3))


def inside(points, x, y):
    winding = np.zeros(x.shape, int)
    for (ax, ay), (bx, by) in zip(points, np.roll(points, -1, 0), strict=True):
        if ay != by:
            passes = (y >= min(ay, by)) & (y < max(ay, by))
            at = ax + (y - ay) / (by - ay) * (bx - ax)
            winding += np.where(passes & (at > x), 1 if by > ay else -1, 0)
    return winding != 0


def colors_at(paint, x, y):
    if paint[0] == "color":
        return np.broadcast_to(np.array(paint[1]), (*x.shape, 4))
    kind, stops, spread, start, end, radius = paint
    if kind == "linear":
        way = end - start
        t = ((x - start[0]) * way[0] + (y - start[1]) * way[1]) / (way @ way)
    else:
        t = np.hypot(x - start[0], y - start[1]) / radius
    if spread == "repeat":
        t = t - np.floor(t)
    elif spread == "reflect":
        t = 1.0 - np.abs(t - 2.0 * np.floor(0.5 * t) - 1.0)
    offsets = np.array([offset for offset, _ in stops])
    values = np.array([value for _, value in stops])
    index = np.clip(np.searchsorted(offsets, t, side="right") - 1, 0, len(stops) - 1)
    after = np.minimum(index + 1, len(stops) - 1)
    width = offsets[after] - offsets[index]
    share = np.where(width > 0.0, (t - offsets[index]) / np.where(width > 0.0, width, 1.0), 0.0)
    share = np.where(t < offsets[0], 0.0, share)[..., None]
    return (1.0 - share) * values[index] + share * values[after]


@pytest.mark.parametrize("filter_", ["box", "tent"])
def test_values_are_in_range(filter_):
    """A pixel is a mean of the shapes' colors at points, so it lies in their range."""
    for seed in range(2000 if filter_ == "box" else 200):
        shapes = Scene(seed, ("color", "linear", "radial"), ("pad", "repeat", "reflect")).shapes
        found = prefilter.rasterize(shapes, SIDE, SIDE, filter=filter_, threads=1)
        assert found.min() >= -1e-6, seed
        assert found.max() <= 1.0 + 1e-6, seed
        assert (found[..., :3] <= found[..., 3:] + 1e-6).all(), seed


def test_linear_scenes_are_what_points_show():
    for seed in range(40):
        scene = Scene(seed, ("color", "linear"), ("pad",))
        found = prefilter.rasterize(scene.shapes, SIDE, SIDE, threads=1)
        np.testing.assert_allclose(found, scene.means(96), atol=2.0 / 255.0, err_msg=str(seed))


def test_radial_scenes_are_what_points_show():
    for seed in range(1000, 1025):
        scene = Scene(seed, ("color", "linear", "radial"), ("pad", "repeat", "reflect"))
        found = prefilter.rasterize(scene.shapes, SIDE, SIDE, threads=1)
        np.testing.assert_allclose(found, scene.means(96), atol=4.0 / 255.0, err_msg=str(seed))


def test_hard_stops_of_a_radial_gradient():
    """A disc of radius 3: its area is in closed form, and all of it is white."""
    shape = prefilter.Shape(color=(0.0, 0.0, 0.0, 1.0))
    shape.add_polygon([(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)])
    white, nothing = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 0.0)
    shape.radial_gradient((4.0, 4.0), 3.0, [(0.0, white), (1.0, white), (1.0, nothing)])
    for overlap in ("cover", "add"):
        found = prefilter.rasterize([shape], SIDE, SIDE, overlap=overlap)
        assert found[..., 3].sum() == pytest.approx(np.pi * 9.0, abs=1e-4)


@pytest.mark.parametrize("filter_", ["box", "tent"])
def test_a_doubled_stop_over_another_shape(filter_):
    """Two stops at 0: the first counts only before them, where the shape has a corner alone."""

    def box(left, low, right, high, color):
        shape = prefilter.Shape(color=color)
        shape.add_polygon([(left, low), (right, low), (right, high), (left, high)])
        return shape

    back = box(1.0, 0.5, 4.0, 7.5, (0.0, 0.0, 1.0, 1.0))
    front = box(2.0, 1.0, 3.0, 7.0, (1.0, 1.0, 1.0, 1.0))
    stops = [(0.0, (1.0,) * 4), (0.0, (0.2,) * 4), (1.0, (0.1,) * 4)]
    front.linear_gradient((0.0, 2.0), (0.0, 7.0), stops)
    found = prefilter.rasterize([back, front], SIDE, SIDE, filter=filter_)
    assert found.max() <= 1.0 + 1e-6
    if filter_ == "box":
        np.testing.assert_allclose(found[2:6, 2, 3], 1.0, atol=1e-6)
        # White over blue at the row below the stops; then 0.2 to 0.1 of white.
        np.testing.assert_allclose(found[1, 2], [1.0, 1.0, 1.0, 1.0], atol=1e-6)
        shares = 0.2 - 0.1 * (np.arange(4) + 0.5) / 5.0
        np.testing.assert_allclose(found[2:6, 2, 0], shares, atol=1e-6)


def test_a_gradient_that_is_nothing_outside_of_a_cone():
    """Both circles of radius 1: the strip between two lines, 2 pixels wide."""
    shape = prefilter.Shape(color=(0.0, 0.0, 0.0, 1.0))
    shape.add_polygon([(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)])
    white = (1.0, 1.0, 1.0, 1.0)
    turn = np.radians(20.0)
    end = (4.0 + np.cos(turn), 4.0 + np.sin(turn))
    shape.radial_gradient(
        end, 1.0, [(0.0, white), (1.0, white)], focus=(4.0, 4.0), focus_radius=1.0
    )
    found = prefilter.rasterize([shape], SIDE, SIDE)[..., 3]
    at = (np.arange(SIDE * 96) + 0.5) / 96
    x, y = np.meshgrid(at, at)
    across = np.abs((y - 4.0) * np.cos(turn) - (x - 4.0) * np.sin(turn))
    expected = (across <= 1.0).reshape(SIDE, 96, SIDE, 96).mean(axis=(1, 3))
    np.testing.assert_allclose(found, expected, atol=1.0 / 255.0)


@pytest.mark.parametrize("filter_", ["box", "tent"])
@pytest.mark.parametrize("period", [0.13, 0.5, 1.7, 3.5])
def test_fine_rings_are_what_points_show(filter_, period):
    """A triangle of them over gray, one of its sides across pixels."""
    center, count = np.array([3.3, 3.8]), 96
    stops = [(0.0, (0.0, 0.0, 0.0, 1.0)), (0.5, (0.5, 0.0, 0.0, 0.5)), (1.0, (1.0,) * 4)]
    points = np.array([[0.0, 0.0], [SIDE, 0.0], [0.0, 0.9 * SIDE]])
    scene = Scene(0, ("color",), ("pad",))
    square = np.array([[0.0, 0.0], [SIDE, 0.0], [SIDE, SIDE], [0.0, SIDE]])
    gray = (0.5, 0.5, 0.5, 1.0)
    scene.layers = [
        (square, ("color", gray)),
        (points, ("radial", stops, "repeat", center, None, period)),
    ]
    back, front = prefilter.Shape(color=gray), prefilter.Shape(color=gray)
    back.add_polygon(square)
    front.add_polygon(points)
    front.radial_gradient(tuple(center), period, stops, spread="repeat")
    found = prefilter.rasterize([back, front], SIDE, SIDE, filter=filter_, threads=1)
    assert found.min() >= -1e-6
    assert found.max() <= 1.0 + 1e-6
    if filter_ == "box":
        np.testing.assert_allclose(found, scene.means(count), atol=4.0 / 255.0)
    else:
        # The tent over two pixels, by points.
        at = (np.arange(SIDE * count) + 0.5) / count
        x, y = np.meshgrid(at, at)
        color = colors_at(scene.layers[1][1], x, y)
        over = color + (1.0 - color[..., 3:]) * np.array(gray)
        value = np.where(inside(points, x, y)[..., None], over, np.array(gray))
        weights = np.maximum(1.0 - np.abs(at[None] - np.arange(1, SIDE - 1)[:, None] - 0.5), 0.0)
        weights /= weights.sum(axis=1, keepdims=True)
        expected = np.einsum("ai,bj,ijc->abc", weights, weights, value)
        np.testing.assert_allclose(found[1:-1, 1:-1], expected, atol=4.0 / 255.0)
