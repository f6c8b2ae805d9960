# SPDX-License-Identifier: GPL-3.0-or-later

"""Normal maps against brute force: means of vectors, the lobes that they stand for, angles."""

import numpy as np
import prefilter
import pytest
import scenes
from test_mipmaps_oracle import Oracle, Quadrature

CLAMP = ("clamp", "clamp")
UP = np.array([0.0, 0.0, 1.0])


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def encode(vectors):
    return ((vectors + 1) / 2).astype(np.float32)


def decode(levels):
    return [2 * level.astype(np.float64) - 1 for level in levels]


def bumps(seed, height, width, slope, smooth=1):
    """Unit normals of a rough sheet, whose slopes have about that standard deviation."""
    slopes = np.random.default_rng(seed).normal(0, 1, (height, width, 2))
    for _ in range(smooth):
        slopes = sum(np.roll(slopes, k, axis) for axis in (0, 1) for k in (-1, 0, 1))
    slopes *= slope / slopes.std()
    return unit(np.concatenate([slopes, np.ones((height, width, 1))], axis=2))


def two_charts():
    """Two squares with a gap between them; one has nine times the area in space of the other."""
    return scenes.join(
        scenes.square((0.06, 0.06), (0.47, 0.94), 0.1),
        scenes.square((0.55, 0.06), (0.94, 0.94), 0.9),
    )


def test_box_levels_are_means_of_vectors_with_length_one():
    normals = bumps(1, 8, 16, 0.5, smooth=0)
    levels = decode(prefilter.normal_mipmaps(encode(normals), filter="box"))
    assert [level.shape[:2] for level in levels] == [(8, 16), (4, 8), (2, 4), (1, 2), (1, 1)]
    for k in (1, 2, 3):
        blocks = normals.reshape(8 >> k, 1 << k, 16 >> k, 1 << k, 3).mean((1, 3))
        np.testing.assert_allclose(levels[k], unit(blocks), atol=1e-6)


def test_fitted_levels_are_the_least_squares_of_vectors():
    mesh = scenes.random_soup(3, 12)
    normals = bumps(2, 16, 16, 0.4)
    found = decode(prefilter.normal_mipmaps(encode(normals), mesh.surface))[1]
    oracle = Oracle(Quadrature(mesh, normals, CLAMP, steps=200), (8, 8))
    used = oracle.used
    fitted = np.linalg.solve(oracle.pulled[np.ix_(used, used)], oracle.pulled_right[used])
    cosines = (unit(fitted) * found.reshape(-1, 3)[used]).sum(1)
    diagonal = np.diag(oracle.matrix)[used]
    strong = diagonal > 0.05 * diagonal.mean()
    assert strong.sum() > 40
    assert np.degrees(np.arccos(np.minimum(cosines[strong], 1))).max() < 0.3


@pytest.mark.parametrize("size", [(32, 16), (29, 17), (1, 13)])
@pytest.mark.parametrize(
    "filter", ["pam-bilinear", "pam-trilinear", "pam-box", "box", "box-covered", "lanczos3"]
)
@pytest.mark.parametrize("encoded", [True, False])
def test_every_level_has_unit_length(filter, encoded, size):
    normals = bumps(3, *size, 0.8, smooth=0)
    image = encode(normals) if encoded else 3 * normals.astype(np.float32)
    levels = prefilter.normal_mipmaps(image, two_charts().surface, filter=filter, encoded=encoded)
    np.testing.assert_array_equal(levels[0], image)
    for level in decode(levels[1:]) if encoded else levels[1:]:
        np.testing.assert_allclose(np.linalg.norm(level, axis=2), 1, atol=1e-6)


def test_encoding_makes_no_difference():
    normals = bumps(4, 16, 16, 0.5)
    surface = two_charts().surface
    plain = prefilter.normal_mipmaps(normals, surface, encoded=False)
    coded = decode(prefilter.normal_mipmaps(encode(normals), surface))
    for a, b in zip(plain, coded, strict=True):
        np.testing.assert_allclose(a, b, atol=2e-6)


