# SPDX-License-Identifier: GPL-3.0-or-later

"""Samples of mipmaps, against sums texel by texel from the tables' weights."""

from itertools import product
from math import ceil, floor, log2

import numpy as np
import prefilter
import pytest
from scenes import random_image

WRAPS = ("clamp", "repeat", "border")
SIZES = [(16, 16), (13, 6), (1, 7), (37, 1), (1, 1)]
SHAPES = [(8, (4, 4, 2), 1), (5, (3, 3, 2), 2), (4, (1, 1, 1), 1), (11, (5, 5, 3), 1)]
TABLES = [
    prefilter.SamplingTable.build("tent", texels=texels, subdomains=subdomains, degree=degree)
    for texels, subdomains, degree in SHAPES
]
EIGHT = TABLES[0]


def levels_of(width, height, channels=1, seed=0):
    """Unrelated random levels."""
    count = max(width, height).bit_length()
    sizes = [(max(1, height >> k), max(1, width >> k)) for k in range(count)]
    return [random_image(seed + k, *size, channels) for k, size in enumerate(sizes)]


def places(count, seed=0, low=-0.6, high=1.6):
    return np.random.default_rng(seed).uniform(low, high, (count, 2))


def scales_of(count, levels, seed=1):
    return 2 ** np.random.default_rng(seed).uniform(-1, levels + 0.5, count)


def extents_of(levels):
    """How many texels of each level the image takes along x and y: sides rounded up nest."""
    sides = np.array([level.shape[1::-1] for level in levels])
    steps = 2.0 ** np.arange(len(levels))[:, None]
    nest = (sides == np.ceil(sides[0] / steps)).all(axis=0)
    return np.where(nest, sides[0] / steps, sides)


def texel(level, extent, x, y, wrap):
    index = []
    for axis, place in ((1, y), (0, x)):
        size, mode = level.shape[1 - axis], wrap[axis]
        inside = 0 <= place < size
        if mode == "border" and not inside:
            return np.zeros(level.shape[2])
        if mode == "repeat" and not inside:
            place = floor((place + 0.5) % extent[axis])  # the nearest where no period fits
        index.append(min(max(place, 0), size - 1))
    return level[tuple(index)].astype(float)


def in_image(place, wrap):
    return np.where(np.array(wrap) == "repeat", place % 1.0, place)


def mip_place(scale, last):
    """The coarser level, how many are available, and the share of the coarser one."""
    if scale <= 1 or last == 0:
        return 0, 1, 0.0
    finer = min(ceil(log2(scale)) - 1, last - 1)
    return finer + 1, min(finer + 2, 3), min(log2(scale) - finer, 1.0)


def weights_of(coefficients, x, y, f):
    terms = [1, x, y, f, x * x, y * y, f * f, x * y, x * f, y * f]
    return coefficients @ terms[: coefficients.shape[1]]


def by_table(levels, table, place, scale, wrap):
    cell, available, f = mip_place(scale, len(levels) - 1)
    section = table.section(available)
    grid, _, slices = table.subdomains
    columns = (grid + 1) // 2
    slices = 1 if available == 1 else slices
    extents = extents_of(levels)
    place = in_image(place, wrap)
    at = place * extents[cell]
    inside = at - np.floor(at)
    # Around the cell's center the symmetries are signs and a swap.
    signs = np.where(inside > 0.5, -1, 1)
    folded = 0.5 + (inside - 0.5) * signs
    swapped = folded[1] > folded[0]
    x, y = sorted(folded, reverse=True)
    i, j = (min(floor(grid * one), columns - 1) for one in (x, y))
    k = min(floor(f * slices), slices - 1)
    subdomain = k * columns * (columns + 1) // 2 + i * (i + 1) // 2 + j
    found = np.zeros(levels[0].shape[2])
    weights = weights_of(section.coefficients[subdomain], x, y, x * y if available == 1 else f)
    for (finer, *offset), weight in zip(section.offsets[subdomain], weights, strict=True):
        center = (np.array(offset) + 0.5) / 2**finer - 0.5
        center = 0.5 + (center[::-1] if swapped else center) * signs
        level, extent = levels[cell - finer], extents[cell - finer]
        base = np.floor(place * extent - 2**finer * inside + 0.5)
        corner = base + np.floor(center * 2**finer)
        found += weight * texel(level, extent, *corner.astype(int), wrap)
    return found


