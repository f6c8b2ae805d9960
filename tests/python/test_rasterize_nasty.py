# SPDX-License-Identifier: GPL-3.0-or-later

"""Empty and enormous shapes: no input takes long, crashes or changes other pixels."""

import copy
import time

import numpy as np
import prefilter
import pytest
from outlines import blob, circle, mapped, polygon, to_shape

FILTERS = prefilter.RASTER_FILTERS
SOON = 2.0  # CPU seconds; pathological cases would take minutes
LIMIT = 1e9


def image_of(*shapes, width=6, height=5, filter="box", overlap="add", **options):
    begin = time.process_time()
    image = prefilter.rasterize(shapes, width, height, filter=filter, overlap=overlap, **options)
    assert time.process_time() - begin < SOON
    assert np.isfinite(image).all()
    assert image.shape[:2] == (height, width)
    return image[..., 0]


def path(*steps, **options):
    """Makes a shape from names of methods and their arguments."""
    shape = prefilter.Shape(**options)
    for name, *arguments in steps:
        getattr(shape, name)(*arguments)
    return shape


def of_points(points, **options):
    shape = prefilter.Shape(**options)
    shape.add_polygon(np.asarray(points, float))
    return shape


NOTHING = {
    "no contour": path(),
    "closed before it began": path(("close",)),
    "a move": path(("move_to", 1.3, 1.2)),
    "moves": path(*[("move_to", 0.7 * k, 0.4 * k) for k in range(5)]),
    "a point": path(("move_to", 1.3, 1.2), ("close",)),
    "a line to itself": path(("move_to", 1.3, 1.2), ("line_to", 1.3, 1.2), ("close",)),
    "one corner": of_points([(1.3, 1.2)]),
    "two corners": of_points([(1.3, 1.2), (4.1, 3.7)]),
    "an open line": path(("move_to", 1.3, 1.2), ("line_to", 4.1, 3.7)),
    "there and back": of_points([(1.3, 1.2), (4.1, 3.7), (2.7, 0.3), (4.1, 3.7)]),
    "corners in a row": of_points([(0.5, 0.5), (4.5, 4.5), (2.5, 2.5), (3.5, 3.5)]),
    "level": of_points([(0.5, 2.0), (4.5, 2.0), (2.5, 2.0)]),
    "upright": of_points([(2.0, 0.5), (2.0, 4.5), (2.0, 1.5)]),
    "a curve on a point": path(("move_to", 2, 2), ("curve_to", 2, 2, 2, 2, 2, 2)),
    "a curve there and back": path(("move_to", 1, 1), ("curve_to", 5, 4, 5, 4, 1, 1), ("close",)),
    "a flat curve": path(("move_to", 1, 1), ("curve_to", 2, 2, 5, 5, 3, 3), ("close",)),
    "a conic on a point": path(("move_to", 2, 2), ("conic_to", 2, 2, 0.5, 2, 2)),
    "a flat conic": path(("move_to", 1, 1), ("conic_to", 2, 2, 7.0, 3, 3), ("close",)),
    "a conic there and back": path(("move_to", 1, 1), ("conic_to", 4, 3, 1e6, 1, 1)),
    "a conic beyond its ends": path(("move_to", 1, 1), ("conic_to", 5, 5, 3.0, 2, 2)),
    "degree 60 on a point": path(("move_to", 2, 2), ("curve_to", *[2.0] * 120)),
    "degree 9 on a line": path(("move_to", 0, 2), ("curve_to", *[(k % 7, 2) for k in range(9)])),
    "right of the image": of_points([(10, 1), (12, 1), (12, 9), (10, 9)]),
    "left of it": of_points([(-12, -1), (-10, 1), (-12, 9)]),
    "above it": of_points([(1, 10), (4, 12), (2, 90)]),
    "below it": of_points([(1, -10), (4, -12), (2, -90)]),
    "far away": of_points([(1e9, 1e9), (-1e9, 1e9), (1e9, 1e9 - 1)]),
}


@pytest.mark.parametrize("shape", NOTHING.values(), ids=NOTHING)
def test_shapes_without_area_are_empty(shape):
    square = of_points([(1, 1), (4, 1), (4, 4), (1, 4)])
    for filter in ("box", "mitchell", "radial2"):
        assert np.abs(image_of(shape, filter=filter)).max() == 0.0
        with_it = image_of(square, shape, filter=filter)
        assert np.abs(with_it - image_of(square, filter=filter)).max() == 0.0


