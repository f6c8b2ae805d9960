# SPDX-License-Identifier: GPL-3.0-or-later

"""Laws of images of any shapes, for all filters."""

import numpy as np
import prefilter
import pytest
from outlines import Segment, blob, circle, mapped, polygon, reversed_contours, to_shape

FILTERS = prefilter.RASTER_FILTERS
ROUNDING = 5e-7  # sums of float32, and moments of 2^-26


def image_of(contours, width=11, height=9, filter="box", **options):
    return prefilter.rasterize([to_shape(contours)], width, height, filter=filter, **options)


def drawing(seed):
    """Disjoint contours of every kind, with coordinates that are multiples of 2^-20."""
    contours = [
        blob(1 + seed % 5, seed, (-1.3, 0.4), (4.9, 5.2)),
        blob(2, seed + 1, (5.2, 3.3), (10.4, 8.9), weights=[0.4, 1.0, 2.0, 0.7, 1.5]),
        polygon([(6.1, 0.3), (10.7, 0.9), (8.2, 2.9)]),
    ]
    rounded = [
        [Segment(np.rint(segment.points * 2**20) / 2**20, segment.weight) for segment in contour]
        for contour in contours
    ]
    return rounded


def tiling(seed, low, high, count, curved):
    """Shapes that tile a square: cells of a warped grid with shared edges."""
    random = np.random.default_rng(seed)
    lines = np.linspace(low, high, count + 1)
    corners = np.stack(np.meshgrid(lines, lines, indexing="ij"), -1)
    step = (high - low) / count
    corners[1:-1, 1:-1] += random.uniform(-0.2, 0.2, (count - 1, count - 1, 2)) * step
    # Control points of the edges along both axes; outer edges are straight.
    bends = random.uniform(-0.12, 0.12, (2, count + 1, count + 1, 2, 2)) * step * curved

    def seam(axis, i, j):
        begin = corners[i, j]
        end = corners[i + 1, j] if axis == 0 else corners[i, j + 1]
        middle = [begin + (end - begin) * (k + 1) / 3 + bends[axis, i, j, k] for k in (0, 1)]
        return Segment(np.array([begin, *middle, end]))

    return [
        [
            seam(0, i, j),
            seam(1, i + 1, j),
            seam(0, i, j + 1).reversed(),
            seam(1, i, j).reversed(),
        ]
        for i in range(count)
        for j in range(count)
    ]


@pytest.mark.parametrize("curved", [0.0, 1.0], ids=["lines", "cubics"])
@pytest.mark.parametrize("filter", FILTERS)
def test_shapes_that_cover_the_image_leave_no_seam(filter, curved):
    cells = tiling(3, -5.3, 16.4, 9, curved)
    ones = [to_shape([cell]) for cell in cells]
    image = prefilter.rasterize(ones, 11, 10, filter=filter, overlap="add")
    assert (image == 1.0).all()
    # In many colors, with one channel the same for all.
    random = np.random.default_rng(1)
    many = [to_shape([cell], color=(0.7, *random.random(2))) for cell in cells]
    image = prefilter.rasterize(many, 11, 10, filter=filter, overlap="add")
    assert (image[..., 0] == np.float32(0.7)).all()
    assert image[..., 1].std() > 0.1


@pytest.mark.parametrize("filter", FILTERS)
def test_one_shape_around_the_image_gives_its_color(filter):
    for size in (20.0, 1e4, 1e8):
        contours = [circle((5.0, 4.0), size)]
        shape = to_shape(contours, color=(0.1, -3.0, 7e8))
        image = prefilter.rasterize([shape], 11, 9, filter=filter)
        assert (image == np.float32([0.1, -3.0, 7e8])).all()