def test_green_upside_down_gives_levels_upside_down():
    normals = bumps(5, 16, 16, 0.5)
    surface = two_charts().surface
    opengl, rough = prefilter.normal_mipmaps(normals, surface, encoded=False, roughness=0.3)
    directx, same = prefilter.normal_mipmaps(
        normals * (1, -1, 1), surface, encoded=False, roughness=0.3
    )
    for a, b in zip(opengl[1:], directx[1:], strict=True):
        np.testing.assert_allclose(a * (1, -1, 1), b, atol=1e-6)
    for a, b in zip(rough, same, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-6)


def rougher(normals, rough):
    """Roughness of a bundle of normals and roughnesses, by the documented formula."""
    length = np.linalg.norm(normals.mean(0))
    return min((rough**4).mean() + 2 * (1 - length), 1) ** 0.25


@pytest.mark.parametrize("wrap", ["clamp", "repeat", "border"])
def test_roughness_of_box_levels_is_that_of_lookups(wrap):
    """Brute force: 16 x 16 lookups of both maps in each texel."""
    normals = bumps(6, 8, 16, 0.3, smooth=0)
    rough = scenes.random_image(7, 8, 16, 1) * 0.6
    _, found = prefilter.normal_mipmaps(encode(normals), roughness=rough, filter="box", wrap=wrap)
    np.testing.assert_array_equal(found[0], rough)
    for k in (1, 2, 3):
        for y, x in np.ndindex(8 >> k, 16 >> k):
            at = (np.arange(16 << k) + 0.5) / 16
            u, v = np.meshgrid(at + (x << k), at + (y << k))
            uvs = np.stack([u.ravel() / 16, v.ravel() / 8], 1)
            shown = unit(scenes.bilinear(normals, uvs, (wrap, wrap)))
            expected = rougher(shown, scenes.bilinear(rough, uvs, (wrap, wrap))[:, 0])
            assert found[k][y, x, 0] == pytest.approx(expected, abs=1e-3)


def test_roughness_is_that_of_the_surface_under_a_texel():
    """Dense lookups over charts of different density, whose edges lie between texels."""
    edges = np.array([2, 15, 18, 30]) / 32
    mesh = scenes.join(
        scenes.square((edges[0], edges[0]), (edges[1], edges[3]), 0.1),
        scenes.square((edges[2], edges[0]), (edges[3], edges[3]), 0.9),
    )
    normals = bumps(6, 32, 32, 0.3, smooth=2)
    rough = 0.2 + 0.1 * bumps(7, 32, 32, 1.0, smooth=2)[..., :1].astype(np.float32)
    _, found = prefilter.normal_mipmaps(encode(normals), mesh.surface, roughness=rough)
    uvs, weights = scenes.surface_samples(mesh, 700)
    shown = unit(scenes.bilinear(normals, uvs, CLAMP))
    alpha2 = scenes.bilinear(rough, uvs, CLAMP) ** 4
    values = np.concatenate([shown, alpha2], axis=1)
    column, row = np.minimum((uvs * 32).astype(int), 31).T
    for k in (1, 2, 3, 4, 5):
        side = 32 >> k
        flat = (row >> k) * side + (column >> k)
        mass = np.bincount(flat, weights, side * side)
        sums = [np.bincount(flat, weights * values[:, c], side * side) for c in range(4)]
        strong = mass > 0.02 * mass.max()
        means = np.stack(sums, 1)[strong] / mass[strong, None]
        expected = means[:, 3] + 2 * (1 - np.linalg.norm(means[:, :3], axis=1))
        np.testing.assert_allclose(found[k].reshape(-1)[strong], expected**0.25, rtol=0.03)


@pytest.mark.parametrize("concentration", [8.0, 50.0, 400.0])
def test_lost_length_gives_back_the_concentration(concentration):
    """Von Mises-Fisher normals become a lobe with alpha^2 = 2 / concentration.

    The map is the inverse of their distribution: the height above the equator along v, the azimuth
    along u. So a mean over it is one over the distribution.
    """
    share, turn = np.meshgrid((np.arange(512) + 0.5) / 512, np.arange(64) / 64 * 2 * np.pi,
                              indexing="ij")  # fmt: skip
    z = 1 + np.log(share + (1 - share) * np.exp(-2 * concentration)) / concentration
    out = np.sqrt(1 - z * z)
    normals = np.stack([out * np.cos(turn), out * np.sin(turn), z], axis=2)
    _, rough = prefilter.normal_mipmaps(
        normals, filter="box", wrap=("repeat", "clamp"), encoded=False, roughness=0.0
    )
    assert rough[-1].item() ** 4 == pytest.approx(2 / concentration, rel=0.01)