def test_no_shapes():
    for shapes in ([], (), iter([])):
        image = prefilter.rasterize(shapes, 3, 2)
        assert image.shape == (2, 3, 1)
        assert (image == 0.0).all()


def test_bounds():
    assert prefilter.Shape().bounds is None
    assert NOTHING["a move"].bounds in (None, ((1.3, 1.2), (1.3, 1.2)))
    assert of_points([(1, 2), (3, -4), (0, 7)]).bounds == ((0.0, -4.0), (3.0, 7.0))


def test_open_contours_are_closed_by_lines():
    corners = [(0.7, 0.6), (5.2, 1.1), (4.6, 4.4)]
    opened = path(("move_to", *corners[0]), *[("line_to", *corner) for corner in corners[1:]])
    for filter in FILTERS:
        assert (
            image_of(opened, filter=filter) == image_of(of_points(corners), filter=filter)
        ).all()
    # The same with another move, and with curves.
    both = path(
        *[("move_to", 0.7, 0.6), ("curve_to", 5.2, 1.1, 4.6, 4.4)],
        *[("move_to", 0.3, 3.1), ("curve_to", 0.4, 4.9, 1.9, 4.6, 1.2, 3.0)],
    )
    closed = path(
        *[("move_to", 0.7, 0.6), ("curve_to", 5.2, 1.1, 4.6, 4.4), ("line_to", 0.7, 0.6)],
        *[("move_to", 0.3, 3.1), ("curve_to", 0.4, 4.9, 1.9, 4.6, 1.2, 3.0), ("close",)],
    )
    assert (image_of(both) == image_of(closed)).all()


def test_segments_after_close_start_at_the_contours_start():
    actual = path(
        *[("move_to", 1, 1), ("line_to", 5, 1), ("line_to", 5, 2), ("close",)],
        *[("line_to", 1, 4), ("line_to", 2, 4)],
    )
    expected = prefilter.Shape()
    expected.add_polygon([(1.0, 1.0), (5, 1), (5, 2)])
    expected.add_polygon([(1.0, 1.0), (1, 4), (2, 4)])
    assert (image_of(actual) == image_of(expected)).all()


@pytest.mark.parametrize("filter", FILTERS)
def test_images_of_one_row_column_or_pixel(filter):
    shape = to_shape([circle((2.3, 2.6), 2.2), circle((2000.5, 0.3), 900.0)])
    whole = prefilter.rasterize([shape], 5000, 5, filter=filter)
    begin = time.process_time()
    assert (prefilter.rasterize([shape], 5000, 1, filter=filter) == whole[:1]).all()
    assert (prefilter.rasterize([shape], 1, 1, filter=filter) == whole[:1, :1]).all()
    turned = to_shape(
        mapped([circle((2.3, 2.6), 2.2), circle((2000.5, 0.3), 900.0)], [(0, 1, 0), (1, 0, 0)])
    )
    column = prefilter.rasterize([turned], 1, 5000, filter=filter)
    assert time.process_time() - begin < SOON
    assert np.abs(column[:, 0] - whole[0]).max() < 1e-6


@pytest.mark.parametrize("filter", FILTERS)
def test_coordinates_up_to_the_limit(filter):
    """Long edges across the image are exact; shapes far to the right have no effect."""
    ends = [(2.5, -LIMIT), (2.5, LIMIT)]
    half = of_points([*ends, (-LIMIT, LIMIT), (-LIMIT, -LIMIT)])
    near = of_points([(2.5, -50), (2.5, 50), (-50, 50), (-50, -50)])
    actual, expected = image_of(half, filter=filter), image_of(near, filter=filter)
    assert np.abs(actual - expected).max() < 5e-7
    away = of_points([(LIMIT, -LIMIT), (LIMIT, LIMIT), (LIMIT - 1, 0)])
    assert (image_of(away, filter=filter) == 0.0).all()
    # Through the middle of the image, as exact as rounding at 1e9 allows.
    diagonal = of_points([(-LIMIT, -LIMIT), (LIMIT, LIMIT), (-LIMIT, LIMIT)])
    image = image_of(diagonal, width=5, filter=filter)
    expected = image_of(of_points([(-50, -50), (50, 50), (-50, 50)]), width=5, filter=filter)
    assert np.abs(image - expected).max() < 1e-5


