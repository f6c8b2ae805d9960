# SPDX-License-Identifier: GPL-3.0-or-later

"""The part of its texture that a surface uses, against sampling and lookups written here."""

import numpy as np
import prefilter
import pytest
import scenes

WIDTH, HEIGHT = 12, 7


def test_weights_of_an_even_square_are_one() -> None:
    weights = prefilter.texel_weights(scenes.square().surface, WIDTH, HEIGHT)
    assert weights.shape == (HEIGHT, WIDTH)
    np.testing.assert_allclose(weights, 1.0, rtol=1e-6)


def test_weights_are_the_share_of_area_in_each_texel() -> None:
    mesh = scenes.random_soup(3, 5)
    random = np.random.default_rng(0)
    count = 400_000
    pick = random.choice(len(mesh.areas), count, p=mesh.areas / mesh.areas.sum())
    a, b = np.sort(random.random((2, count)), axis=0)
    corners = np.stack([a, b - a, 1 - b], axis=1)
    uv = np.einsum("nk,nkd->nd", corners, mesh.uvs[pick])
    hits, _, _ = np.histogram2d(uv[:, 1], uv[:, 0], bins=(HEIGHT, WIDTH), range=((0, 1), (0, 1)))
    expected = hits / count * WIDTH * HEIGHT
    error = 5 * np.sqrt(np.maximum(hits, 1)) / count * WIDTH * HEIGHT
    weights = prefilter.texel_weights(mesh.surface, WIDTH, HEIGHT)
    assert (np.abs(weights - expected) <= error).all()
    assert weights.mean() == pytest.approx(1.0, rel=1e-5)


def test_texels_without_area_have_no_weight() -> None:
    weights = prefilter.texel_weights(scenes.square((0, 0), (0.5, 1)).surface, 4, 2)
    np.testing.assert_allclose(weights, [[2, 2, 0, 0], [2, 2, 0, 0]])
    assert (weights[:, 2:] == 0).all()


def test_fill_keeps_what_lookups_read_and_hides_the_rest() -> None:
    image = np.full((8, 8, 3), 9.0, np.float32)
    image[:, :5] = np.random.default_rng(1).random((8, 5, 3))
    surface = scenes.square((0.0, 0.0), (0.5, 1.0)).surface
    filled = prefilter.fill_unused(image, surface)
    # Texel 4 is half a texel beyond the chart, so lookups at its edge read it.
    np.testing.assert_array_equal(filled[:, :5], image[:, :5])
    used = image[:, :5]
    assert (filled >= used.min((0, 1))).all()
    assert (filled <= used.max((0, 1))).all()


def test_fill_does_not_read_what_it_replaces() -> None:
    image = np.full((8, 8, 1), np.nan, np.float32)
    image[:, :5] = 0.25
    filled = prefilter.fill_unused(image, scenes.square((0.0, 0.0), (0.5, 1.0)).surface)
    np.testing.assert_allclose(filled, 0.25)


def test_fill_changes_nothing_where_all_is_used() -> None:
    image = np.random.default_rng(2).random((5, 9, 4), np.float32)
    np.testing.assert_array_equal(prefilter.fill_unused(image, scenes.square().surface), image)


def test_colors_flow_to_where_alpha_is_0() -> None:
    image = np.full((9, 8, 4), np.nan, np.float32)
    image[..., 3] = 0.0
    image[2:5, :3] = (0.2, 0.4, 0.6, 1.0)
    image[5:7, :3] = (0.3, 0.5, 0.7, 0.25)
    image[0, 7, 3] = np.nan
    filled = prefilter.fill_transparent(image)
    kept = image[..., 3] > 0
    np.testing.assert_array_equal(filled[kept], image[kept])
    np.testing.assert_array_equal(filled[..., 3], image[..., 3])
    assert (filled[..., :3] >= np.float32([0.2, 0.4, 0.6]) - 1e-6).all()
    assert (filled[..., :3] <= np.float32([0.3, 0.5, 0.7]) + 1e-6).all()


def test_a_transparent_image_stays_as_it_is() -> None:
    image = np.random.default_rng(5).random((5, 4, 2), np.float32)
    image[..., 1] = 0.0
    np.testing.assert_array_equal(prefilter.fill_transparent(image), image)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_results_do_not_depend_on_threads(threads: int) -> None:
    surface = scenes.random_soup(5, 40).surface
    image = np.random.default_rng(4).random((70, 90, 2), np.float32)
    one = prefilter.texel_weights(surface, 90, 70, threads=1)
    np.testing.assert_array_equal(prefilter.texel_weights(surface, 90, 70, threads=threads), one)
    one = prefilter.fill_unused(image, surface, threads=1)
    np.testing.assert_array_equal(prefilter.fill_unused(image, surface, threads=threads), one)


def test_progress_is_reported_and_can_cancel() -> None:
    surface = scenes.square().surface
    seen: list[float] = []
    prefilter.texel_weights(surface, 64, 64, progress=seen.append)
    assert seen
    assert seen == sorted(seen)
    for call in (
        lambda: prefilter.texel_weights(surface, 64, 64, progress=lambda _: False),
        lambda: prefilter.fill_unused(np.ones((64, 64, 1)), surface, progress=lambda _: False),
    ):
        with pytest.raises(prefilter.Cancelled):
            call()