def lobe(directions, normals, roughness):
    """The GGX density of microfacets along each direction, (directions, normals)."""
    alpha2 = roughness**4
    cosine = np.clip(directions @ normals.T, 0, None)
    return alpha2 / (np.pi * (cosine**2 * (alpha2 - 1) + 1) ** 2)


def half_sphere():
    """Directions, dense around the pole, and the solid angle of each."""
    steps = np.linspace(-1, 1, 41)
    at = np.sign(steps) * steps**2 * 2.0
    x, y = np.meshgrid(at, at)
    around = np.stack([x, y, np.ones_like(x)], axis=2).reshape(-1, 3)
    spacing = np.gradient(at)
    length = np.linalg.norm(around, axis=1)
    return around / length[:, None], np.outer(spacing, spacing).ravel() / length**3


def lobe_errors(level, count=60):
    """How far the lobes of a level are from the mean lobes of footprints, with and without."""
    random = np.random.default_rng(9)
    mesh = two_charts()
    image = encode(bumps(10, 64, 64, 0.25))
    image[:, 31:34] = (0.9, 0.1, 0.2)  # Between the charts.
    rough = 0.2 + 0.3 * scenes.random_image(11, 64, 64, 1)
    normals, added = prefilter.normal_mipmaps(image, mesh.surface, roughness=rough)
    plain = prefilter.mipmaps(rough**4, mesh.surface)
    directions, angles = half_sphere()
    charts = (((0.06, 0.06), (0.47, 0.94)), ((0.55, 0.06), (0.94, 0.94)))
    half = 0.5 * 2**level / 64
    errors = []
    for _ in range(count):
        low, high = np.array(charts[random.integers(2)])
        center = random.uniform(low + half, high - half)
        points = center + random.uniform(-half, half, (400, 2))
        shown = unit(2 * scenes.bilinear(image, points, CLAMP) - 1)
        values = scenes.bilinear(rough, points, CLAMP)[:, 0]
        truth = lobe(directions, shown, values).mean(1)
        normal = unit(2 * scenes.bilinear(normals[level], center[None], CLAMP) - 1)
        mean = unit(shown.mean(0))[None]
        read = scenes.bilinear(added[level], center[None], CLAMP)[0, 0]
        unadded = scenes.bilinear(plain[level], center[None], CLAMP)[0, 0] ** 0.25
        pairs = [(normal, read), (normal, unadded), (mean, read), (mean, rougher(shown, values))]
        errors.append(
            [
                (np.abs(lobe(directions, *pair)[:, 0] - truth) * angles).sum()
                / (truth * angles).sum()
                for pair in pairs
            ]
        )
    return np.mean(errors, axis=0)


@pytest.mark.parametrize(("level", "share"), [(2, 0.75), (3, 0.6), (4, 0.5)])
def test_lobes_are_closer_with_the_lost_length(level, share):
    """GGX lobes averaged over random footprints of a level's texel, on the surface."""
    added, plain, read, own = lobe_errors(level)
    assert added < share * plain
    assert read < 1.05 * own, "a level tells as much as the footprint's own mean would"


def angular_error(level, normals, mesh):
    """Degrees, root mean square over the surface, as a shader reads both maps."""
    uvs, weights = scenes.surface_samples(mesh, 200)
    shown = unit(scenes.bilinear(normals, uvs, CLAMP))
    looked_up = unit(2 * scenes.bilinear(level, uvs, CLAMP) - 1)
    squares = np.degrees(np.arccos(np.clip((shown * looked_up).sum(1), -1, 1))) ** 2
    return np.sqrt((squares * weights).sum() / weights.sum())


