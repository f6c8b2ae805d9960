# SPDX-License-Identifier: GPL-3.0-or-later

"""The exact filters, against dense sums of their closed forms."""

from itertools import product

import numpy as np
import prefilter
import pytest
from kernels import FILTERS, tolerance_of, weights_at
from scenes import random_image

WRAPS = ("clamp", "repeat", "border")
# In units of the image, and where it is the same to them: half a million texels away.
PLACES = np.array([(0.5, 0.5), (0.013, 0.97), (-0.4, 1.3), (2.125, -1.75), (0.0, 1.0)])


def expected_samples(image, places, scales, filter, wrap):
    height, width, _ = image.shape
    expected = []
    for (u, v), scale in zip(places, scales, strict=True):
        along_x = weights_at(filter, u * width, max(1.0, scale), width, wrap[0])
        along_y = weights_at(filter, v * height, max(1.0, scale), height, wrap[1])
        expected.append(np.einsum("jy,ix,yxc->c", along_y, along_x, image.astype(float)))
    return np.array(expected)


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("wrap", list(product(WRAPS, WRAPS)))
def test_samples_are_sums_of_the_closed_form(filter, wrap):
    # Scales from magnification to some dozen images wide, where the taps are not found one by one.
    scales = [0.0, 0.7, 1.0, 1.3, 2.0, 5.5, 17.3, 70.0, 150.25]
    for channels, (width, height) in zip(
        (1, 2, 3, 4, 5), [(8, 8), (7, 3), (1, 5), (13, 1), (1, 1)], strict=True
    ):
        image = random_image(channels, height, width, channels)
        places = np.repeat(PLACES, len(scales), axis=0)
        widths = np.tile(scales, len(PLACES))
        found = prefilter.sample_exact(image, places, widths, filter=filter, wrap=wrap)
        assert found.dtype == np.float32
        expected = expected_samples(image, places, widths, filter, wrap)
        np.testing.assert_allclose(found, expected, rtol=0, atol=4 * tolerance_of(filter))


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("wrap", WRAPS)
def test_wide_kernels_are_the_sums_of_their_taps(filter, wrap):
    """Kernels 20 to 5000 images wide: the closed form of a progression against all its terms."""
    image = random_image(7, 1, 16, 1)
    for scale in (340.0, 1111.1, 80_000.0):
        found = prefilter.sample_exact(image, [(0.3, 0.5)], scale, filter=filter, wrap=wrap)
        weights = weights_at(filter, 0.3 * 16, scale, 16, wrap)
        across = weights_at(filter, 0.5, scale, 1, wrap)
        expected = (weights @ image[0]) * across.sum()
        np.testing.assert_allclose(found, expected, rtol=0, atol=2 * tolerance_of(filter))


@pytest.mark.parametrize("filter", FILTERS)
def test_enormous_scales_see_the_mean_or_the_edges(filter):
    image = random_image(8, 6, 12, 2)
    for scale in (1e7, 1e30, 1e300):
        repeated = prefilter.sample_exact(image, [(0.2, 0.9)], scale, filter=filter, wrap="repeat")
        np.testing.assert_allclose(repeated[0], image.mean(axis=(0, 1)), atol=1e-5)
        clamped = prefilter.sample_exact(image, [(0.2, 0.9)], scale, filter=filter)
        corners = image[[0, 0, -1, -1], [0, -1, 0, -1]]
        np.testing.assert_allclose(clamped[0], corners.mean(axis=0), atol=1e-4)
        border = prefilter.sample_exact(image, [(0.2, 0.9)], scale, filter=filter, wrap="border")
        np.testing.assert_allclose(border, 0, atol=1e-10)


def test_far_places_are_wrapped():
    image = random_image(9, 4, 8, 3)
    near = prefilter.sample_exact(image, [(0.125, 0.25)], 2.5, wrap="repeat")
    far = prefilter.sample_exact(image, [(2.0**40 + 0.125, 0.25 - 2.0**40)], 2.5, wrap="repeat")
    np.testing.assert_array_equal(near, far)
    far = prefilter.sample_exact(image, [(1e300, -1e300)], 2.5)
    np.testing.assert_allclose(far[0], image[0, -1], rtol=1e-6)
    assert not prefilter.sample_exact(image, [(1e300, -1e300)], 2.5, wrap="border").any()


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("wrap", WRAPS)
def test_at_whole_ratios_samples_are_the_image_resized(filter, wrap):
    image = random_image(10, 12, 18, 3)
    resized = prefilter.resize(image, 6, 4, filter=filter, wrap=wrap)
    v, u = np.meshgrid((np.arange(4) + 0.5) / 4, (np.arange(6) + 0.5) / 6, indexing="ij")
    places = np.stack([u, v], axis=-1).reshape(-1, 2)
    found = prefilter.sample_exact(image, places, 3.0, filter=filter, wrap=wrap)
    np.testing.assert_allclose(found.reshape(4, 6, 3), resized, atol=5e-7)


