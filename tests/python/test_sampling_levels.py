# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels that tables fit, against dense sums of the kernels' closed forms."""

import copy
import pickle
from itertools import product

import numpy as np
import prefilter
import pytest
from kernels import FILTERS, tolerance_of, weights_at
from scenes import random_image

WRAPS = ("clamp", "repeat", "border")
SIZES = [(8, 8), (13, 6), (1, 7), (5, 1), (1, 1)]


def weights_of_nested(filter, size, level, wrap):
    """Weights of texels 2^level times as wide, as many as cover an axis."""
    width = 2**level
    centers = (np.arange(-(-size // width)) + 0.5) * width
    return weights_at(filter, centers, width, size, wrap)


def test_there_is_a_filter_for_each_kernel():
    assert set(prefilter.SAMPLING_FILTERS) == set(FILTERS)


@pytest.mark.parametrize("filter", FILTERS)
def test_levels_are_the_kernel_at_the_centers_of_their_texels(filter):
    for k, (width, height) in enumerate(SIZES):
        image = random_image(k, height, width, 1 + k)
        for wrap in product(WRAPS, WRAPS):
            levels = prefilter.sampling_levels(image, filter, wrap=wrap, premultiplied=True)
            assert levels.filter == filter
            assert len(levels) == (max(width, height) - 1).bit_length() + 1
            for level, found in enumerate(levels):
                expected = np.einsum(
                    "jy,ix,yxc->jic",
                    weights_of_nested(filter, height, level, wrap[1]),
                    weights_of_nested(filter, width, level, wrap[0]),
                    image.astype(float),
                )
                assert found.dtype == np.float32
                # Values are around 1, and the filters' absolute weights sum to 1.6 at most.
                np.testing.assert_allclose(found, expected, rtol=0, atol=4 * tolerance_of(filter))


@pytest.mark.parametrize("filter", ["box", "tent", "lanczos2", "lanczos3"])
def test_level_0_of_kernels_that_interpolate_is_the_image(filter):
    image = random_image(0, 5, 9, 3)
    np.testing.assert_array_equal(prefilter.sampling_levels(image, filter)[0], image)


@pytest.mark.parametrize("filter", FILTERS)
def test_where_sizes_change_they_are_the_mipmaps_of_the_kernel(filter):
    image = random_image(1, 12, 16, 3)
    levels = prefilter.sampling_levels(image, filter)
    for ours, theirs in zip(
        levels[1:3], prefilter.mipmaps(image, filter=filter, bounds=None)[1:3], strict=True
    ):
        np.testing.assert_array_equal(ours, theirs)


def test_any_number_of_channels_is_filtered_channel_by_channel():
    image = random_image(2, 6, 10, 11)
    together = prefilter.sampling_levels(image)
    for c in range(11):
        alone = prefilter.sampling_levels(image[..., c : c + 1])
        for ours, theirs in zip(together, alone, strict=True):
            np.testing.assert_array_equal(ours[..., c : c + 1], theirs)


@pytest.mark.parametrize("channels", [2, 4])
def test_straight_colors_are_multiplied_by_alpha(channels):
    image = random_image(3, 8, 8, channels)
    image[..., -1] = image[..., -1] * 1.5 - 0.25  # below 0 and above 1 too
    multiplied = image.copy()
    multiplied[..., -1] = np.clip(image[..., -1], 0, 1)
    multiplied[..., :-1] *= multiplied[..., -1:]
    expected = prefilter.sampling_levels(multiplied, premultiplied=True)
    for ours, theirs in zip(prefilter.sampling_levels(image), expected, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_bytes_are_255ths():
    image = np.random.default_rng(4).integers(0, 256, (7, 9, 3), np.uint8)
    expected = prefilter.sampling_levels(image.astype(np.float32) / 255)
    for ours, theirs in zip(prefilter.sampling_levels(image), expected, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_fewer_levels_are_the_first_of_all():
    image = random_image(5, 16, 16, 1)
    for ours, theirs in zip(
        prefilter.sampling_levels(image, levels=3),
        prefilter.sampling_levels(image)[:3],
        strict=True,
    ):
        np.testing.assert_array_equal(ours, theirs)


def test_nothing_depends_on_the_number_of_threads():
    image = random_image(6, 33, 65, 4)
    one, four = (prefilter.sampling_levels(image, "lanczos3", threads=n) for n in (1, 4))
    for ours, theirs in zip(one, four, strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("filter", ["tent", "tent-covered", "pam-bilinear"])
@pytest.mark.parametrize("dtype", [np.float32, np.uint8])
def test_mipmaps_know_their_filter(filter, dtype):
    surface = prefilter.Surface(
        np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)]),
        np.array([(0, 1, 2)]),
        np.array([[(0.0, 0), (1, 0), (0, 1)]]),
    )
    levels = prefilter.mipmaps(np.ones((4, 4, 3), dtype), surface, filter=filter)
    assert isinstance(levels, list)
    assert levels.filter == filter
    assert copy.copy(levels).filter == copy.deepcopy(levels).filter == filter
    assert pickle.loads(pickle.dumps(levels)).filter == filter


def test_progress_rises_to_1_and_a_cancel_is_heard():
    told = []
    for channels in (3, 9):
        told.clear()
        prefilter.sampling_levels(random_image(7, 64, 64, channels), progress=told.append)
        assert told == sorted(told)
        assert told[-1] == 1.0
        with pytest.raises(prefilter.Cancelled):
            prefilter.sampling_levels(random_image(7, 64, 64, channels), progress=lambda _: False)
