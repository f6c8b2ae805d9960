# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing, against dense sums of the filters' closed forms and dense least squares."""

from itertools import product

import numpy as np
import prefilter
import pytest
from kernels import FILTERS, folded, tolerance_of, weights_of_texels
from scenes import random_image

optimize = pytest.importorskip("scipy.optimize")
special = pytest.importorskip("scipy.special")

WRAPS = ("clamp", "repeat", "border")
SIZES = [(12, 9, 5, 4), (8, 8, 4, 2), (6, 5, 1, 3), (7, 4, 17, 9), (5, 16, 9, 3), (4, 6, 4, 13)]


def image_of(width, height, channels=1, seed=0):
    return random_image(seed, height, width, channels)


def axis_weights(filter, size, target, wrap):
    if size == target:
        return np.eye(size)
    return weights_of_texels(filter, size, target, wrap)


@pytest.mark.parametrize("filter", FILTERS)
def test_kernels_are_their_closed_forms(filter):
    for k, (width, height, new_width, new_height) in enumerate(SIZES):
        image = image_of(width, height, 1 + k % 4)
        for wrap in product(WRAPS, WRAPS):
            along_x = axis_weights(filter, width, new_width, wrap[0])
            along_y = axis_weights(filter, height, new_height, wrap[1])
            expected = np.einsum("jy,ix,yxc->jic", along_y, along_x, image.astype(float))
            found = prefilter.resize(
                image, new_width, new_height, filter=filter, wrap=wrap, premultiplied=True
            )
            assert found.dtype == np.float32
            np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance_of(filter))


def jinc(r, radius):
    r = np.maximum(r, 1e-9)
    return np.where(r < radius, special.j1(np.pi * r) / (np.pi * r) * np.sinc(r / radius), 0.0)


@pytest.mark.parametrize("radius", [2, 3])
def test_radial_filters_are_windowed_jincs(radius):
    for k, (width, height, new_width, new_height) in enumerate(SIZES):
        image = image_of(width, height, 1 + k % 4)
        scale_x, scale_y = width / new_width, height / new_height
        unit_x, unit_y = max(1, scale_x), max(1, scale_y)
        reach_x, reach_y = int(4 * unit_x) + 1, int(4 * unit_y) + 1
        for wrap in WRAPS:
            expected = np.zeros((new_height, new_width, image.shape[2]))
            for j, i in np.ndindex(new_height, new_width):
                x = (np.arange(-reach_x, width + reach_x) + 0.5 - (i + 0.5) * scale_x) / unit_x
                y = (np.arange(-reach_y, height + reach_y) + 0.5 - (j + 0.5) * scale_y) / unit_y
                weights = jinc(np.hypot(x, y[:, None]), radius)
                weights /= weights.sum()
                weights = folded(weights, reach_x, width, wrap)
                weights = folded(weights.T, reach_y, height, wrap).T
                expected[j, i] = np.einsum("yx,yxc->c", weights, image)
            found = prefilter.resize(
                image,
                new_width,
                new_height,
                filter=f"radial{radius}",
                wrap=wrap,
                premultiplied=True,
            )
            np.testing.assert_allclose(found, expected, rtol=0, atol=3e-7)


def tents(texels, target, wrap):
    """Integrals along one axis, of products of tents and of tents over texels: both exact.

    Between texels' edges and tents' corners all is polynomial, and Gauss' two points do.
    """
    corners = np.concatenate([np.arange(texels + 1) / texels, (np.arange(target) + 0.5) / target])
    edges = np.unique(corners)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    place = (middle[:, None] + half[:, None] * np.array([-1, 1]) / np.sqrt(3)).ravel()
    weights = half.repeat(2)
    values = np.zeros((len(place), target))
    for k in range(-1, target + 1):
        tent = np.maximum(0.0, 1 - abs(place * target - (k + 0.5)))
        if wrap == "clamp":
            values[:, min(max(k, 0), target - 1)] += tent
        elif wrap == "repeat" or 0 <= k < target:
            values[:, k % target] += tent
    over_texels = np.zeros((texels, target))
    np.add.at(over_texels, (place * texels).astype(int), weights[:, None] * values)
    return values.T @ (weights[:, None] * values), over_texels


def closest(image, width, height, wrap, low, high):
    """Dense least squares within bounds, of all texels or of each."""
    products_x, texels_x = tents(image.shape[1], width, wrap)
    products_y, texels_y = tents(image.shape[0], height, wrap)
    root = np.linalg.cholesky(np.kron(products_y, products_x))
    shape = (height, width, image.shape[2])
    # The solver needs a gap between bounds.
    low, high = np.broadcast_to(low, shape), np.broadcast_to(high, shape) + 1e-12
    result = np.empty(shape)
    for c in range(image.shape[2]):
        right = (texels_y.T @ image[..., c] @ texels_x).ravel()
        bounds = low[..., c].ravel(), high[..., c].ravel()
        solved = optimize.lsq_linear(
            root.T, np.linalg.solve(root, right), bounds, "bvls", tol=1e-15, max_iter=1000
        )
        result[..., c] = solved.x.reshape(height, width)
    return result


