# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of bytes: levels equal the levels of the values they encode, to the nearest byte."""

import numpy as np
import prefilter
import pytest
from scenes import random_soup

SURFACE = random_soup(3, 20).surface
FILTERS = ["box", "tent-covered", "pam-box", "pam-bilinear", "pam-trilinear"]


def random_bytes(seed: int, *shape: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, shape, np.uint8)


def values(image: np.ndarray, encoding: str) -> np.ndarray:
    scaled = image.astype(np.float32) / np.float32(255)
    return prefilter.to_linear(scaled) if encoding == "srgb" else scaled


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("premultiplied", [False, True])
def test_levels_are_those_of_the_values(filter, encoding, channels, premultiplied):
    image = random_bytes(1, 33, 40, channels)
    options = {"filter": filter, "premultiplied": premultiplied}
    levels = prefilter.mipmaps(image, SURFACE, encoding=encoding, **options)
    expected = prefilter.mipmaps(values(image, encoding), SURFACE, **options)
    np.testing.assert_array_equal(levels[0], image)
    assert not np.shares_memory(levels[0], image)
    for level, of_values in zip(levels, expected, strict=True):
        assert level.dtype == np.uint8
        encoded = prefilter.to_srgb(of_values) if encoding == "srgb" else of_values
        # A value in the middle between two bytes may go either way.
        assert np.abs(level - 255.0 * encoded).max() <= 0.5 + 1e-3


@pytest.mark.parametrize("options", [{"reader": "srgb-after"}, {"seam_budget": 0.01}])
def test_options_that_need_floats(options):
    image = random_bytes(2, 32, 32, 3)
    levels = prefilter.mipmaps(image, SURFACE, encoding="srgb", **options)
    expected = prefilter.mipmaps(values(image, "srgb"), SURFACE, **options)
    for level, of_values in zip(levels, expected, strict=True):
        assert np.abs(level - 255.0 * prefilter.to_srgb(of_values)).max() <= 0.5 + 1e-3


def test_opaque_alpha_is_no_alpha():
    image = random_bytes(3, 32, 32, 4)
    image[..., 3] = 255
    levels = prefilter.mipmaps(image, SURFACE)
    for level, alone in zip(levels, prefilter.mipmaps(image[..., :3], SURFACE), strict=True):
        np.testing.assert_array_equal(level[..., :3], alone)
        assert (level[..., 3] == 255).all()


@pytest.mark.parametrize("threads", [1, 3])
def test_results_do_not_depend_on_threads(threads):
    image = random_bytes(5, 100, 90, 3)
    for a, b in zip(
        prefilter.mipmaps(image, SURFACE, threads=1),
        prefilter.mipmaps(image, SURFACE, threads=threads),
        strict=True,
    ):
        np.testing.assert_array_equal(a, b)
