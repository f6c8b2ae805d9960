# SPDX-License-Identifier: GPL-3.0-or-later

"""Masks, roughness, packed channels, light without an upper bound, and both kinds of alpha."""

import numpy as np
import prefilter
import pytest
import scenes
from test_mipmaps_oracle import TOLERANCE, Oracle, Quadrature

CLAMP = ("clamp", "clamp")
FILTERS = ["pam-bilinear", "pam-box", "box", "lanczos3-covered"]


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("bounds", [(0.0, 1.0), (0.0, None), None])
def test_packed_channels_are_filtered_each_by_itself(filter, bounds):
    """An alpha that is no coverage, here with many zeros, must not touch the other channels."""
    mesh = scenes.random_soup(1, 12)
    image = scenes.random_image(2, 32, 32, 4)
    image[..., 3] = scenes.random_image(3, 32, 32, 1)[..., 0] > 0.7
    packed = prefilter.mipmaps(
        image, mesh.surface, filter=filter, bounds=bounds, premultiplied=True
    )
    for c in range(4):
        alone = prefilter.mipmaps(image[..., c : c + 1], mesh.surface, filter=filter, bounds=bounds)
        for a, b in zip(packed, alone, strict=True):
            np.testing.assert_allclose(a[..., c : c + 1], b, atol=2e-4)


def test_masks_stay_between_0_and_1_and_are_the_closest_that_do():
    """A mask of edges, where least squares without bounds overshoot: optimality, by quadrature."""
    mesh = scenes.random_soup(4, 10)
    mask = (scenes.random_image(5, 16, 16, 1) > 0.5).astype(np.float32)
    level = prefilter.mipmaps(mask, mesh.surface)[1]
    free = prefilter.mipmaps(mask, mesh.surface, bounds=None)[1]
    assert free.max() > 1.05
    oracle = Oracle(Quadrature(mesh, mask, CLAMP, steps=200), (8, 8))
    gradient = oracle.gradient(level)
    texels = level.reshape(-1, 1)[oracle.used]
    low, high = texels <= 0, texels >= 1
    assert low.sum() + high.sum() > 5
    assert (gradient[low] > -TOLERANCE).all()
    assert (gradient[high] < TOLERANCE).all()
    assert np.abs(gradient[~low & ~high]).max() < TOLERANCE


def test_light_has_a_lower_bound_only():
    """A lamp of 5000 in a dim room: optimality of the levels, by quadrature."""
    mesh = scenes.random_soup(6, 10)
    image = scenes.random_image(7, 16, 16, 3)
    image[4:6, 9:11] = 5000.0
    levels = prefilter.mipmaps(image, mesh.surface, bounds=(0.0, None))
    for level in levels[1:3]:
        oracle = Oracle(Quadrature(mesh, image, CLAMP, steps=200), level.shape[:2])
        gradient = oracle.gradient(level) / 5000
        texels = level.reshape(-1, 3)[oracle.used]
        dark = texels <= 0
        assert dark.sum() > 3
        assert texels.max() > 300
        assert (gradient[dark] > -TOLERANCE).all()
        assert np.abs(gradient[~dark]).max() < TOLERANCE


@pytest.mark.parametrize("premultiplied", [True, False])
@pytest.mark.parametrize("peak", [1.0, 800.0])
def test_both_kinds_of_alpha_give_the_same_light(premultiplied, peak):
    """Compares means over the surface of color times alpha, by quadrature."""
    mesh = scenes.random_soup(8, 9)
    straight = scenes.random_image(9, 16, 16, 4)
    straight[..., :3] *= peak
    straight[..., 3] *= scenes.random_image(10, 16, 16, 1)[..., 0] > 0.4
    associated = straight.copy()
    associated[..., :3] *= straight[..., 3:]
    levels = prefilter.mipmaps(
        associated if premultiplied else straight,
        mesh.surface,
        filter="pam-box",
        bounds=(0.0, None),
        premultiplied=premultiplied,
    )
    uvs, weights = scenes.surface_samples(mesh, 400)
    column, row = np.minimum((uvs * 16).astype(int), 15).T
    for k in (1, 2, 3, 4):
        side = 16 >> k
        flat = (row >> k) * side + (column >> k)
        mass = np.bincount(flat, weights, side * side)
        strong = mass > 0.1 * mass.mean()
        level = levels[k].reshape(-1, 4).astype(np.float64)
        seen = level.copy()
        if not premultiplied:
            seen[:, :3] *= level[:, 3:]
        for c in range(4):
            sums = np.bincount(flat, weights * associated[row, column, c], side * side)
            scale = peak if c < 3 else 1.0
            difference = seen[strong, c] - sums[strong] / mass[strong]
            assert np.abs(difference).max() < 0.01 * scale


@pytest.mark.parametrize("filter", FILTERS)
def test_straight_colors_are_those_that_are_seen(filter):
    """Blue under alpha 0 stays out of every level, however bright it is."""
    image = np.zeros((32, 32, 4), np.float32)
    image[...] = (0.0, 0.0, 900.0, 0.0)
    image[8:20, 5:25] = (50.0, 0.5, 0.0, 1.0)
    image[10:12] = (50.0, 0.5, 0.0, 0.3)
    surface = scenes.random_soup(11, 15).surface
    for level in prefilter.mipmaps(image, surface, filter=filter, bounds=(0.0, None))[1:]:
        shown = level[..., 3] > 0
        assert shown.any()
        np.testing.assert_allclose(level[shown][:, 2], 0, atol=1e-3)
        np.testing.assert_allclose(level[shown][:, 0], 50, rtol=1e-3)