def test_abutting_quads_are_opaque():
    """64 in a row over 40 pixels, and 64 around a point."""
    x = np.linspace(-3.0, 43.0, 65)
    tilt = np.random.default_rng(0).uniform(-0.3, 0.3, 65)
    row = [
        polygon(
            [
                (x[k] - tilt[k], -5),
                (x[k + 1] - tilt[k + 1], -5),
                (x[k + 1] + tilt[k + 1], 45),
                (x[k] + tilt[k], 45),
            ]
        )
        for k in range(64)
    ]
    angles = 2 * np.pi * np.arange(64) / 64
    rim = np.stack([20.2 + 60 * np.cos(angles), 19.7 + 60 * np.sin(angles)], 1)
    fan = [polygon([(20.2, 19.7), rim[k], rim[(k + 1) % 64]]) for k in range(64)]
    for shapes in (row, fan):
        for filter in FILTERS:
            image = prefilter.rasterize(
                [to_shape([quad]) for quad in shapes],
                40,
                40,
                filter=filter,
                overlap="add",
                dtype="uint8",
            )
            assert image.min() == 255, filter


@pytest.mark.parametrize("filter", FILTERS)
def test_whole_pixels_of_translation_move_the_image(filter):
    contours = drawing(1)
    image = image_of(contours, filter=filter)
    for by in ((3, 2), (1000, -70)):
        moved = mapped(contours, [(1, 0, by[0]), (0, 1, by[1])])
        # Without the columns that moved in from the left.
        away = prefilter.rasterize(
            [to_shape(moved)], max(by[0], 0) + 11, max(by[1], 0) + 9, filter=filter
        )
        if by[1] >= 0:
            assert np.abs(away[by[1] :, by[0] :] - image).max() < ROUNDING
        back = mapped(moved, [(1, 0, -by[0]), (0, 1, -by[1])])
        assert (image_of(back, filter=filter) == image).all()


@pytest.mark.parametrize("filter", FILTERS)
def test_mirrored_and_transposed_shapes(filter):
    contours = drawing(2)
    image = image_of(contours, filter=filter)
    flipped_x = image_of(mapped(contours, [(-1, 0, 11), (0, 1, 0)]), filter=filter)
    assert np.abs(flipped_x[:, ::-1] - image).max() < ROUNDING
    flipped_y = image_of(mapped(contours, [(1, 0, 0), (0, -1, 9)]), filter=filter)
    assert np.abs(flipped_y[::-1] - image).max() < ROUNDING
    transposed = image_of(mapped(contours, [(0, 1, 0), (1, 0, 0)]), 9, 11, filter=filter)
    assert np.abs(transposed.transpose(1, 0, 2) - image).max() < 2 * ROUNDING


@pytest.mark.parametrize("fill_rule", ["nonzero", "evenodd"])
def test_orientation_of_contours_does_not_matter(fill_rule):
    contours = [*drawing(3), circle((8.0, 6.0), 0.7)]
    first = prefilter.rasterize([to_shape(contours, fill_rule=fill_rule)], 11, 9)
    turned = reversed_contours(contours)
    last = prefilter.rasterize([to_shape(turned, fill_rule=fill_rule)], 11, 9)
    assert np.abs(first - last).max() < ROUNDING


def test_holes_by_orientation_or_parity():
    ring = [circle((5.0, 4.5), 4.0), circle((5.2, 4.3), 2.0)]
    hole = [ring[0], *reversed_contours(ring[1:])]
    full = image_of(ring[:1])
    assert np.abs(image_of(ring) - full).max() < ROUNDING
    expected = full - image_of(ring[1:])
    assert np.abs(image_of(hole) - expected).max() < ROUNDING
    parity = prefilter.rasterize([to_shape(ring, fill_rule="evenodd")], 11, 9)
    assert np.abs(parity - expected).max() < ROUNDING


@pytest.mark.parametrize("filter", ["box", "tent", "mitchell", "lanczos3", "radial2"])
def test_subdivided_curves(filter):
    for degree in (1, 2, 3, 5):
        contour = blob(degree, degree, (0.4, 0.3), (10.6, 8.8))
        parts = [part for segment in contour for part in segment.split(0.37)]
        image = image_of([contour], filter=filter)
        assert np.abs(image_of([parts], filter=filter) - image).max() < ROUNDING


def test_degrees_can_be_raised():
    for degree in (1, 2, 3):
        contour = blob(degree, degree + 7, (0.4, 0.3), (10.6, 8.8))
        image = image_of([contour], filter="mitchell")
        for higher in (degree + 1, 12, 60):
            raised = contour
            while len(raised[0].points) <= higher:
                raised = [segment.elevated() for segment in raised]
            off = np.abs(image_of([raised], filter="mitchell") - image).max()
            assert off < ROUNDING, (degree, higher)


