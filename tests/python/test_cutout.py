# SPDX-License-Identifier: GPL-3.0-or-later

"""Cut-outs: the share of the surface that an alpha test keeps, against random lookups."""

import numpy as np
import prefilter
import pytest
import scenes

CLAMP = ("clamp", "clamp")


def leaves(size, count, radius, seed=1):
    """Straight RGBA: green discs, alpha from 0 to 1 over a texel; red where nothing shows."""
    random = np.random.default_rng(seed)
    y, x = np.mgrid[:size, :size] + 0.5
    alpha = np.zeros((size, size))
    for cx, cy, r in random.uniform((0, 0, 0.6), (size, size, 1), (count, 3)):
        alpha = np.maximum(alpha, np.clip(radius * r - np.hypot(x - cx, y - cy) + 0.5, 0, 1))
    image = np.zeros((size, size, 4), np.float32)
    image[...] = (0.9, 0.0, 0.0, 0.0)
    image[alpha > 0, :3] = (0.1, 0.6, 0.2)
    image[..., 3] = alpha
    return image


def random_points(mesh, count, seed=2):
    """UVs of points spread over the surface by chance."""
    random = np.random.default_rng(seed)
    pick = random.choice(len(mesh.areas), count, p=mesh.areas / mesh.areas.sum())
    a, b = np.sort(random.random((2, count)), axis=0)
    return np.einsum("nk,nkd->nd", np.stack([a, b - a, 1 - b], axis=1), mesh.uvs[pick])


def kept_share(level, uvs, threshold, wrap=CLAMP):
    return (scenes.bilinear(level[..., -1:], uvs, wrap) >= threshold).mean()


def two_charts():
    return scenes.join(
        scenes.square((0.0, 0.0), (0.7, 1.0), 0.2), scenes.square((0.7, 0.0), (1.0, 0.6), 0.8)
    )