def ranges_around(image, width, height, wrap):
    """The least and the greatest of the pixels that overlap a square around each new one."""
    old_height, old_width, channels = image.shape
    pad = 3 * max(1, *(-(-a // b) for a, b in ((old_height, height), (old_width, width))))
    mode = {"clamp": "edge", "repeat": "wrap", "border": "constant"}[wrap]
    padded = np.pad(image, ((pad, pad), (pad, pad), (0, 0)), mode=mode)
    low = np.empty((height, width, channels))
    high = np.empty_like(low)

    def overlapped(index, size, new_size):
        # In units of 1 / (2 new_size) of an old pixel, where all ends are whole numbers.
        center, reach = (2 * index + 1) * size, 2 * max(size, new_size)
        edges = 2 * new_size * np.arange(-pad, size + pad)
        return (edges + 2 * new_size > center - reach) & (edges < center + reach)

    for y, x in np.ndindex(height, width):
        rows = overlapped(y, old_height, height)
        columns = overlapped(x, old_width, width)
        around = padded[rows][:, columns]
        low[y, x], high[y, x] = around.min(axis=(0, 1)), around.max(axis=(0, 1))
    return low, high


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("constrained", [False, True])
@pytest.mark.parametrize("ringing", ["allow", "auto"])
def test_least_squares_are_dense_least_squares(wrap, constrained, ringing):
    beyond = 0
    for k, (width, height, new_width, new_height) in enumerate(SIZES):
        # Black and white, or three grays: what fits best is out of bounds.
        image = image_of(width, height, 1 + k % 2).round()
        if ringing == "auto":
            image = (2 * image_of(width, height, 1 + k % 2)).round() - np.float32(0.25)
        low, high = (0.0, 1.0) if constrained else (-np.inf, np.inf)
        if ringing == "auto":
            around = ranges_around(image, new_width, new_height, wrap)
            low, high = (np.clip(one, low, high) for one in around)
        expected = closest(image.astype(float), new_width, new_height, wrap, low, high)
        found = prefilter.resize(
            image,
            new_width,
            new_height,
            filter="least-squares",
            wrap=wrap,
            constrained=constrained,
            ringing=ringing,
            premultiplied=True,
        )
        beyond += np.sum((found < 0) | (found > 1))
        np.testing.assert_allclose(found, expected, rtol=0, atol=5e-6)
    assert (beyond == 0) == constrained


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
@pytest.mark.parametrize("wrap", WRAPS)
def test_without_ringing_values_are_those_around(filter, wrap):
    for k, (width, height, new_width, new_height) in enumerate((*SIZES, (40, 3, 3, 40))):
        # A step edge: filters overshoot beside it.
        image = 0.01 * image_of(width, height, 1 + k % 4)
        image[height // 3 :, width // 3 :] += 2
        image = image.astype(np.float32)
        options = {"filter": filter, "wrap": wrap, "premultiplied": True}
        found = prefilter.resize(image, new_width, new_height, ringing="limit", **options)
        low, high = ranges_around(image, new_width, new_height, wrap)
        assert np.all(found >= low)
        assert np.all(found <= high)
        if filter != "least-squares":
            free = prefilter.resize(image, new_width, new_height, **options)
            np.testing.assert_array_equal(found, free.clip(low, high).astype(np.float32))
            allowed = prefilter.resize(image, new_width, new_height, ringing="allow", **options)
            np.testing.assert_array_equal(free, allowed)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_a_bright_sun_leaves_no_darkness_around_it(filter):
    sky = 0.1 + 0.4 * image_of(64, 48, 3)
    sky[20:23, 30:33] = 20000.0
    found = prefilter.resize(sky, 16, 12, filter=filter, ringing="limit")
    assert found.min() >= 0.1
    assert found.max() <= 20000
    if filter == "least-squares":
        np.testing.assert_array_equal(found, prefilter.resize(sky, 16, 12, filter=filter))
        assert prefilter.resize(sky, 16, 12, filter=filter, ringing="allow").min() < -100


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_without_ringing_colors_are_those_seen_around(filter):
    image = image_of(24, 20, 4)
    image[..., 3] = image[..., 3] > 0.5
    image[image[..., 3] == 0, :3] = 7.0  # that of nothing that is seen
    found = prefilter.resize(image, 9, 7, filter=filter, ringing="limit")
    seen = image[..., 3:] > 0
    low, _ = ranges_around(np.where(seen, image, np.inf), 9, 7, "clamp")
    _, high = ranges_around(np.where(seen, image, -np.inf), 9, 7, "clamp")
    assert np.all(found[..., :3] >= low[..., :3])
    assert np.all(found[..., :3] <= high[..., :3])


def test_ringing_has_three_names():
    with pytest.raises(ValueError, match="ringing: 'some' is not one of auto, limit, allow"):
        prefilter.resize(np.zeros((2, 2)), 1, 1, ringing="some")


def enlarged(image, width, height):
    return prefilter.resize(image, width, height, filter="tent")


def test_constrained_least_squares_beat_the_other_filters_within_the_bounds():
    """Figure 1.8, in numbers: the error after bilinear enlargement, of an image of edges."""
    y, x = np.mgrid[:96, :96] / 96
    image = ((np.hypot(x - 0.4, y - 0.5) < 0.3) | (np.sin(60 * x * y) > 0.5)).astype(np.float32)
    image = image[..., None]

    def error(**options):
        small = prefilter.resize(image, 24, 24, constrained=True, ringing="allow", **options)
        large = enlarged(small, 960, 960)
        return np.sqrt(np.mean((large - prefilter.resize(image, 960, 960, filter="box")) ** 2))

    best = error(filter="least-squares")
    for filter in set(prefilter.RESIZE_FILTERS) - {"least-squares"}:
        assert best < error(filter=filter), filter


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_constants_stay_to_the_last_bit(filter):
    for channels, value in ((1, 0.1), (2, 0.7), (3, -3.3e7), (4, 1e-20)):
        image = np.full((9, 13, channels), value, np.float32)
        for wrap, (width, height) in product(("clamp", "repeat"), ((5, 3), (29, 31), (40, 1))):
            found = prefilter.resize(
                image, width, height, filter=filter, wrap=wrap, premultiplied=True
            )
            assert np.all(found == np.float32(value))


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_an_image_of_the_same_size_stays(filter, channels):
    image = image_of(7, 5, channels) * 3 - 1
    found = prefilter.resize(image, 7, 5, filter=filter)
    np.testing.assert_array_equal(found, image)
    assert not np.shares_memory(found, image)
    clipped = prefilter.resize(image, 7, 5, filter=filter, constrained=True)
    np.testing.assert_array_equal(clipped, image.clip(0, 1))


@pytest.mark.parametrize("filter", FILTERS)
def test_an_axis_whose_size_stays_is_left_alone(filter):
    row = image_of(9, 1, 3)
    image = np.broadcast_to(row, (6, 9, 3))
    found = prefilter.resize(image, 4, 6, filter=filter)
    np.testing.assert_array_equal(found, np.repeat(found[:1], 6, axis=0))
    np.testing.assert_array_equal(found[:1], prefilter.resize(row, 4, 1, filter=filter))


def test_box_is_the_mean_and_squares_stay_squares():
    image = image_of(12, 8, 3)
    means = image.astype(float).reshape(4, 2, 4, 3, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(prefilter.resize(image, 4, 4, filter="box"), means, atol=1e-7)
    large = prefilter.resize(image, 36, 16, filter="box")
    np.testing.assert_array_equal(large, image.repeat(2, axis=0).repeat(3, axis=1))


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_a_mirrored_image_gives_a_mirrored_result(filter):
    image = image_of(11, 8, 2)
    for width, height in ((4, 3), (18, 20)):
        found = prefilter.resize(image, width, height, filter=filter, premultiplied=True)
        for flip in (np.fliplr, np.flipud):
            mirrored = prefilter.resize(
                flip(image), width, height, filter=filter, premultiplied=True
            )
            np.testing.assert_allclose(mirrored, flip(found), rtol=0, atol=4e-6)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_a_tiled_image_can_be_shifted(filter):
    image = image_of(12, 9, 1)
    found = prefilter.resize(image, 4, 3, filter=filter, wrap="repeat")
    shifted = prefilter.resize(
        np.roll(image, (6, 3), axis=(0, 1)), 4, 3, filter=filter, wrap="repeat"
    )
    np.testing.assert_allclose(shifted, np.roll(found, (2, 1), axis=(0, 1)), rtol=0, atol=4e-6)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
@pytest.mark.parametrize("colors", [1, 3])
def test_colors_without_alpha_do_not_bleed(filter, colors):
    image = np.zeros((16, 16, colors + 1), np.float32)
    image[..., :colors] = 1.0  # seen nowhere but in the middle, where it is 0.25
    image[4:12, 4:12, :colors] = 0.25
    image[4:12, 4:12, -1] = 1.0
    for size in (7, 37):
        found = prefilter.resize(image, size, size, filter=filter)
        np.testing.assert_allclose(found[..., :colors], 0.25, rtol=0, atol=1e-6)
        assert found[..., -1].min() >= 0
        assert found[..., -1].max() <= 1
        assert np.ptp(found[..., -1]) > 0.9


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
@pytest.mark.parametrize("colors", [1, 3])
def test_colors_count_by_their_alpha(filter, colors):
    image = 0.4 + 0.2 * image_of(60, 64, colors + 1)
    image[0, :2, :-1] = [[-1], [2]]  # so that no limit of colors is near anywhere else
    multiplied = image * image[..., -1:]
    multiplied[..., -1] = image[..., -1]
    for width, height in ((30, 27), (83, 90)):
        # The bounds of colors do not apply to premultiplied colors.
        options = {"filter": filter, "ringing": "allow"}
        found = prefilter.resize(image, width, height, **options)
        plain = prefilter.resize(multiplied, width, height, premultiplied=True, **options)
        plain[..., :-1] /= plain[..., -1:]
        away = np.s_[height // 2 :, width // 2 :]
        np.testing.assert_allclose(found[away], plain[away], rtol=0, atol=4e-6)
        assert found[..., :-1].min() >= -1
        assert found[..., :-1].max() <= 2


def test_an_opaque_image_is_filtered_like_any_other():
    image = image_of(16, 12, 4) * 4 - 1
    image[..., 3] = 1
    for filter in prefilter.RESIZE_FILTERS:
        found = prefilter.resize(image, 7, 5, filter=filter)
        colors = prefilter.resize(image[..., :3], 7, 5, filter=filter)
        np.testing.assert_array_equal(found[..., :3], colors)
        np.testing.assert_array_equal(found[..., 3], 1)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_constrained_values_stay_in_bounds(filter):
    image = image_of(40, 30, 4).round()
    for premultiplied, (width, height) in product((False, True), ((9, 8), (70, 50))):
        found = prefilter.resize(
            image, width, height, filter=filter, constrained=True, premultiplied=premultiplied
        )
        assert found.min() >= 0
        assert found.max() <= 1
    if filter != "least-squares":
        free = prefilter.resize(image, 9, 8, filter=filter, premultiplied=True)
        clipped = prefilter.resize(image, 9, 8, filter=filter, premultiplied=True, constrained=True)
        np.testing.assert_array_equal(clipped, free.clip(0, 1))


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_results_do_not_depend_on_threads(filter):
    image = image_of(150, 131, 4)
    for width, height in ((71, 67), (190, 33)):
        one, two, seven = (
            prefilter.resize(image, width, height, filter=filter, threads=threads)
            for threads in (1, 2, 7)
        )
        np.testing.assert_array_equal(one, two)
        np.testing.assert_array_equal(one, seven)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_progress_rises_to_one(filter):
    seen = []
    prefilter.resize(image_of(300, 200, 4), 170, 130, filter=filter, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    with pytest.raises(prefilter.Cancelled):
        prefilter.resize(image_of(9, 9), 4, 4, filter=filter, progress=lambda f: False)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
@pytest.mark.parametrize("wrap", WRAPS)
def test_extreme_sizes(filter, wrap):
    dot = np.full((1, 1, 1), 0.5, np.float32)
    large = prefilter.resize(dot, 33, 20, filter=filter, wrap=wrap)
    assert large.shape == (20, 33, 1)
    assert np.isfinite(large).all()
    line = image_of(3000, 1)
    one = prefilter.resize(line, 1, 1, filter=filter, wrap=wrap)
    assert one.shape == (1, 1, 1)
    assert np.isfinite(one).all()
    if wrap == "repeat":
        np.testing.assert_allclose(one, line.mean(), rtol=0, atol=2e-3)
    tall = prefilter.resize(line, 2, 500, filter=filter, wrap=wrap)
    assert tall.shape == (500, 2, 1)
    assert np.isfinite(tall).all()


def test_large_values_do_not_overflow():
    image = np.full((8, 8, 1), 1e30, np.float32)
    image[::2] = -1e30
    for filter in prefilter.RESIZE_FILTERS:
        assert np.isfinite(prefilter.resize(image, 5, 11, filter=filter)).all(), filter


def test_float64_and_views_are_read_alike():
    image = image_of(20, 18, 3)
    expected = prefilter.resize(image[::2, ::-1], 6, 5)
    np.testing.assert_array_equal(prefilter.resize(image.astype(float)[::2, ::-1], 6, 5), expected)
    np.testing.assert_array_equal(
        prefilter.resize(image[::2, ::-1].copy(order="F"), np.int64(6), 5), expected
    )
