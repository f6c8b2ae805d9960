# SPDX-License-Identifier: GPL-3.0-or-later

"""The fit for readers that decode after the lookup, against dense quadrature and a dense solver."""

import numpy as np
import prefilter
import pytest
from scenes import bilinear, bilinear_taps, random_image, random_soup, square, surface_samples

CLAMP = ("clamp", "clamp")


def decode(encoded):
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def encode(linear):
    return np.where(
        linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )


def shown(image, uvs):
    """Cycles' values of an 8-bit sRGB image."""
    return decode(bilinear(encode(image.astype(np.float64)), uvs, CLAMP))


def stripes(size, seed):
    """Fine detail of high contrast, where the curve matters most."""
    image = 0.02 + 0.9 * (random_image(seed, size, size, 3) > 0.6)
    return image.astype(np.float32)


@pytest.mark.parametrize("size", [(16, 16), (9, 14)])
def test_error_is_that_of_decoded_lookups(size):
    mesh = random_soup(13, 7)
    image = random_image(8, *size, 3)
    levels = prefilter.mipmaps(image, mesh.surface, filter="box")
    values = [0.0, 1.0, 1.4, 2.0]
    found = prefilter.mipmap_error(levels, image, mesh.surface, values, reader="srgb-after")
    uvs, weights = surface_samples(mesh, 200)
    source = shown(image, uvs)
    assert found[0] == pytest.approx(0.0, abs=1e-6)
    for value, error in zip(values[1:], found[1:], strict=True):
        k, f = int(value), value % 1
        lookup = (1 - f) * shown(levels[k], uvs) + f * shown(levels[k + 1], uvs)
        squared = ((lookup - source) ** 2).mean(axis=1)
        assert error == pytest.approx(np.sqrt((squared * weights).sum() / weights.sum()), rel=5e-3)


def test_fourth_channel_is_not_encoded():
    surface = square().surface
    image = random_image(8, 16, 16, 4)
    alpha = np.ascontiguousarray(image[..., 3:])
    for reader in ("linear", "srgb-after"):
        levels = prefilter.mipmaps(image, surface, reader=reader, premultiplied=True)
        alone = prefilter.mipmaps(alpha, surface)
        for level, expected in zip(levels, alone, strict=True):
            np.testing.assert_allclose(level[..., 3:], expected, atol=1e-5)


@pytest.mark.parametrize("seed", [1, 2])
def test_levels_are_as_good_as_those_of_a_dense_solver(seed):
    optimize = pytest.importorskip("scipy.optimize")
    mesh = random_soup(seed, 12)
    image = np.ascontiguousarray(stripes(16, seed)[..., :1])
    levels = prefilter.mipmaps(image, mesh.surface, reader="srgb-after")
    uvs, weights = surface_samples(mesh, 24)
    source = shown(image, uvs)[:, 0]
    taps, shares = bilinear_taps(uvs, 8, 8, CLAMP)
    scale = np.sqrt(weights / weights.sum())

    def residual(texels):
        return scale * (decode((texels[taps] * shares).sum(1)) - source)

    def jacobian(texels):
        value = (texels[taps] * shares).sum(1)
        slope = np.where(
            value <= 0.04045, 1 / 12.92, 2.4 / 1.055 * ((value + 0.055) / 1.055) ** 1.4
        )
        matrix = np.zeros((len(uvs), 64))
        np.add.at(matrix, (np.arange(len(uvs))[:, None], taps), shares * (scale * slope)[:, None])
        return matrix

    ours = encode(levels[1][..., 0].astype(np.float64)).ravel()
    best = optimize.least_squares(
        residual, np.clip(ours, 1e-6, 1 - 1e-6), jacobian, bounds=(0.0, 1.0), max_nfev=60
    )
    linear = prefilter.mipmaps(image, mesh.surface)[1]
    start = (residual(encode(linear[..., 0].astype(np.float64)).ravel()) ** 2).sum()
    reached = (residual(ours) ** 2).sum()
    least = 2 * best.cost
    assert least < 0.97 * start, "the case must tell this fit from the linear one"
    assert reached - least < 0.05 * (start - least)


def test_it_beats_every_other_filter_for_its_reader():
    mesh = random_soup(4, 30)
    image = stripes(64, 5)
    value = np.arange(1, 6)

    def error(filter, reader):
        levels = prefilter.mipmaps(image, mesh.surface, filter=filter, reader=reader)
        return prefilter.mipmap_error(levels, image, mesh.surface, value, reader="srgb-after")

    ours = error("pam-bilinear", "srgb-after")
    for filter in ("box", "tent", "lanczos3", "box-covered", "pam-box", "pam-bilinear"):
        assert (ours < error(filter, "linear")).all(), filter


@pytest.mark.parametrize("bounds", [(0.0, 1.0), (0.2, 0.6), (0.0, None), None])
def test_bounds_hold(bounds):
    levels = prefilter.mipmaps(
        stripes(32, 6), random_soup(5, 20).surface, reader="srgb-after", bounds=bounds
    )
    low, high = bounds or (None, None)
    for level in levels[1:]:
        assert np.isfinite(level).all()
        assert low is None or level.min() >= np.float32(low)
        assert high is None or level.max() <= np.float32(high)


def test_a_constant_stays():
    image = np.full((32, 20, 3), [0.7, 0.01, 0.2], np.float32)
    for level in prefilter.mipmaps(image, random_soup(6, 9).surface, reader="srgb-after"):
        np.testing.assert_allclose(level, np.broadcast_to(image[0, 0], level.shape), rtol=1e-5)


def test_results_do_not_depend_on_threads():
    image = stripes(100, 7)
    surface = random_soup(7, 40, -0.3, 1.3).surface
    one, many = (
        prefilter.mipmaps(image, surface, reader="srgb-after", wrap="repeat", threads=threads)
        for threads in (1, 4)
    )
    for a, b in zip(one, many, strict=True):
        np.testing.assert_array_equal(a, b)