def bilinear(level, extent, place, wrap):
    x, y = place * extent - 0.5
    found = np.zeros(level.shape[2])
    for i, j in product(range(floor(x), floor(x) + 2), range(floor(y), floor(y) + 2)):
        found += (1 - abs(x - i)) * (1 - abs(y - j)) * texel(level, extent, i, j, wrap)
    return found


def trilinear(levels, place, scale, wrap):
    coarse, available, f = mip_place(scale, len(levels) - 1)
    place = in_image(place, wrap)
    of_level = [
        bilinear(*pair, place, wrap) for pair in zip(levels, extents_of(levels), strict=True)
    ]
    if available == 1:
        return of_level[0]
    return f * of_level[coarse] + (1 - f) * of_level[coarse - 1]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("table", TABLES)
def test_samples_are_the_sums_that_the_table_says(table, size):
    for k, wrap in enumerate(product(WRAPS, WRAPS)):
        levels = levels_of(*size, 1 + k % 5, seed=k)
        coordinates, scales = places(40, k), scales_of(40, len(levels), k)
        found = prefilter.sample(levels, table, coordinates, scales, wrap=wrap)
        assert found.dtype == np.float32
        expected = [
            by_table(levels, table, place, scale, wrap)
            for place, scale in zip(coordinates, scales, strict=True)
        ]
        np.testing.assert_allclose(found, expected, rtol=0, atol=2e-5)


@pytest.mark.parametrize("size", SIZES)
def test_trilinear_samples_are_those_of_two_levels(size):
    for k, wrap in enumerate(product(WRAPS, WRAPS)):
        levels = levels_of(*size, 1 + k % 5, seed=k)
        coordinates, scales = places(40, k), scales_of(40, len(levels), k)
        found = prefilter.sample(levels, "trilinear", coordinates, scales, wrap=wrap)
        expected = [
            trilinear(levels, place, scale, wrap)
            for place, scale in zip(coordinates, scales, strict=True)
        ]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize("table", [*TABLES, "trilinear"])
@pytest.mark.parametrize("wrap", ["clamp", "repeat", ("repeat", "clamp")])
def test_what_is_constant_stays(table, wrap):
    for channels in (1, 3, 4, 6):
        levels = [np.full_like(level, 0.7) for level in levels_of(37, 21, channels)]
        found = prefilter.sample(levels, table, places(500), scales_of(500, 7), wrap=wrap)
        np.testing.assert_allclose(found, 0.7, rtol=0, atol=1e-6)


@pytest.mark.parametrize("table", [*TABLES, "trilinear"])
def test_bytes_are_255ths(table):
    for channels in (1, 2, 3, 4, 7):
        levels = [np.rint(255 * level).astype(np.uint8) for level in levels_of(37, 21, channels)]
        floats = [level / np.float32(255) for level in levels]
        given = (places(500), scales_of(500, 7))
        np.testing.assert_allclose(
            prefilter.sample(levels, table, *given),
            prefilter.sample(floats, table, *given),
            rtol=0,
            atol=1e-6,
        )


@pytest.mark.parametrize("table", [EIGHT, "trilinear"])
def test_threads_change_no_bit(table):
    levels = levels_of(64, 64, 4)
    given = (levels, table, places(30000), scales_of(30000, 7))
    found = prefilter.sample(*given, threads=1)
    np.testing.assert_array_equal(prefilter.sample(*given, threads=3), found)
    # Nor does what else is sampled.
    part = prefilter.sample(levels, table, given[2][777:1001], given[3][777:1001])
    np.testing.assert_array_equal(part, found[777:1001])


