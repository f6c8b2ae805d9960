# SPDX-License-Identifier: GPL-3.0-or-later

"""Samples of a single texel, whose mean is the weighted sum."""

import numpy as np
import prefilter
import pytest
from scenes import random_image

NUMBERS = 4096
STRATA = (np.arange(NUMBERS) + 0.5) / NUMBERS
TABLES = {
    "lanczos2": prefilter.SamplingTable.standard("lanczos2"),
    "tent": prefilter.SamplingTable.standard("tent", 4),
    "trilinear": "trilinear",
}
PLACES = np.array([(0.31, 0.62), (0.5, 0.5), (0.99, 0.03), (-0.2, 3.3)])
SCALES = (0.5, 1.0, 1.9, 3.3, 30.0)


def levels_for(name, **options):
    filter = "lanczos2" if name == "trilinear" else name
    return prefilter.sampling_levels(random_image(0, 16, 32, 3), filter, **options)


@pytest.mark.parametrize("wrap", ["clamp", "repeat", "border"])
@pytest.mark.parametrize("name", TABLES)
def test_the_mean_is_the_sample(name, wrap):
    levels, table = levels_for(name, wrap=wrap), TABLES[name]
    for scale in SCALES:
        for place in PLACES:
            one_each = prefilter.sample_stochastic(
                levels, table, np.tile(place, (NUMBERS, 1)), scale, STRATA, wrap=wrap
            )
            expected = prefilter.sample(levels, table, [place], scale, wrap=wrap)
            # Each of the texels is picked once too often or too rarely at the most.
            largest = np.abs(one_each).max()
            np.testing.assert_allclose(
                one_each.mean(axis=0), expected[0], rtol=0, atol=8 * largest / NUMBERS + 1e-6
            )


@pytest.mark.parametrize("wrap", ["clamp", "repeat", "border"])
def test_bilinear_reads_the_nearest_level(wrap):
    levels = prefilter.sampling_levels(random_image(1, 32, 32, 3), "tent", wrap=wrap)
    for scale, level in ((0.0, 0), (1.4, 0), (1.5, 1), (2.8, 1), (3.0, 2), (1e9, 5)):
        for place in PLACES:
            places = np.tile(place, (NUMBERS, 1))
            found = prefilter.sample_stochastic(
                levels, "bilinear", places, scale, STRATA, wrap=wrap
            )
            expected = prefilter.sample(
                levels[level : level + 1], "trilinear", [place], 1, wrap=wrap
            )
            np.testing.assert_allclose(found.mean(axis=0), expected[0], atol=4 / NUMBERS)
            picked = prefilter.pick_texels(levels, "bilinear", places, scale, STRATA, wrap=wrap)
            assert (picked.texels[:, 0] == level).all()


def test_bilinear_reads_levels_where_they_lie():
    """Also if the last texels reach beyond the image: samples of a linear ramp are positions."""
    slope = np.arange(21, dtype=np.float32)[None, :, None] + 0.5
    levels = prefilter.sampling_levels(slope, "box")
    for scale, u in ((1.0, 0.4), (2.0, 0.3), (4.0, 0.3)):
        found = prefilter.sample_stochastic(
            levels, "bilinear", np.tile((u, 0.5), (NUMBERS, 1)), scale, STRATA
        )
        np.testing.assert_allclose(found.mean(), 21 * u, atol=0.02)