def test_a_conic_of_weight_one_is_a_parabola():
    conics = blob(2, 4, (0.4, 0.3), (10.6, 8.8), weights=[1.0] * 5)
    curves = [Segment(segment.points) for segment in conics]
    for filter in ("box", "lanczos3"):
        off = image_of([conics], filter=filter) - image_of([curves], filter=filter)
        assert np.abs(off).max() < ROUNDING


@pytest.mark.parametrize("filter", FILTERS)
def test_images_are_linear_in_shapes_and_colors(filter):
    first, second = to_shape(drawing(4)), to_shape(drawing(5), color=(0.25,))
    images = [prefilter.rasterize([shape], 11, 9, filter=filter) for shape in (first, second)]
    both = prefilter.rasterize([first, second], 11, 9, filter=filter, overlap="add")
    assert np.abs(both - sum(images)).max() < ROUNDING
    assert (prefilter.rasterize([second, first], 11, 9, filter=filter, overlap="add") == both).all()
    first.color = (4.0, -1.0, 0.0, 0.25)
    image = prefilter.rasterize([first], 11, 9, filter=filter)
    assert (image == images[0] * np.float32([4.0, -1.0, 0.0, 0.25])).all()


@pytest.mark.parametrize("filter", ["box", "tent", "bspline2", "mitchell"])
def test_the_sum_of_an_image_is_the_area(filter):
    """Holds for filters that sum to 1 around every point."""
    contours = [circle((13.3, 12.1), 6.0), circle((22.6, 20.4), 2.5)]
    image = image_of(contours, 32, 28, filter=filter)
    area = np.pi * (6.0**2 + 2.5**2)
    assert image.sum(dtype=float) == pytest.approx(area, abs=1e-5)
    x, y = np.meshgrid(np.arange(32) + 0.5, np.arange(28) + 0.5)
    for along, expected in ((x, 13.3 * 36 + 22.6 * 6.25), (y, 12.1 * 36 + 20.4 * 6.25)):
        # The first moment is the coordinate itself, except for the box filter.
        if filter != "box":
            actual = (image[..., 0].astype(float) * along).sum()
            assert actual == pytest.approx(np.pi * expected, abs=1e-4)


def test_boxes_of_a_finer_image_are_the_image():
    contours = drawing(6)
    image = image_of(contours)
    fine = image_of(mapped(contours, 3 * np.eye(2, 3)), 33, 27).astype(float)
    means = fine.reshape(9, 3, 11, 3).mean((1, 3))
    assert np.abs(means - image[..., 0]).max() < ROUNDING


def test_a_shape_transformed_is_the_shape_of_transformed_points():
    matrix = [(0.7, -0.4, 3.2), (0.3, 0.9, -0.8)]
    contours = drawing(7)
    shape = to_shape(contours)
    shape.gradient((0.3,), (0.04,), (-0.02,))
    moved = shape.transformed(matrix)
    direct = to_shape(mapped(contours, matrix))
    inverse = np.linalg.inv(np.vstack([matrix, (0, 0, 1)]))
    row = np.array([0.04, -0.02, 0.3]) @ inverse
    direct.gradient((row[2],), (row[0],), (row[1],))
    for filter in ("box", "mitchell"):
        actual, expected = (
            prefilter.rasterize([it], 11, 9, filter=filter) for it in (moved, direct)
        )
        assert np.abs(actual - expected).max() < ROUNDING
    (low_x, low_y), (high_x, high_y) = moved.bounds
    points = np.concatenate([s.points for contour in mapped(contours, matrix) for s in contour])
    assert np.allclose([low_x, low_y], points.min(0), atol=1e-12)
    assert np.allclose([high_x, high_y], points.max(0), atol=1e-12)


