# SPDX-License-Identifier: GPL-3.0-or-later

"""Laws of tables, levels and samples together: equation 6.3 as images show it."""

import numpy as np
import prefilter
import pytest
import sampling_oracle as oracle
from kernels import FILTERS, weights_at
from scenes import random_image


def dense(image, filter, coordinates, scale):
    """The filter itself, of a repeated image."""
    height, width = image.shape[:2]
    along_x = weights_at(filter, coordinates[:, 0] * width, scale, width, "repeat")
    along_y = weights_at(filter, coordinates[:, 1] * height, scale, height, "repeat")
    return np.einsum("py,yxc,px->pc", along_y, image.astype(float), along_x, optimize=True)


def noise(size, channels, seed=0):
    """Values without any correlation, of mean 0 and variance 1."""
    values = np.random.default_rng(seed).choice([-1, 1], (size, size, channels))
    return values.astype(np.float32)


# Texels of the image, as squares, are too large for the edges of boxes.
@pytest.mark.parametrize("filter", [filter for filter in FILTERS if filter != "box"])
def test_errors_of_samples_of_noise_are_those_of_the_table(filter):
    image = noise(128, 8)
    levels = prefilter.sampling_levels(image, filter, wrap="repeat", premultiplied=True)
    table = prefilter.SamplingTable.build(filter, texels=6, spectrum="white")
    coordinates = np.random.default_rng(1).random((600, 2))
    squares = dict.fromkeys(("table", "trilinear"), 0.0)
    shares, weights = np.polynomial.legendre.leggauss(2)
    for slice in (0, 1):
        for share, weight in zip(shares, weights, strict=True):
            scale = 2.0 ** (2 + (slice + (share + 1) / 2) / 2)
            expected = dense(image, filter, coordinates, scale)
            for name, chosen in (("table", table), ("trilinear", "trilinear")):
                found = prefilter.sample(levels, chosen, coordinates, scale, wrap="repeat")
                # Cells have 8 x 8 texels; the whole domain is eight times the table's part.
                squares[name] += weight / 4 * 64 * np.mean((found - expected) ** 2)
    section = table.section(3)
    assert squares["table"] == pytest.approx(8 * section.errors.sum(), rel=0.1)
    assert squares["trilinear"] == pytest.approx(8 * section.trilinear_errors.sum(), rel=0.1)


@pytest.mark.parametrize(("levels", "scale"), [(1, 1.0), (2, 2**0.37), (2, 2**0.81)])
@pytest.mark.parametrize("filter", FILTERS)
def test_weights_of_the_image_are_as_far_off_as_the_table_says(filter, levels, scale):
    # Every texel of the image is a channel of its own: samples are the weights of texels.
    size = 16
    impulses = np.eye(size * size, dtype=np.float32).reshape(size, size, -1)
    pyramid = prefilter.sampling_levels(impulses, filter, wrap="repeat", premultiplied=True)
    table = prefilter.SamplingTable.build(filter, texels=6, spectrum="white")
    inside = np.random.default_rng(2).random((24, 2))
    coordinates = (8 + 2 ** (levels - 1) * inside) / size
    found = prefilter.sample(pyramid, table, coordinates, scale, wrap="repeat")
    squares = ((found - dense(impulses, filter, coordinates, scale)) ** 2).sum(axis=1)
    section = table.section(levels)
    for (x, y), square in zip(inside, squares, strict=True):
        y, x = sorted((min(x, 1 - x), min(y, 1 - y)))
        f = x * y if levels == 1 else np.log2(scale)
        i, j, k = int(4 * x), int(4 * y), 0 if levels == 1 else int(2 * f)
        part = 3 * k + i * (i + 1) // 2 + j
        weights = section.coefficients[part] @ oracle.terms(1, x, y, f)
        offsets = section.offsets[part].tolist()
        expected = oracle.fields(filter, levels, offsets, x, y, f).error(weights)
        assert square == pytest.approx(expected, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize("filter", FILTERS)
def test_at_centers_of_texels_the_filter_is_the_texel(filter):
    image = random_image(3, 32, 32, 1)
    levels = prefilter.sampling_levels(image, filter, wrap="repeat")
    for level in (1, 2, 3):
        size = 32 >> level
        at = (np.arange(size) + 0.5) / size
        coordinates = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
        expected = levels[level].reshape(-1, 1)
        np.testing.assert_allclose(
            dense(image, filter, coordinates, 2.0**level), expected, rtol=0, atol=2e-5
        )
        found = prefilter.sample(levels, "trilinear", coordinates, 2.0**level, wrap="repeat")
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


def test_shifted_images_have_shifted_samples():
    levels = prefilter.sampling_levels(random_image(4, 32, 32, 1), "lanczos2", wrap="repeat")
    shifted = [np.roll(level, len(level) // 4, axis=1) for level in levels]
    random = np.random.default_rng(5)
    coordinates, scales = random.random((400, 2)), 2 ** random.uniform(-1, 3, 400)
    for texels in (4, 8):
        table = prefilter.SamplingTable.standard("lanczos2", texels)
        found = prefilter.sample(levels, table, coordinates, scales, wrap="repeat")
        there = coordinates + np.array((0.25, 0))
        again = prefilter.sample(shifted, table, there, scales, wrap="repeat")
        np.testing.assert_allclose(again, found, rtol=0, atol=2e-6)