def test_angles_are_closer_than_those_of_box_levels():
    mesh = two_charts()
    normals = bumps(12, 64, 64, 0.25, smooth=6)
    normals[:, 31:34] = unit(np.array([0.7, -0.6, 0.3]))
    fitted = prefilter.normal_mipmaps(encode(normals), mesh.surface)
    box = prefilter.normal_mipmaps(encode(normals), filter="box")
    for k in (1, 2, 3):
        assert angular_error(fitted[k], normals, mesh) < 0.9 * angular_error(box[k], normals, mesh)


@pytest.mark.parametrize("size", [(16, 16), (15, 9), (1, 7), (1, 1)])
@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear", "box", "box-covered"])
def test_roughness_never_falls_below_what_all_texels_have(size, filter):
    normals = bumps(21, *size, 0.5, smooth=0)
    levels, rough = prefilter.normal_mipmaps(
        normals, two_charts().surface, encoded=False, roughness=0.3, filter=filter
    )
    assert [level.shape[:2] for level in levels] == [level.shape[:2] for level in rough]
    for level in rough:
        assert level.min() > 0.2999
        assert level.max() <= 1


def test_flat_map_stays_flat_and_keeps_its_roughness():
    image = np.full((16, 16, 3), (0.5, 0.5, 1.0), np.float32)
    for value in (0.0, 0.35, 1.0):
        normals, rough = prefilter.normal_mipmaps(image, two_charts().surface, roughness=value)
        for level, roughness in zip(normals, rough, strict=True):
            np.testing.assert_allclose(level, image[:1, :1] + 0 * level, atol=1e-6)
            np.testing.assert_allclose(roughness, value, atol=1e-6)


def test_flat_map_of_bytes_stays_smooth():
    """128 of 255 is no zero; rounding must not make a mirror rough."""
    image = np.full((64, 64, 3), (128 / 255, 128 / 255, 1.0), np.float32)
    _, rough = prefilter.normal_mipmaps(image, two_charts().surface, roughness=0.0)
    assert max(level.max() for level in rough) < 0.004


def test_vectors_without_a_direction_point_up():
    image = np.full((8, 8, 3), 128 / 255, np.float32)
    image[:, 4:] = 0.5
    for level in prefilter.normal_mipmaps(image, filter="box")[1:]:
        np.testing.assert_allclose(level, encode(UP) + 0 * level, atol=1e-6)


def test_opposite_normals_give_the_roughest_surface():
    normals = np.zeros((2, 2, 3), np.float32)
    normals[0, :, 0], normals[1, :, 0] = 1, -1
    levels, rough = prefilter.normal_mipmaps(
        normals, scenes.square().surface, encoded=False, roughness=0.2
    )
    np.testing.assert_allclose(levels[1][0, 0], UP, atol=1e-6)
    assert rough[1].item() == pytest.approx(1.0)


def test_tangent_space_levels_do_not_point_below_the_surface():
    """Steep, hard-edged normals, where least squares overshoot."""
    normals = np.zeros((16, 16, 3))
    normals[...] = unit(np.array([0.999, 0.0, 0.01]))
    normals[5:7] = UP
    normals[:, 9] = UP
    mesh = scenes.random_soup(13, 20)
    assert prefilter.mipmaps(normals, mesh.surface, bounds=None)[1][..., 2].min() < -0.01
    for level in prefilter.normal_mipmaps(normals, mesh.surface, encoded=False)[1:]:
        assert level[..., 2].min() >= 0


def test_object_space_normals_may_point_anywhere():
    normals = unit(np.random.default_rng(14).normal(0, 1, (8, 8, 3)) - (0, 0, 2))
    levels = prefilter.normal_mipmaps(normals, scenes.square().surface, encoded=False)
    assert levels[-1][0, 0, 2] < -0.9


def test_unused_texels_do_not_count():
    mesh = scenes.square((0.0, 0.0), (0.5, 1.0))
    clean = encode(bumps(15, 16, 16, 0.4))
    rough = scenes.random_image(16, 16, 16, 1)
    expected = prefilter.normal_mipmaps(clean, mesh.surface, roughness=rough)
    dirty, dirty_rough = clean.copy(), rough.copy()
    dirty[:, 9:] = (np.nan, np.inf, -5.0)
    dirty_rough[:, 9:] = np.nan
    found = prefilter.normal_mipmaps(dirty, mesh.surface, roughness=dirty_rough)
    for kind in (0, 1):
        for a, b in zip(expected[kind][1:], found[kind][1:], strict=True):
            np.testing.assert_array_equal(a, b)