def scene():
    """Shapes with every kind of color, over several bands of rows."""
    place = [(30, 0, -20), (0, 60, 5)]
    shapes = [to_shape(mapped(drawing(k), place), color=(0.2 * k, 0.5)) for k in range(4)]
    shapes[1].gradient((0.1, 0.2), (0.002, 0.0), (0.0, -0.001))
    stops = [(0.0, (1.0, 0.0)), (0.4, (0.2, 0.5)), (1.0, (0.0, 1.0))]
    shapes[2].linear_gradient((30, 30), (200, 90), stops, spread="reflect")
    shapes[3].radial_gradient((150, 200), 90.0, stops, spread="repeat")
    return shapes


@pytest.mark.parametrize("filter", ["box", "mitchell", "radial2"])
@pytest.mark.parametrize("overlap", ["add", "cover"])
def test_the_number_of_threads_changes_no_bit(filter, overlap):
    images = [
        prefilter.rasterize(
            scene(), 180, 600, filter=filter, overlap=overlap, threads=threads, background=(0.3, 1)
        )
        for threads in (1, 2, 3)
    ]
    assert (images[0] == images[1]).all()
    assert (images[0] == images[2]).all()


@pytest.mark.parametrize("filter", FILTERS)
def test_crops_are_the_same(filter):
    """Shapes beyond the right or upper side do not change an image."""
    shapes = scene()[:2]
    whole = prefilter.rasterize(shapes, 200, 310, filter=filter, overlap="add")
    for width, height in ((1, 310), (90, 17), (137, 300), (200, 1)):
        part = prefilter.rasterize(shapes, width, height, filter=filter, overlap="add")
        assert np.abs(part - whole[:height, :width]).max() == 0.0


@pytest.mark.parametrize("filter", FILTERS)
def test_background_outside_of_shapes(filter):
    behind = (0.1, 0.7)
    shape = to_shape([circle((10.3, 12.2), 5.0)], color=(0.9, 0.2))
    image = prefilter.rasterize([shape], 40, 30, filter=filter, background=behind)
    y, x = np.indices((30, 40)) + 0.5
    far = np.maximum(np.abs(x - 10.3), np.abs(y - 12.2)) > 5.0 + 3.01
    assert far.any()
    assert (image[far] == np.float32(behind)).all()
    inside = np.hypot(x - 10.3, y - 12.2) < 5.0 - 3.0 * np.sqrt(2) - 0.01
    assert inside.any()
    assert (image[inside] == np.float32((0.9, 0.2))).all()
    without = prefilter.rasterize([shape], 40, 30, filter=filter)
    assert (without[far] == 0.0).all()
    empty = prefilter.rasterize([], 4, 3, filter=filter, background=(0.1, 0.2, 0.3, 0.4))
    assert empty.shape == (3, 4, 4)
    assert (empty == np.float32((0.1, 0.2, 0.3, 0.4))).all()


def test_background_shows_through_by_alpha():
    contours = drawing(8)
    coverage = image_of(contours, filter="tent")
    behind = np.array([0.1, 0.2, 0.3, 0.5])
    color = np.array([0.2, 0.3, 0.1, 0.4])
    shape = to_shape(contours, color=color)
    image = prefilter.rasterize([shape], 11, 9, filter="tent", background=behind)
    expected = coverage * color + (1.0 - coverage * color[3]) * behind
    assert np.abs(image - expected).max() < ROUNDING


@pytest.mark.parametrize("filter", FILTERS)
def test_gradients_over_a_covered_image_are_their_means(filter):
    """The mean of a linear color around a pixel's center is the color there."""
    around = to_shape([polygon([(-50, -40), (60, -45), (70, 80), (-55, 66)])])
    around.gradient((0.4, 1.0), (0.03, 0.0), (-0.02, 0.01))
    image = prefilter.rasterize([around], 11, 9, filter=filter)
    y, x = np.indices((9, 11)) + 0.5
    expected = np.stack([0.4 + 0.03 * x - 0.02 * y, 1.0 + 0.01 * y], -1)
    assert np.abs(image - expected).max() < ROUNDING


def test_opaque_shapes_hide_others_completely():
    """An opaque shape hides everything below it, including its outline."""
    below = to_shape([circle((5.0, 4.5), 3.0)], color=(9.0, 0.0))
    above = to_shape([circle((5.0, 4.5), 3.5)], color=(0.25, 1.0))
    for filter in ("box", "lanczos3"):
        both = prefilter.rasterize([below, above], 11, 9, filter=filter, overlap="cover")
        alone = prefilter.rasterize([above], 11, 9, filter=filter)
        assert np.abs(both - alone).max() < ROUNDING
        same = prefilter.rasterize([below, below], 11, 9, filter=filter, overlap="cover")
        once = prefilter.rasterize([below], 11, 9, filter=filter)
        assert np.abs(same - once).max() < 9 * ROUNDING