@pytest.mark.parametrize("threshold", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("count", [12, 200])
def test_levels_keep_the_share_of_the_surface(threshold, count):
    """200 000 random points: the standard deviation of a share is about 0.001."""
    mesh = two_charts()
    image = leaves(128, count, 9)
    levels = prefilter.mipmaps(image, mesh.surface)
    kept = prefilter.keep_coverage(levels, mesh.surface, threshold=threshold)
    uvs = random_points(mesh, 200_000)
    wanted = kept_share(image, uvs, threshold)
    assert 0.01 < wanted < 0.95
    for level in kept[:4]:
        assert kept_share(level, uvs, threshold) == pytest.approx(wanted, abs=0.005)


@pytest.mark.parametrize("threshold", [0.3, 0.5])
def test_few_texels_keep_what_they_can(threshold):
    """No other curve of the family is closer, by a scan of them."""
    mesh = two_charts()
    image = leaves(32, 8, 5, seed=3)
    levels = prefilter.mipmaps(image, mesh.surface)
    kept = prefilter.keep_coverage(levels, mesh.surface, threshold=threshold)
    uvs = random_points(mesh, 40_000)
    wanted = kept_share(image, uvs, threshold)
    for before, after in zip(levels[2:], kept[2:], strict=True):
        distances = []
        for q in np.linspace(0.01, 0.99, 99):
            bent = np.interp(before[..., 3:], (0, q, 1), (0, threshold, 1))
            distances.append(abs(kept_share(bent, uvs, threshold) - wanted))
        assert abs(kept_share(after, uvs, threshold) - wanted) < min(distances) + 0.01


def test_ordinary_levels_lose_thin_leaves():
    mesh = two_charts()
    image = leaves(128, 60, 3)
    levels = prefilter.mipmaps(image, mesh.surface)
    kept = prefilter.keep_coverage(levels, mesh.surface)
    uvs = random_points(mesh, 200_000)
    wanted = kept_share(image, uvs, 0.5)
    for number in (3, 4, 5):
        assert kept_share(levels[number], uvs, 0.5) < 0.5 * wanted
        assert kept_share(kept[number], uvs, 0.5) == pytest.approx(wanted, abs=0.005)


def test_without_a_surface_the_image_counts():
    image = leaves(64, 40, 4)
    levels = prefilter.mipmaps(image, filter="box")
    kept = prefilter.keep_coverage(levels)
    uvs = np.random.default_rng(3).random((200_000, 2))
    wanted = kept_share(image, uvs, 0.5)
    for level in kept[:5]:
        assert kept_share(level, uvs, 0.5) == pytest.approx(wanted, abs=0.005)


@pytest.mark.parametrize("wrap", ["clamp", "repeat", "border"])
def test_wrap_modes_are_those_of_the_lookups(wrap):
    """Lookups outside the image, where the surface leaves it, follow the wrap mode."""
    mesh = scenes.square((-0.25, 0.1), (1.25, 0.9))
    image = leaves(64, 40, 6, seed=5)
    levels = prefilter.mipmaps(image, mesh.surface, wrap=wrap)
    kept = prefilter.keep_coverage(levels, mesh.surface, wrap=wrap)
    uvs = random_points(mesh, 200_000)
    uvs = uvs[~scenes.in_border(uvs, (wrap, wrap))]
    if wrap == "clamp":
        uvs = np.clip(uvs, 0, 1)
    wanted = kept_share(image, uvs, 0.5, (wrap, wrap))
    for level in kept[:4]:
        assert kept_share(level, uvs, 0.5, (wrap, wrap)) == pytest.approx(wanted, abs=0.008)


def test_sides_of_any_size():
    mesh = two_charts()
    levels = [leaves(size, 20, size / 8, seed=6)[: size - size // 5] for size in (90, 45, 22, 11)]
    kept = prefilter.keep_coverage(levels, mesh.surface)
    uvs = random_points(mesh, 200_000)
    wanted = kept_share(levels[0], uvs, 0.5)
    for level in kept:
        assert kept_share(level, uvs, 0.5) == pytest.approx(wanted, abs=0.005)


def test_one_triangle_has_the_share_of_its_closed_form():
    """Alpha that rises along u: the test keeps the texels to the right of a line."""
    image = np.repeat(np.linspace(0, 1, 64, dtype=np.float32)[None, :, None], 64, axis=0)
    mesh = scenes.soup([[(0, 0), (1, 0), (0, 1)]])
    levels = [image, image[::2, ::2] ** 3]
    kept = prefilter.keep_coverage(levels, mesh.surface)
    uvs = random_points(mesh, 200_000)
    assert kept_share(image, uvs, 0.5) == pytest.approx(0.25, abs=0.003)
    assert kept_share(levels[1], uvs, 0.5) < 0.1
    assert kept_share(kept[1], uvs, 0.5) == pytest.approx(0.25, abs=0.004)


def test_alpha_keeps_its_order_and_its_ends():
    levels = prefilter.mipmaps(leaves(64, 60, 3), filter="box")
    for before, after in zip(levels, prefilter.keep_coverage(levels), strict=True):
        a, b = before[..., 3].ravel(), after[..., 3].ravel()
        order = np.argsort(a, kind="stable")
        assert (np.diff(b[order]) >= 0).all()
        np.testing.assert_array_equal(b[a == 0], 0)
        np.testing.assert_array_equal(b[a == 1], 1)
        np.testing.assert_array_equal(before[..., :3], after[..., :3])


def test_levels_that_keep_it_already_stay():
    image = np.zeros((16, 16, 4), np.float32)
    image[:, 8:] = 1
    levels = prefilter.mipmaps(image, filter="box")[:4]
    for a, b in zip(levels, prefilter.keep_coverage(levels), strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("value", [0.0, 1.0])
@pytest.mark.parametrize("threshold", [1e-6, 0.5, 1.0])
def test_alpha_that_is_one_value_stays(value, threshold):
    image = leaves(16, 5, 4)
    image[..., 3] = value
    levels = prefilter.mipmaps(image, two_charts().surface)
    kept = prefilter.keep_coverage(levels, two_charts().surface, threshold=threshold)
    for a, b in zip(levels, kept, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-6)


def test_even_alpha_below_the_threshold_goes_above_with_room():
    """Everything is shown at level 0; 8 bits must not round a level back under the threshold."""
    levels = [
        np.full((side, side, 1), a, np.float32) for side, a in ((4, 0.6), (2, 0.3), (1, 0.02))
    ]
    for level in prefilter.keep_coverage(levels)[1:]:
        assert (np.round(level * 255) / 255 > 0.505).all()


def test_one_texel_shows_all_or_nothing():
    image = np.zeros((8, 8, 1), np.float32)
    for share, shown in ((0.75, True), (0.25, False)):
        image[:] = 0
        image[:, : int(8 * share)] = 1
        for last in (0.2, 0.7):
            level = prefilter.keep_coverage([image, np.full((1, 1, 1), last, np.float32)])[1]
            assert (level.item() >= 0.5) is shown


def test_premultiplied_colors_follow_alpha():
    image = leaves(64, 60, 3)
    associated = image.copy()
    associated[..., :3] *= image[..., 3:]
    levels = prefilter.mipmaps(associated, filter="box", premultiplied=True)
    kept = prefilter.keep_coverage(levels, premultiplied=True)
    changed = 0
    for before, after in zip(levels, kept, strict=True):
        some = before[..., 3] > 1e-3
        np.testing.assert_allclose(
            after[some][:, :3] * before[some][:, 3:], before[some][:, :3] * after[some][:, 3:],
            atol=1e-6,
        )  # fmt: skip
        changed += not np.array_equal(before, after)
    assert changed > 2


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-box", "box", "lanczos3-covered"])
def test_colors_under_no_alpha_do_not_bleed(filter):
    """The red that nothing shows is in no level, wherever a lookup has any alpha."""
    mesh = two_charts()
    levels = prefilter.mipmaps(leaves(128, 60, 3), mesh.surface, filter=filter)
    for level in prefilter.keep_coverage(levels, mesh.surface)[1:]:
        green = np.broadcast_to(np.float32((0.1, 0.6, 0.2)), level[..., :3].shape)
        np.testing.assert_allclose(level[..., :3], green, atol=2e-3)


def test_unused_texels_do_not_count():
    mesh = scenes.square((0.0, 0.0), (0.5, 1.0))
    image = leaves(32, 30, 3)
    dirty = image.copy()
    dirty[:, 18:] = np.nan
    expected = prefilter.keep_coverage(prefilter.mipmaps(image, mesh.surface), mesh.surface)
    found = prefilter.keep_coverage(prefilter.mipmaps(dirty, mesh.surface), mesh.surface)
    for a, b in zip(expected[1:], found[1:], strict=True):
        np.testing.assert_array_equal(a, b)


def test_results_do_not_depend_on_threads_and_inputs_stay():
    mesh = scenes.random_soup(4, 30)
    levels = prefilter.mipmaps(leaves(64, 60, 3), mesh.surface)
    copies = [level.copy() for level in levels]
    one = prefilter.keep_coverage(levels, mesh.surface, threads=1)
    three = prefilter.keep_coverage(levels, mesh.surface, threads=3)
    one[0][:] = 5
    for a, b in zip(one[1:], three[1:], strict=True):
        np.testing.assert_array_equal(a, b)
    for a, b in zip(levels, copies, strict=True):
        np.testing.assert_array_equal(a, b)


def test_progress_rises_to_one_and_cancels():
    levels = prefilter.mipmaps(leaves(64, 60, 3), filter="box")
    told = []
    prefilter.keep_coverage(levels, two_charts().surface, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1
    for surface in (None, two_charts().surface):
        with pytest.raises(prefilter.Cancelled):
            prefilter.keep_coverage(levels, surface, progress=lambda _: False)


LEVEL = np.ones((4, 4, 4), np.float32)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"threshold": 0}, "threshold: 0; a number above 0 and at most 1"),
        ({"threshold": 1.001}, "threshold: 1.001"),
        ({"threshold": -0.5}, "threshold: -0.5"),
        ({"threshold": np.nan}, "threshold: nan"),
        ({"threshold": "half"}, "threshold: 'half'"),
        ({"threshold": True}, "threshold: True"),
        ({"levels": []}, "levels: none were given"),
        ({"levels": None}, "levels: a NoneType"),
        ({"levels": [LEVEL[..., :3]]}, "levels: level 0 has 3 channels; all need 4"),
        ({"levels": [LEVEL, LEVEL[:2, :2, :1]]}, "levels: level 1 has 1 channels"),
        ({"levels": [LEVEL, LEVEL[:2, :2] * np.nan]}, "levels: level 1 holds alpha that is not"),
        ({"levels": [LEVEL[0, 0]]}, r"levels: level 0: shape \(4,\)"),
        ({"wrap": "mirror"}, "wrap: 'mirror'"),
        ({"surface": 3}, "surface: a int"),
        ({"surface": scenes.soup(np.zeros((1, 3, 2)), np.zeros(1)).surface}, "surface: .*area of"),
        ({"progress": 3}, "progress: 3"),
        ({"threads": -1}, "threads: -1"),
    ],
)
def test_bad_arguments(arguments, message):
    arguments = {"levels": [LEVEL, LEVEL[:2, :2]], **arguments}
    with pytest.raises(ValueError, match=message):
        prefilter.keep_coverage(**arguments)