@pytest.mark.parametrize("filter", FILTERS)
def test_large_curves_around_the_image(filter):
    curve = path(
        ("move_to", -LIMIT, -LIMIT),
        ("curve_to", LIMIT, -LIMIT, LIMIT, -LIMIT, LIMIT, 7.0),
        ("conic_to", LIMIT, LIMIT, 1e6, 0, LIMIT),
        ("conic_to", -LIMIT, LIMIT, 1e-6, -LIMIT, 0),
    )
    image = image_of(curve, filter=filter)
    assert (image == 1.0).all() or (image == 0.0).all()


def on_grid_lines():
    """Corners at integers, some slightly off."""
    for shift in (0.0, 1e-13, -1e-13, 1e-17):
        square = np.array([(1, 1), (4, 1), (4, 3), (1, 3)]) + shift
        yield square
        yield np.array([(1, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3)]) + shift
    yield np.array([(0, 0), (6, 0), (6, 5), (0, 5)])


@pytest.mark.parametrize("filter", FILTERS)
def test_outlines_along_grid_lines(filter):
    for corners in on_grid_lines():
        actual = image_of(of_points(corners), filter=filter)
        # The same at integers, as rectangles one row high.
        whole = np.rint(corners)
        expected = image_of(of_points(whole), filter=filter)
        assert np.abs(actual - expected).max() < 1e-6
        if filter == "box":
            y, x = np.indices((5, 6)) + 0.5
            inside = (x > whole[:, 0].min()) & (x < whole[:, 0].max())
            inside &= (y > whole[:, 1].min()) & (y < whole[:, 1].max())
            if len(whole) == 6:
                inside &= ~((x > 2) & (y > 2))
            assert (expected == inside).all()


def test_curves_along_grid_lines():
    """Degrees 2 and 3, along a line or back and forth on it."""
    for bend in (2.0, 9.0, -4.0):
        shape = path(
            ("move_to", 1, 1),
            ("curve_to", bend, 1, 4, 1),
            ("curve_to", 4, bend, 4, -bend, 4, 3),
            ("conic_to", bend, 3, 2.0, 1, 3),
            ("close",),
        )
        for filter in FILTERS:
            expected = image_of(of_points([(1, 1), (4, 1), (4, 3), (1, 3)]), filter=filter)
            assert np.abs(image_of(shape, filter=filter) - expected).max() < 1e-6, bend


def test_vertices_on_corners_of_the_grid():
    """A line through corners of pixels halves each pixel."""
    image = image_of(of_points([(0, 0), (5, 5), (0, 5)]), width=5)
    assert (image == np.where(np.eye(5), 0.5, np.tri(5))).all()
    diamond = image_of(of_points([(3, 0), (5, 2), (3, 4), (1, 2)]))
    assert diamond.sum() == 8.0
    assert set(np.unique(diamond)) == {0.0, 0.5, 1.0}


@pytest.mark.parametrize("count", [2, 33, 200])
def test_repeated_contours(count):
    """One shape: filled once, or by parity. Many shapes: added."""
    contour = polygon([(0.7, 0.6), (5.2, 1.1), (4.6, 4.4)])
    once = image_of(to_shape([contour]))
    assert np.abs(image_of(to_shape([contour] * count)) - once).max() < 1e-6
    parity = image_of(to_shape([contour] * count, fill_rule="evenodd"))
    assert np.abs(parity - once * (count % 2)).max() < 1e-6
    many = image_of(*[to_shape([contour])] * count)
    assert np.abs(many - count * once).max() < 1e-6 * count


def test_a_fine_polygon_inside_a_pixel():
    for count, off in ((1000, 1e-6), (10_000, 1e-5)):
        angles = 2 * np.pi * np.arange(count) / count
        fine = of_points(np.stack([1.5 + 0.45 * np.cos(angles), 1.5 + 0.45 * np.sin(angles)], 1))
        for filter in FILTERS:
            expected = image_of(to_shape([circle((1.5, 1.5), 0.45)]), filter=filter)
            assert np.abs(image_of(fine, filter=filter) - expected).max() < off + 5 / count**2


def test_a_million_vertices_inside_a_pixel():
    angles = 2 * np.pi * np.arange(1_000_000) / 1_000_000
    fine = of_points(np.stack([1.5 + 0.45 * np.cos(angles), 1.5 + 0.45 * np.sin(angles)], 1))
    expected = image_of(to_shape([circle((1.5, 1.5), 0.45)]))
    assert np.abs(image_of(fine) - expected).max() < 1e-3