def ragged_map(source, side):
    """Quads with irregular shared edges."""
    corners = np.stack(np.meshgrid(np.arange(side + 1), np.arange(side + 1)), -1) * 5.0 + 2.0
    corners += source.uniform(-0.8, 0.8, corners.shape)

    def border(a, b):
        steps = np.linspace(a, b, 9)[:-1]
        steps[1:] += source.uniform(-0.25, 0.25, (7, 2))
        return steps

    flat = [[border(*corners[y, x : x + 2]) for x in range(side)] for y in range(side + 1)]
    steep = [[border(*corners[y : y + 2, x]) for x in range(side + 1)] for y in range(side)]

    def back(line, end):
        return np.concatenate([end[None], line[:0:-1]])

    for y in range(side):
        for x in range(side):
            yield np.concatenate(
                [
                    flat[y][x],
                    steep[y][x + 1],
                    back(flat[y + 1][x], corners[y + 1, x + 1]),
                    back(steep[y][x], corners[y + 1, x]),
                ]
            )


@pytest.mark.parametrize("filter", ["box", "mitchell"])
def test_tiled_maps_with_add(filter):
    """Adjacent shapes do not cover each other; a shape over both does."""
    source = np.random.default_rng(12)
    shapes = []
    for points in ragged_map(source, 5):
        shapes.append(prefilter.Shape(color=source.random(3)))
        shapes[-1].add_polygon(points)
    options = {"width": 30, "height": 28, "filter": filter}
    added = prefilter.rasterize(shapes, overlap="add", **options)
    np.testing.assert_array_equal(prefilter.rasterize(shapes, **options), added)
    over = prefilter.Shape(color=(0.0, 0.0, 0.0))
    over.add_polygon([(-20, -20), (70, -20), (70, 70), (-20, 70)])
    assert np.abs(prefilter.rasterize([*shapes, over], **options)).max() < 1e-6


@pytest.mark.parametrize("filter", ["box", "tent", "lanczos3"])
@pytest.mark.parametrize("alpha", [1.0, 0.4])
def test_rectangle_below_all_is_a_background(filter, alpha):
    source = np.random.default_rng(5)
    page = prefilter.Shape(color=(0.3 * alpha, 0.1 * alpha, 0.2 * alpha, alpha))
    far = 0 if filter == "box" else 30
    page.add_polygon([(-far, -far), (20 + far, -far), (20 + far, 15 + far), (-far, 15 + far)])
    others = []
    for _ in range(4):
        others.append(prefilter.Shape(color=(*source.random(3) * 0.5, 0.5)))
        others[-1].add_polygon(source.random((3, 2)) * 15)
    behind = (0.2, 0.6, 0.4, 0.8)
    mixed = np.array(page.color) + (1.0 - alpha) * np.array(behind)
    options = {"width": 20, "height": 15, "filter": filter}
    actual = prefilter.rasterize([page, *others], background=behind, **options)
    expected = prefilter.rasterize(others, background=mixed, **options)
    assert np.abs(actual - expected).max() < 1e-6
    # A page that ends within the image, or is not a rectangle, is an ordinary shape.
    for points in (
        [(0, 0), (19.5, 0), (19.5, 15), (0, 15)],
        [(0, 0), (20, 0), (20, 15)],
        [(0, 0), (20, 0), (20, 15), (3, 15)],
    ):
        small = prefilter.Shape(color=page.color)
        small.add_polygon(points)
        actual = prefilter.rasterize([small, *others], **options)
        alone = prefilter.rasterize(others, **options)
        expected = alone + prefilter.rasterize([small], **options)
        # The page shows wherever nothing covers it.
        nothing = np.zeros(actual.shape[:2], bool)
        nothing[:, 17:] = True
        if filter == "box":
            assert np.abs(actual - expected)[nothing].max() < 1e-6