def test_normals_are_averaged_over_the_footprint():
    mesh = scenes.random_soup(3, 20)
    image = scenes.random_image(5, 32, 32, 3)
    vectors = 2 * image - 1
    vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    found = prefilter.normal_mipmaps(vectors, mesh.surface, encoded=False, footprint=1.0)
    means = prefilter.mipmaps(vectors, mesh.surface, bounds=None, footprint=1.0)
    for level, mean in zip(found[1:], means[1:], strict=True):
        length = np.linalg.norm(mean, axis=2, keepdims=True)
        sure = length[..., 0] > 0.02
        np.testing.assert_allclose(level[sure], (mean / length)[sure], atol=1e-5)


def test_least_squares_without_a_surface_take_a_roughness():
    image = scenes.random_image(5, 16, 8, 3)
    _, found = prefilter.normal_mipmaps(image, roughness=0.3, filter="ls-bilinear")
    _, expected = prefilter.normal_mipmaps(image, roughness=0.3, filter="box")
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_array_equal(a, b)


def test_results_do_not_depend_on_threads():
    image, rough = encode(bumps(17, 64, 64, 0.4)), scenes.random_image(18, 64, 64, 1)
    surface = scenes.random_soup(19, 30).surface
    one = prefilter.normal_mipmaps(image, surface, roughness=rough, threads=1)
    three = prefilter.normal_mipmaps(image, surface, roughness=rough, threads=3)
    for kind in (0, 1):
        for a, b in zip(one[kind], three[kind], strict=True):
            np.testing.assert_array_equal(a, b)


def test_progress_rises_to_one_and_cancels():
    image = encode(bumps(20, 64, 64, 0.4))
    told = []
    prefilter.normal_mipmaps(
        image, scenes.square().surface, roughness=image[..., :1], progress=told.append
    )
    assert told == sorted(told)
    assert told[-1] == 1
    with pytest.raises(prefilter.Cancelled):
        prefilter.normal_mipmaps(image, scenes.square().surface, progress=lambda _: False)


FLAT = np.full((8, 8, 3), (0.5, 0.5, 1.0), np.float32)
HOLE = FLAT.copy()
HOLE[2, 3, 1] = np.nan


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"normals": FLAT[..., :2]}, r"normals: shape \(8, 8, 2\); \(height, width, 3\)"),
        ({"normals": np.zeros((8, 8), np.float32)}, r"normals: shape \(8, 8\)"),
        ({"normals": np.zeros((0, 8, 3), np.float32)}, "normals: .* no pixels"),
        ({"normals": HOLE}, "normals: the texel in row 2, column 3 holds nan"),
        ({"roughness": -0.1}, r"roughness: -0.1; a number in \[0, 1\]"),
        ({"roughness": 1.5}, "roughness: 1.5"),
        ({"roughness": np.nan}, "roughness: nan"),
        ({"roughness": "rough"}, "roughness: 'rough'"),
        ({"roughness": FLAT}, r"roughness: shape \(8, 8, 3\); \(8, 8, 1\)"),
        ({"roughness": FLAT[:4, :, :1]}, r"roughness: shape \(4, 8, 1\); \(8, 8, 1\)"),
        ({"roughness": HOLE[..., 1:2]}, "roughness: the texel in row 2, column 3 holds nan"),
        ({"filter": "vector"}, "filter: 'vector'"),
        ({"wrap": "mirror"}, "wrap: 'mirror'"),
        ({"levels": 9}, "levels: 9"),
        ({"surface": None}, "surface: none was given"),
        ({"progress": 5}, "progress: 5"),
    ],
)
def test_bad_arguments(arguments, message):
    arguments = {"normals": FLAT, "surface": scenes.square().surface, **arguments}
    with pytest.raises(ValueError, match=message):
        prefilter.normal_mipmaps(**arguments)
