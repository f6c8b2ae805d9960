# SPDX-License-Identifier: GPL-3.0-or-later

"""Probes in a row, against isotropic samples and the elliptical Gaussian."""

import numpy as np
import prefilter
import pytest
from scenes import random_image

TABLE = prefilter.SamplingTable.standard("gaussian")
PLACES = np.random.default_rng(0).random((1500, 2))


def turned(angles, major, minor):
    turn = np.stack([np.cos(angles), -np.sin(angles), np.sin(angles), np.cos(angles)], axis=-1)
    return turn.reshape(-1, 2, 2) * np.array([major, minor])


ANGLES = np.random.default_rng(1).uniform(0, 2 * np.pi, len(PLACES))


@pytest.fixture(scope="module")
def image():
    """Contrast at all scales."""
    return sum(
        prefilter.resize(random_image(k, 2**k, 2**k, 2), 256, 256, filter="gaussian", wrap="repeat")
        for k in range(2, 9)
    )


@pytest.fixture(scope="module")
def levels(image):
    return prefilter.sampling_levels(image, "gaussian", wrap="repeat", premultiplied=True)


@pytest.mark.parametrize("table", [TABLE, "trilinear"])
@pytest.mark.parametrize("scale", [0.0, 0.5, 1.0, 2.5, 9.0, 1e10])
def test_round_footprints_are_isotropic_samples(levels, table, scale):
    jacobians = turned(ANGLES, scale, scale)
    found = prefilter.sample_anisotropic(levels, table, PLACES, jacobians, wrap="repeat")
    expected = prefilter.sample(levels, table, PLACES, scale, wrap="repeat")
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize("table", [TABLE, "trilinear"])
def test_one_probe_is_as_wide_as_the_larger_singular_value(levels, table):
    jacobians = np.random.default_rng(2).normal(0, 5, (len(PLACES), 2, 2))
    found = prefilter.sample_anisotropic(
        levels, table, PLACES, jacobians, max_probes=1, wrap="repeat"
    )
    scales = np.linalg.svd(jacobians, compute_uv=False)[:, 0]
    expected = prefilter.sample(levels, table, PLACES, scales, wrap="repeat")
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-4)


# Off by these shares of the contrast that the ellipses leave: with probes of a table, and trilinear
# ones. Measured, and a fifth more.
ERRORS = {1.05: (0.07, 0.18), 1.5: (0.052, 0.133), 2.0: (0.055, 0.11), 5.0: (0.047, 0.08)}


@pytest.mark.parametrize("ratio", ERRORS)
def test_probes_come_close_to_the_ellipse(image, levels, ratio):
    jacobians = turned(ANGLES, 4.0 * ratio, 4.0)
    exact = prefilter.sample_ewa(image, PLACES, jacobians, wrap="repeat")
    for table, bound in zip((TABLE, "trilinear"), ERRORS[ratio], strict=True):
        found = prefilter.sample_anisotropic(levels, table, PLACES, jacobians, wrap="repeat")
        error = np.sqrt(np.mean((found - exact) ** 2)) / exact.std()
        assert error < bound
    # Isotropic samples of the same width have much larger errors.
    round_ = prefilter.sample_anisotropic(
        levels, TABLE, PLACES, jacobians, max_probes=1, wrap="repeat"
    )
    if ratio >= 1.5:
        assert np.sqrt(np.mean((round_ - exact) ** 2)) / exact.std() > 2 * ERRORS[ratio][0]


@pytest.mark.parametrize("max_probes", [1, 2, 3, 16, 256])
def test_weights_sum_to_1(max_probes):
    constant = prefilter.sampling_levels(np.full((32, 32, 1), 0.3, np.float32), "gaussian")
    jacobians = np.random.default_rng(3).normal(0, 8, (300, 2, 2))
    jacobians[:5] = [
        np.zeros((2, 2)),
        np.ones((2, 2)),
        np.eye(2) * 1e300,
        [(1e300, 0), (0, 1)],
        np.eye(2),
    ]
    found = prefilter.sample_anisotropic(
        constant, TABLE, PLACES[:300], jacobians, max_probes=max_probes
    )
    np.testing.assert_allclose(found, 0.3, rtol=0, atol=1e-6)


def test_only_the_ellipse_counts(levels):
    """Only the ellipse matters: J and J times any rotation have the same result."""
    jacobians = turned(ANGLES, 11.0, 3.0)
    expected = prefilter.sample_anisotropic(levels, "trilinear", PLACES, jacobians, wrap="repeat")
    spun = jacobians @ turned(ANGLES[::-1], 1, 1)
    for same in (spun, -jacobians, jacobians[..., ::-1]):
        found = prefilter.sample_anisotropic(levels, "trilinear", PLACES, same, wrap="repeat")
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-4)


def test_threads_progress_and_no_samples(levels):
    jacobians = turned(ANGLES, 20.0, 2.0)
    one, four = (
        prefilter.sample_anisotropic(levels, TABLE, PLACES, jacobians, threads=n) for n in (1, 4)
    )
    np.testing.assert_array_equal(one, four)
    assert prefilter.sample_anisotropic(levels, TABLE, PLACES[:0], jacobians[:0]).shape == (0, 2)
    told = []
    prefilter.sample_anisotropic(levels, TABLE, PLACES, jacobians, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(prefilter.Cancelled):
        prefilter.sample_anisotropic(levels, TABLE, PLACES, jacobians, progress=lambda _: False)