@pytest.mark.parametrize("name", TABLES)
def test_texels_are_picked_by_the_magnitudes_of_their_weights(name):
    """Weights found by sampling levels that are 1 at one texel and 0 everywhere else."""
    levels, table = levels_for(name), TABLES[name]
    place, scale = np.array([(0.4, 0.55)]), 2.9
    picked = prefilter.pick_texels(levels, table, np.tile(place, (NUMBERS, 1)), scale, STRATA)
    assert picked.texels.shape == (NUMBERS, 3)
    share, weights = {}, {}
    for texel, weight in zip(map(tuple, picked.texels.tolist()), picked.weights, strict=True):
        share[texel] = share.get(texel, 0) + 1 / NUMBERS
        weights[texel] = weight
    total = 0.0
    for level, column, row in np.ndindex(4, 32, 16):
        if row >= levels[level].shape[0] or column >= levels[level].shape[1]:
            continue
        single = [np.zeros_like(one[..., :1]) for one in levels]
        single[level][row, column] = 1
        weight = prefilter.sample(single, table, place, scale)[0, 0]
        total += abs(weight)
        if (level, column, row) in share:
            assert np.sign(weights[level, column, row]) == np.sign(weight)
    for weight in weights.values():
        np.testing.assert_allclose(abs(weight), total, rtol=1e-5)
    for (level, column, row), found in share.items():
        single = [np.zeros_like(one[..., :1]) for one in levels]
        single[level][row, column] = 1
        weight = prefilter.sample(single, table, place, scale)[0, 0]
        np.testing.assert_allclose(found, abs(weight) / total, rtol=0, atol=2 / NUMBERS)


@pytest.mark.parametrize("name", [*TABLES, "bilinear"])
@pytest.mark.parametrize("dtype", [np.float32, np.uint8])
def test_samples_are_picked_texels_times_their_weights(name, dtype):
    table = TABLES.get(name, name)
    levels = list(levels_for(name if name in TABLES else "tent"))
    if dtype == np.uint8:
        levels = [(255 * np.clip(level, 0, 1)).astype(np.uint8) for level in levels]
    generator = np.random.default_rng(1)
    arguments = (
        levels,
        table,
        generator.uniform(-1, 2, (500, 2)),
        generator.uniform(0, 40, 500),
        generator.random(500),
    )
    for wrap in ("clamp", "repeat", "border"):
        picked = prefilter.pick_texels(*arguments, wrap=wrap)
        expected = np.zeros((500, 3))
        for i, (level, column, row) in enumerate(picked.texels):
            if column >= 0 and row >= 0:
                texel = levels[level][row, column].astype(float)
                expected[i] = picked.weights[i] * texel / (255 if dtype == np.uint8 else 1)
        assert (picked.texels.min() < 0) == (wrap == "border")
        found = prefilter.sample_stochastic(*arguments, wrap=wrap)
        assert found.dtype == np.float32
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-7)
        one = prefilter.sample_stochastic(*arguments, wrap=wrap, threads=1)
        np.testing.assert_array_equal(found, one)


def test_the_ends_of_the_numbers_and_no_samples():
    levels = levels_for("lanczos2")
    ends = np.array([0.0, np.nextafter(1, 0)])
    for table in (*TABLES.values(), "bilinear"):
        if getattr(table, "filter", "lanczos2") != "lanczos2":
            continue
        # At a texel's center all weights but one are 0 for interpolation.
        found = prefilter.sample_stochastic(levels, table, [(0.5 / 32, 0.5 / 16)] * 2, 1.0, ends)
        assert np.isfinite(found).all()
        none = prefilter.sample_stochastic(levels, table, np.zeros((0, 2)), 1.0, np.zeros(0))
        assert none.shape == (0, 3)
    exact = prefilter.sample_stochastic(levels, "trilinear", [(0.5 / 32, 0.5 / 16)] * 2, 1.0, ends)
    np.testing.assert_array_equal(exact, np.tile(levels[0][0, 0], (2, 1)))


def test_progress_and_canceling():
    levels, table = levels_for("lanczos2"), TABLES["lanczos2"]
    many = (np.random.default_rng(2).random((20_000, 2)), 2.0, np.zeros(20_000))
    told = []
    prefilter.sample_stochastic(levels, table, *many, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(prefilter.Cancelled):
        prefilter.sample_stochastic(levels, table, *many, progress=lambda _: False)