@pytest.mark.parametrize("filter", FILTERS)
def test_samples_at_texels_are_the_levels(filter):
    image = random_image(11, 16, 8, 2)
    for k, level in enumerate(prefilter.sampling_levels(image, filter, premultiplied=True)[:4]):
        height, width, _ = level.shape
        v, u = np.meshgrid(
            (np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij"
        )
        places = np.stack([u, v], axis=-1).reshape(-1, 2)
        found = prefilter.sample_exact(image, places, 2.0**k, filter=filter)
        np.testing.assert_allclose(found.reshape(level.shape), level, atol=5e-7)


def brute_force_ewa(image, place, jacobian, wrap):
    height, width, _ = image.shape
    u, sizes, _ = np.linalg.svd(jacobian)
    last = (max(width, height) - 1).bit_length()
    sizes = np.clip(sizes, 1.0, 2.0**last)
    inverse = u @ np.diag(sizes**-2.0) @ u.T
    reach = int(3 * sizes.max()) + 2
    center = np.array(place) * (width, height)
    x, y = (np.arange(int(c) - reach, int(c) + reach + 1) for c in center)
    dx, dy = x + 0.5 - center[0], (y + 0.5 - center[1])[:, None]
    form = inverse[0, 0] * dx**2 + 2 * inverse[0, 1] * dx * dy + inverse[1, 1] * dy**2
    weights = np.exp(-np.pi * form)
    inside = np.ones_like(weights)
    if wrap == "repeat":
        x, y = x % width, y % height
    elif wrap == "border":
        inside = (x >= 0) & (x < width) & (y >= 0)[:, None] & (y < height)[:, None]
    texels = image[np.clip(y, 0, height - 1)][:, np.clip(x, 0, width - 1)]
    return np.einsum("yx,yxc->c", weights * inside, texels) / weights.sum()


JACOBIANS = np.array(
    [
        [(1, 0), (0, 1)],
        [(3, 0), (0, 1)],
        [(1, 2), (0.5, 3)],
        [(0, -4), (1.5, 0)],
        [(0, 0), (0, 0)],
        [(0.1, 0.1), (0.2, 0)],
        [(5, 5), (5, 5)],
        [(400, 3), (-2, 1)],
        [(-2, 2.5), (2.5, -2)],
    ],
    float,
)


@pytest.mark.parametrize("wrap", WRAPS)
def test_ewa_is_the_elliptical_gaussian(wrap):
    for channels, (width, height) in zip((1, 3, 5), [(16, 16), (9, 5), (1, 3)], strict=True):
        image = random_image(20 + channels, height, width, channels)
        for place in PLACES:
            found = prefilter.sample_ewa(image, [place] * len(JACOBIANS), JACOBIANS, wrap=wrap)
            expected = [brute_force_ewa(image, place, jacobian, wrap) for jacobian in JACOBIANS]
            np.testing.assert_allclose(found, expected, rtol=0, atol=3e-7)


@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("scale", [1.0, 2.7, 6.0])
def test_a_round_ellipse_is_the_gaussian(angle, scale):
    image = random_image(30, 32, 32, 3)
    turn = np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])
    places = np.random.default_rng(31).random((50, 2))
    found = prefilter.sample_ewa(image, places, np.tile(scale * turn, (50, 1, 1)))
    expected = prefilter.sample_exact(image, places, scale, filter="gaussian")
    # The fit of the kernel, and its end at 3.5e-6.
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-5)


def test_ewa_shares_the_rows_of_a_large_image():
    """An image summed in parts, also far outside of it and with extreme Jacobians."""
    image = np.zeros((700, 600, 1), np.float32)
    image[::2] = 1
    found = prefilter.sample_ewa(
        image, [(0.5, 0.5), (0.5, 0.5), (1e300, 0.5)], [np.eye(2) * s for s in (40.0, 1e300, 1e290)]
    )
    np.testing.assert_allclose(found[:2], 0.5, atol=1e-3)
    assert np.isfinite(found).all()


@pytest.mark.parametrize("function", [prefilter.sample_exact, prefilter.sample_ewa])
def test_laws(function):
    image = random_image(40, 40, 24, 4)
    places = np.random.default_rng(41).uniform(-1, 2, (300, 2))
    shapes = np.random.default_rng(42).uniform(0, 9, (300, 2, 2))
    if function is prefilter.sample_exact:
        shapes = shapes[:, 0, 0].copy()
    one, four = (function(image, places, shapes, threads=n) for n in (1, 4))
    np.testing.assert_array_equal(one, four)
    constant = np.full((5, 7, 1), 0.7, np.float32)
    np.testing.assert_array_equal(function(constant, places, shapes), np.float32(0.7))
    bytes_ = np.random.default_rng(43).integers(0, 256, (9, 9, 3), np.uint8)
    np.testing.assert_array_equal(
        function(bytes_, places, shapes), function(bytes_ / np.float32(255), places, shapes)
    )
    assert function(image, places[:0], shapes[:0]).shape == (0, 4)
    told = []
    function(image, places, shapes, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(prefilter.Cancelled):
        function(image, places, shapes, progress=lambda _: False)
