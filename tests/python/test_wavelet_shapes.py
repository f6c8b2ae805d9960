# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes by method="wavelet": required agreement with "scanline", and allowed differences."""

import itertools

import numpy as np
import prefilter
import pytest
from prefilter import Shape, rasterize

SIZES = [(1, 1), (3, 9), (64, 64), (100, 37), (40, 300)]


def _curves(random: np.random.Generator, width: int, height: int, reach: float) -> Shape:
    low, step = 0.5 - 0.5 * reach, np.array([width, height]) * reach
    points = iter(low * np.array([width, height]) + random.random((40, 2)) * step)
    shape = Shape(fill_rule="evenodd")
    shape.move_to(*next(points))
    for degree in (1, 2, 3, 5):
        shape.curve_to(*itertools.islice(points, degree))
    shape.conic_to(*next(points), 0.7, *next(points))
    shape.close()
    return shape


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("reach", [0.4, 1.0, 3.0, 1e4])
def test_closed_shapes_are_those_of_the_other_method(size: tuple[int, int], reach: float) -> None:
    random = np.random.default_rng(7)
    for _ in range(3):
        shape = _curves(random, *size, reach)
        expected = rasterize([shape], *size)
        np.testing.assert_allclose(rasterize([shape], *size, method="wavelet"), expected, atol=1e-6)


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_colors_add_up_before_a_background(channels: int) -> None:
    random = np.random.default_rng(8)
    shapes = []
    for _ in range(12):
        shape = Shape(color=random.random(channels))
        shape.add_polygon(random.random((5, 2)) * (90, 50))
        shapes.append(shape)
    behind = random.random(channels)
    for count, background in itertools.product((1, 12), (None, behind)):
        images = [
            rasterize(shapes[:count], 90, 50, method=method, background=background, overlap="add")
            for method in ("scanline", "wavelet")
        ]
        np.testing.assert_allclose(*images, atol=2e-6)


def test_shapes_cover_each_other() -> None:
    random = np.random.default_rng(12)
    shapes = [_curves(random, 60, 60, 1.0) for _ in range(4)]
    for index, shape in enumerate(shapes):
        alpha = (1.0, 0.4)[index % 2]
        shape.color = (*(alpha * random.random(3)), alpha)
    images = [
        rasterize(shapes, 60, 60, method=method, overlap="cover", background=(0.1, 0.2, 0.3, 1.0))
        for method in ("scanline", "wavelet")
    ]
    np.testing.assert_allclose(*images, atol=2e-6)


@pytest.mark.parametrize("size", SIZES)
def test_every_depth_is_the_mean_over_its_cells(size: tuple[int, int]) -> None:
    width, height = size
    shape = Shape()
    shape.add_polygon(np.random.default_rng(9).random((7, 2)) * (2 * width, 2 * height))
    deepest = (max(size) - 1).bit_length()
    for depth in range(deepest + 1):
        side = 2 ** (deepest - depth)
        small = shape.transformed([[1 / side, 0, 0], [0, 1 / side, 0]])
        means = rasterize([small], -(-width // side), -(-height // side))
        expected = means.repeat(side, 0).repeat(side, 1)[:height, :width]
        found = rasterize([shape], width, height, method="wavelet", depth=depth)
        np.testing.assert_allclose(found, expected, atol=1e-6)
    whole = rasterize([shape], width, height, method="wavelet")
    assert np.array_equal(whole, rasterize([shape], width, height, method="wavelet", depth=deepest))


def test_shapes_that_share_edges_have_no_seam() -> None:
    shapes = []
    for i, j in itertools.product(range(8), range(8)):
        corners = np.array([(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]) * 12.37 - 1.0
        shape = Shape()
        shape.add_polygon(corners @ np.array([[1.0, 0.1], [-0.1, 1.0]]) + (9.0, -6.0))
        shapes.append(shape)
    image = rasterize(shapes, 90, 90, method="wavelet", overlap="add")
    assert np.array_equal(image[20:70, 20:70], np.ones((50, 50, 1), np.float32))


def test_threads_change_no_bit() -> None:
    random = np.random.default_rng(10)
    shapes = [_curves(random, 700, 600, 1.2) for _ in range(3)]
    shapes[1].color = (0.3,)
    one, *others = (
        rasterize(shapes, 700, 600, method="wavelet", overlap="add", threads=threads)
        for threads in (1, 2, 5)
    )
    for other in others:
        assert np.array_equal(one, other)


def test_gaps_stay_open() -> None:
    size = 128
    angles = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    circle = np.stack([64 + 50 * np.cos(angles), 64 + 50 * np.sin(angles)], -1)
    closed, gap = Shape(), Shape(fill_rule="evenodd")
    closed.add_polygon(circle)
    for points in (circle[:41], circle[50:91]):
        gap.move_to(*points[0])
        for point in points[1:]:
            gap.line_to(*point)
    full = rasterize([closed], size, size)
    off = np.abs(rasterize([gap], size, size, method="wavelet") - full)[..., 0]
    x, y = np.meshgrid(np.arange(size) + 0.5, np.arange(size) + 0.5)
    bound = np.zeros((size, size))
    for begin, end in ((40, 50), (90, 100)):
        places = circle[[i % 100 for i in range(begin, end + 1)]]
        distance = np.hypot(x[..., None] - places[:, 0], y[..., None] - places[:, 1]).min(-1)
        length = np.linalg.norm(places[-1] - places[0])
        bound += 3.1 * length / np.maximum(distance - 4, 1e-3) + length / size
    # What fills the gap is an arc, a little longer than its chord.
    assert (off <= 1.05 * bound).all()
    assert off[64, 64] < 0.2 < off.max()


def test_windings_of_open_shapes_are_drawn() -> None:
    shape = Shape(fill_rule="evenodd")
    for _ in range(40):
        shape.add_polygon(np.array([(2.0, 2.0), (30.0, 2.0), (30.0, 30.0), (2.0, 30.0)]))
    shape.move_to(40.0, 40.0)
    shape.line_to(40.0, 40.5)
    image = rasterize([shape], 64, 64, method="wavelet")
    np.testing.assert_allclose(image[2:30, 2:30], 40.0, atol=1e-2)
    assert rasterize([shape], 64, 64).max() == 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"filter": "tent"}, "filter: 'tent'; the method wavelet supports only box"),
        ({"depth": 8}, "depth: found 8; an image of 100 x 30 pixels has depths from 0 to 7"),
        ({"depth": -1}, "depth: -1; a whole number of at least 0 is needed, or None"),
        ({"depth": 2.0}, "depth: 2.0; a whole number of at least 0 is needed, or None"),
        ({"depth": 2, "method": "scanline"}, "depth: found 2; only the method wavelet has depths"),
    ],
)
def test_options_of_the_other_method_are_refused(arguments: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        rasterize([Shape()], 100, 30, **{"method": "wavelet", **arguments})


def test_gradients_are_refused() -> None:
    shape = Shape()
    shape.gradient((0.0,), (0.1,), (0.0,))
    with pytest.raises(ValueError, match="shapes: shape 0 has a gradient"):
        rasterize([shape], 8, 8, method="wavelet")


def test_it_can_be_cancelled() -> None:
    shapes = [_curves(np.random.default_rng(11), 400, 400, 1.0) for _ in range(300)]
    calls: list[float] = []

    def stop(fraction: float) -> bool:
        calls.append(fraction)
        return len(calls) < 2

    with pytest.raises(prefilter.Cancelled):
        rasterize(shapes, 400, 400, method="wavelet", overlap="add", progress=stop)