def test_a_scribble():
    """Thousands of crossing lines: values stay between empty and full."""
    corners = np.random.default_rng(0).uniform(-1, 7, (300, 2))
    for rule in ("nonzero", "evenodd"):
        image = image_of(of_points(corners, fill_rule=rule))
        assert image.min() > -1e-5
        assert image.max() < 1.0 + 1e-5
    # Shapes as large as a pixel, and a hundredth of it.
    area = image_of(of_points(corners + 1), width=8, height=8).sum()
    tiny = image_of(of_points(2.3 + 0.01 * corners))
    assert tiny.sum() == pytest.approx(1e-4 * area, abs=1e-6)


def test_repeated_curves():
    contour = blob(3, 3, (0.4, 0.3), (5.7, 4.8))
    once = image_of(to_shape([contour]))
    assert np.abs(image_of(to_shape([contour] * 50)) - once).max() < 1e-6


@pytest.mark.parametrize("filter", ["box", "mitchell", "radial3"])
def test_weights_at_the_limits(filter):
    """The lightest conic is nearly its chord, the heaviest nearly its control polygon."""
    corners = [(0.7, 0.6), (5.2, 1.1), (4.6, 4.4)]
    heavy = path(("move_to", *corners[0]), ("conic_to", *corners[1], 1e6, *corners[2]))
    expected = image_of(of_points(corners), filter=filter)
    assert np.abs(image_of(heavy, filter=filter) - expected).max() < 1e-4
    light = path(("move_to", *corners[0]), ("conic_to", *corners[1], 1e-6, *corners[2]))
    assert np.abs(image_of(light, filter=filter)).max() < 1e-4


def test_the_highest_degree():
    random = np.random.default_rng(2)
    for seed in range(3):
        shape = path(("move_to", 1, 1), ("curve_to", *random.uniform(-20, 26, 120)))
        for rule in ("nonzero", "evenodd"):
            shape._fill_rule = rule
            image = image_of(shape)
            assert image.min() > -1e-4, seed
            assert image.max() < 1.0 + 1e-4, seed


def test_coordinates_that_differ_by_rounding():
    """Coordinates that differ only by rounding."""
    x = 2.5
    for _ in range(3):
        next_x = np.nextafter(x, 9)
        sliver = of_points([(x, 0.5), (next_x, 0.5), (next_x, 4.5), (x, 4.5)])
        assert np.abs(image_of(sliver)).max() < 1e-7
        x = next_x
    tiny = mapped([blob(3, 1, (0, 0), (1, 1))], [(1e-12, 0, 2.3), (0, 1e-12, 2.7)])
    assert np.abs(image_of(to_shape(tiny))).max() < 1e-7
    assert np.abs(image_of(to_shape(mapped(tiny, [(1e-300, 0, 0), (0, 1e-300, 0)])))).max() == 0.0


def test_large_and_small_colors():
    square = [(1, 1), (4, 1), (4, 4), (1, 4)]
    for value in (1e30, -1e30, 1e-30, 0.0):
        image = image_of(of_points(square, color=(value,)))
        assert (image[1:4, 1:4] == np.float32(value)).all()


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy])
def test_copies_share_nothing(duplicate):
    shape = of_points([(1, 1), (4, 1), (4, 4), (1, 4)])
    before = image_of(shape)
    other = duplicate(shape)
    other.add_polygon([(5.0, 0), (6, 0), (6, 1), (5, 1)])
    other.color = (0.5,)
    assert (image_of(shape) == before).all()
    assert shape.color == (1.0,)
    assert (image_of(other)[:, :5] == 0.5 * before[:, :5]).all()


def test_shapes_may_be_changed_and_drawn_again():
    shape = of_points([(1, 1), (4, 1), (4, 4), (1, 4)])
    before = image_of(shape)
    moved = shape.transformed([(1, 0, 1), (0, 1, 0)])
    shape.color = (0.5,)
    shape.add_polygon([(5.0, 0), (6, 0), (6, 1), (5, 1)])
    after = image_of(shape)
    assert after[0, 5] == 0.5
    assert np.abs(after[:, :5] - 0.5 * before[:, :5]).max() == 0.0
    assert (image_of(moved)[:, 1:] == before[:, :-1]).all()
    assert moved.color == (1.0,)