@pytest.mark.parametrize("table", [*TABLES, "trilinear"])
def test_one_scale_is_that_of_all(table):
    levels = levels_of(16, 16, 4)
    for scale in (0, 1, 1.3, 2, 4, 3.9999999, 700.0, 1e300):
        np.testing.assert_array_equal(
            prefilter.sample(levels, table, places(100), scale),
            prefilter.sample(levels, table, places(100), np.full(100, scale)),
        )


@pytest.mark.parametrize("table", [*TABLES, "trilinear"])
def test_an_image_mirrored_or_transposed_gives_the_same(table):
    levels = levels_of(32, 32, 4)
    coordinates, scales = places(300, low=0, high=1), scales_of(300, 6)
    found = prefilter.sample(levels, table, coordinates, scales)
    mirrored = [level[:, ::-1] for level in levels]
    transposed = [level.swapaxes(0, 1) for level in levels]
    for images, there in (
        (mirrored, coordinates * (-1, 1) + (1, 0)),
        (transposed, coordinates[:, ::-1]),
    ):
        np.testing.assert_allclose(
            prefilter.sample(images, table, there, scales), found, rtol=0, atol=1e-5
        )


@pytest.mark.parametrize("table", [*TABLES, "trilinear"])
def test_far_outside(table):
    levels = levels_of(16, 8, 4)
    scales = scales_of(200, 5)
    far = places(200) * (1e12, 1e-300)
    np.testing.assert_array_equal(prefilter.sample(levels, table, far, scales, wrap="border"), 0.0)
    for u in (-1e308, 1e308):
        edge = [level[:, [0 if u < 0 else -1]].repeat(level.shape[1], 1) for level in levels]
        there = np.column_stack([np.full(200, u), places(200)[:, 1]])
        np.testing.assert_allclose(
            prefilter.sample(levels, table, there, scales),
            prefilter.sample(edge, table, there * (0, 1), scales),
            rtol=0,
            atol=1e-5,
        )
    near = np.random.default_rng(3).integers(0, 4096, (200, 2)) / 4096
    np.testing.assert_array_equal(
        prefilter.sample(levels, table, near + np.array([2**30, -(2**20)]), scales, wrap="repeat"),
        prefilter.sample(levels, table, near, scales, wrap="repeat"),
    )


@pytest.mark.parametrize("table", [EIGHT, "trilinear"])
def test_nothing_and_no_order(table):
    levels = levels_of(8, 8, 3)
    empty = prefilter.sample(levels, table, np.zeros((0, 2)), np.zeros(0))
    assert empty.shape == (0, 3)
    assert prefilter.sample(levels, table, np.zeros((0, 2)), 2.0).shape == (0, 3)
    strided = [level[::-1, ::-1] for level in levels]
    copied = [np.ascontiguousarray(level) for level in strided]
    given = (places(50), scales_of(50, 4))
    np.testing.assert_array_equal(
        prefilter.sample(strided, table, *given), prefilter.sample(copied, table, *given)
    )


def test_levels_may_be_left_out_and_rounded_up():
    levels = [random_image(k, size, size, 2) for k, size in enumerate((13, 7, 4, 2))]
    for k, table in enumerate([*TABLES, "trilinear"]):
        coordinates, scales = places(40, k), scales_of(40, len(levels), k)
        found = prefilter.sample(levels, table, coordinates, scales, wrap="repeat")
        for one, place, scale in zip(found, coordinates, scales, strict=True):
            given = (place, scale, ("repeat", "repeat"))
            by_levels = k == len(TABLES)
            expected = trilinear(levels, *given) if by_levels else by_table(levels, table, *given)
            np.testing.assert_allclose(one, expected, rtol=0, atol=2e-5)


def test_a_cancel_is_heard():
    levels = levels_of(8, 8)
    with pytest.raises(prefilter.Cancelled):
        prefilter.sample(levels, EIGHT, places(10000), 2.0, progress=lambda _: False)
