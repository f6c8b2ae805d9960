# SPDX-License-Identifier: GPL-3.0-or-later

"""The seam term and the contrast across seams, against sums over points along them."""

from itertools import pairwise

import numpy as np
import prefilter
import pytest
from scenes import Mesh, bilinear, bilinear_taps, random_image, surface_samples
from test_mipmaps_oracle import Oracle, Quadrature

CLAMP = ("clamp", "clamp")


def folded():
    """Two unit squares that share an edge in space; in the texture they are apart.

    The second one is turned and smaller there.
    """
    positions = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1]], np.float64
    )
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])
    left = {0: (0.05, 0.1), 1: (0.45, 0.1), 2: (0.45, 0.8), 3: (0.05, 0.8)}
    right = {1: (0.6, 0.9), 4: (0.6, 0.5), 5: (0.95, 0.55), 2: (0.9, 0.95)}
    uvs = np.array(
        [[(left if k < 2 else right)[v] for v in t] for k, t in enumerate(triangles)], np.float64
    )
    return (
        Mesh(positions, triangles, uvs),
        np.array([left[1], left[2]]),
        np.array([right[1], right[2]]),
    )


def sides(left, right, count):
    f = ((np.arange(count) + 0.5) / count)[:, None]
    return left[0] + f * (left[1] - left[0]), right[0] + f * (right[1] - right[0])


@pytest.mark.parametrize("size", [(16, 16), (7, 13)])
def test_contrast_is_the_difference_along_the_seam(size):
    mesh, left, right = folded()
    levels = [random_image(1, *size, 3), random_image(2, 4, 3, 3), random_image(3, 1, 1, 3)]
    found = prefilter.seam_contrast(levels, mesh.surface)
    ours, theirs = sides(left, right, 20_000)
    for level, contrast in zip(levels, found, strict=True):
        difference = bilinear(level, ours, CLAMP) - bilinear(level, theirs, CLAMP)
        assert contrast == pytest.approx(np.sqrt((difference**2).mean()), rel=2e-4, abs=1e-6)


def test_contrast_without_a_seam_is_none():
    mesh, _, _ = folded()
    one = prefilter.Surface(mesh.positions, mesh.triangles[:2], mesh.uvs[:2])
    assert prefilter.seam_contrast([random_image(1, 8, 8, 1)], one).tolist() == [0.0]


def test_coordinates_that_differ_by_rounding_are_no_seam():
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]], np.float64)
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    uvs = np.array([[(0.1, 0.1), (0.5, 0.1), (0.5, 0.9)], [(0.5, 0.1), (0.9, 0.1), (0.5, 0.9)]])
    image = random_image(1, 8, 8, 1)
    contrasts = []
    for apart in (8 * np.finfo(np.float32).eps / 2, 1e-4):
        moved = uvs + np.array([0, apart])[:, None, None]
        surface = prefilter.Surface(positions, triangles, moved)
        contrasts.append(prefilter.seam_contrast([image], surface)[0])
    assert contrasts[0] == 0.0
    assert contrasts[1] > 0.0


def test_a_tile_of_a_repeated_texture_has_no_contrast():
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]], np.float64)
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    uvs = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 0), (0, 1)]], np.float64)
    surface = prefilter.Surface(positions, triangles, uvs)
    image = random_image(1, 8, 8, 2)
    assert prefilter.seam_contrast([image], surface, wrap="repeat")[0] < 1e-6
    assert prefilter.seam_contrast([image], surface, wrap="clamp")[0] > 0.1


def test_split_vertices_at_one_place_are_one():
    mesh, _, _ = folded()
    split = Mesh(
        mesh.positions[mesh.triangles].reshape(-1, 3), np.arange(12).reshape(-1, 3), mesh.uvs
    )
    image = random_image(1, 16, 16, 3)
    assert prefilter.seam_contrast([image], split.surface) == pytest.approx(
        prefilter.seam_contrast([image], mesh.surface), rel=1e-9
    )


def seam_matrix(left, right, shape, count=20_000):
    """The matrix whose quadratic form is the mean square of the difference, for one channel."""
    ours, theirs = sides(left, right, count)
    taps, shares = bilinear_taps(ours, *shape, CLAMP)
    other_taps, other_shares = bilinear_taps(theirs, *shape, CLAMP)
    rows = np.zeros((count, shape[0] * shape[1]))
    np.add.at(rows, (np.arange(count)[:, None], taps), shares)
    np.add.at(rows, (np.arange(count)[:, None], other_taps), -other_shares)
    return rows.T @ rows / count


def without_contrast(image, *lines):
    """The image with one color in all texels that are read along the lines: none differs there."""
    changed = image.copy()
    for line in lines:
        taps, _ = bilinear_taps(line, *image.shape[:2], CLAMP)
        changed.reshape(-1, image.shape[2])[np.unique(taps)] = 0.5
    return changed


def rises(levels, alone, image, surface, **options):
    """Relative increases in error of levels 1 and up over levels that ignore seams."""
    at = np.arange(1, len(levels))
    more, least = (
        prefilter.mipmap_error(made, image, surface, at, **options) for made in (levels, alone)
    )
    return more / least - 1


def least_contrast(oracle, seam, image_square, budget):
    """The least contrast of texels with an error within budget, by dense algebra and bisection."""
    used = oracle.used
    area, right = oracle.matrix[np.ix_(used, used)], oracle.right[used]
    pulled, goal = oracle.pulled[np.ix_(used, used)], oracle.pulled_right[used]
    across = seam[np.ix_(used, used)]

    def solved(weight):
        texels = np.linalg.solve(pulled + weight * across, goal)
        error = image_square + ((area @ texels - 2 * right) * texels).sum()
        return np.sqrt(error), np.sqrt((texels * (across @ texels)).sum() / texels.shape[1])

    allowed = (1 + budget) * solved(0.0)[0]
    low, high = 0.0, 1e4
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if solved(middle)[0] <= allowed else (low, middle)
    return solved(low)


@pytest.mark.parametrize("budget", [0.003, 0.02])
@pytest.mark.parametrize("size", [(16, 16), (9, 14)])
def test_no_level_within_the_budget_has_less_contrast(size, budget):
    mesh, left, right = folded()
    # A seam along which the image differs is left alone.
    image = without_contrast(random_image(4, *size, 2), *sides(left, right, 20_000))
    assert prefilter.seam_contrast([image], mesh.surface)[0] < 1e-7
    alone = prefilter.mipmaps(image, mesh.surface, bounds=None)
    levels = prefilter.mipmaps(image, mesh.surface, bounds=None, seam_budget=budget)
    contrasts = prefilter.seam_contrast(levels, mesh.surface)
    without = prefilter.seam_contrast(alone, mesh.surface)
    rise = rises(levels, alone, image, mesh.surface)
    assert (rise <= budget * 1.001).all()
    uvs, weights = surface_samples(mesh, 300)
    square = (weights[:, None] * bilinear(image, uvs, CLAMP) ** 2).sum()
    for k in (1, 2):
        shape = levels[k].shape[:2]
        oracle = Oracle(Quadrature(mesh, image, CLAMP, steps=300), shape)
        _, least = least_contrast(oracle, seam_matrix(left, right, shape), square, budget)
        if rise[k - 1] > 0.9 * budget:
            assert contrasts[k] < 1.03 * least
        else:  # next to nothing is left
            assert contrasts[k] < 0.1 * without[k]


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear"])
@pytest.mark.parametrize("reader", ["linear", "srgb-after"])
@pytest.mark.parametrize("seed", range(3))
def test_budgets_hold_on_any_surface(filter, reader, seed):
    if filter == "pam-trilinear" and reader != "linear":
        pytest.skip("readers that decode after the lookup do not interpolate between levels")
    random = np.random.default_rng(seed)
    mesh = crumpled(random)
    image = random_image(seed, *random.integers(20, 60, 2), 3)
    image[:, :] = image.mean(axis=2, keepdims=True) if seed == 1 else image
    options = {"filter": filter, "reader": reader}
    alone = prefilter.mipmaps(image, mesh.surface, **options)
    for budget in (0.001, 0.01, 0.3):
        levels = prefilter.mipmaps(image, mesh.surface, seam_budget=budget, **options)
        rise = rises(levels, alone, image, mesh.surface, reader=reader)
        # The fit for encoded texels measures its error by a coarser rule than mipmap_error.
        slack = 1.001 if reader == "linear" else 1.1
        assert (rise <= slack * budget + 1e-5).all()
        for level in levels[1:]:
            assert level.min() >= 0.0
            assert level.max() <= 1.0


def crumpled(random):
    """A grid of squares in space, each elsewhere in the texture."""
    side = 4
    positions = np.array([(x, y, 0) for x in range(side + 1) for y in range(side + 1)], float)
    triangles, uvs = [], []
    for x in range(side):
        for y in range(side):
            a, b = x * (side + 1) + y, (x + 1) * (side + 1) + y
            corner, axis = random.uniform(0.1, 0.6, 2), random.uniform(0.05, 0.3, 2)
            other = np.array([-axis[1], axis[0]]) * random.choice([-1, 1])
            at = {a: corner, b: corner + axis, b + 1: corner + axis + other, a + 1: corner + other}
            for triangle in ((a, b, b + 1), (a, b + 1, a + 1)):
                triangles.append(triangle)
                uvs.append([at[vertex] for vertex in triangle])
    return Mesh(positions, np.array(triangles), np.array(uvs))


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear"])
def test_more_budget_hides_more(filter):
    mesh, _, _ = folded()
    image = continuous(mesh, 32)
    contrasts = [
        prefilter.seam_contrast(
            prefilter.mipmaps(image, mesh.surface, filter=filter, seam_budget=budget, levels=4),
            mesh.surface,
        )[1:]
        for budget in (0.0, 1e-300, 1e-6, 0.001, 0.01, 0.1, 1.0, 1e300)
    ]
    # The largest budgets leave almost no contrast, and their order does not matter.
    for less, more in pairwise(contrasts):
        assert (more <= 1.02 * less + 0.03 * contrasts[0]).all()
    assert (contrasts[-1] < 0.2 * contrasts[0]).all()


def test_an_image_of_one_color_stays():
    mesh, _, _ = folded()
    image = np.full((16, 16, 3), 0.25, np.float32)
    for level in prefilter.mipmaps(image, mesh.surface, seam_budget=0.1):
        np.testing.assert_allclose(level, 0.25, atol=1e-5)


@pytest.mark.parametrize("footprint", [0.0, 0.7, 1.0, 1.5])
@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear"])
def test_footprints_have_budgets_of_their_own(filter, footprint):
    """The budget is a share of the error against the averaged image, which is smaller."""
    mesh, left, right = folded()
    image = without_contrast(random_image(9, 32, 32, 2), *sides(left, right, 20_000))
    contrasts = [
        prefilter.seam_contrast(
            prefilter.mipmaps(
                image, mesh.surface, filter=filter, footprint=footprint, seam_budget=budget
            ),
            mesh.surface,
        )[1:3]
        for budget in (0.0, 0.01, 0.1)
    ]
    for less, more in pairwise(contrasts):
        assert (more < np.maximum(less, 0.05 * contrasts[0])).all()


def test_corners_of_one_color_do_not_tell_the_contrast():
    """Stripes that have a whole number of periods along every edge of a mesh of few triangles."""
    period = 0.3
    positions = np.array([(x, y, 0) for x in range(3) for y in range(2)], np.float64)
    triangles = np.array([(0, 2, 3), (0, 3, 1), (2, 4, 5), (2, 5, 3)])
    low = {0: (0.05, 0.1), 2: (0.45, 0.1), 3: (0.45, 0.4), 1: (0.05, 0.4)}
    high = {2: (0.55, 0.4), 4: (0.95, 0.4), 5: (0.95, 0.7), 3: (0.55, 0.7)}
    uvs = np.array([[(low if k < 2 else high)[v] for v in t] for k, t in enumerate(triangles)])
    surface = prefilter.Surface(positions, triangles, uvs)
    rows = (np.arange(128) + 0.5) / 128
    waves = sum(np.sin(2 * np.pi * (k * rows / period + 0.1 * k)) for k in (1, 2, 3))
    image = np.broadcast_to((0.5 + 0.15 * waves)[:, None, None], (128, 128, 1)).astype(np.float32)
    before, after = (
        prefilter.seam_contrast(prefilter.mipmaps(image, surface, seam_budget=budget), surface)
        for budget in (0.0, 0.02)
    )
    assert (after[3:6] < 0.6 * before[3:6]).all()


def continuous(mesh, size):
    """An image of a pattern on the surface: the same on both sides of the seam."""
    centers = (np.arange(size) + 0.5) / size
    u, v = np.meshgrid(centers, centers)
    at = np.zeros((size, size, 3))
    for corners, uvs in zip(mesh.positions[mesh.triangles], mesh.uvs, strict=True):
        edges = np.linalg.inv((uvs[1:] - uvs[0]).T)
        b, c = np.einsum("ij,jkl->ikl", edges, np.stack([u - uvs[0, 0], v - uvs[0, 1]]))
        a = 1 - b - c
        inside = np.minimum(np.minimum(a, b), c) > -0.1
        near = np.einsum("ikl,ij->klj", np.stack([a, b, c]), corners)
        at = np.where(inside[..., None], near, at)
    waves = np.sin(at @ np.array([[9.0, 2, 4], [3, 11, 8], [7, 5, 3]]) + [0, 1, 2])
    return (0.5 + 0.45 * waves).astype(np.float32)


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear"])
@pytest.mark.parametrize("reader", ["linear", "srgb-after"])
def test_a_seam_closes(filter, reader):
    if filter == "pam-trilinear" and reader != "linear":
        pytest.skip("readers that decode after the lookup do not interpolate between levels")
    mesh, _, _ = folded()
    image = continuous(mesh, 32)

    def contrast(budget):
        levels = prefilter.mipmaps(
            image, mesh.surface, filter=filter, reader=reader, seam_budget=budget, levels=4
        )
        return prefilter.seam_contrast(levels, mesh.surface)

    alone, light, heavy = (contrast(budget) for budget in (0.0, 0.02, 2.0))
    assert (light[1:] < 0.8 * alone[1:]).all()
    # The iterations of the fit for encoded texels end before a large weight has converged.
    left = 0.3 if reader == "linear" else 0.5
    assert (heavy[1:] < left * alone[1:]).all()


def test_copies_and_scales_of_the_surface_do_not_matter():
    mesh, _, _ = folded()
    image = random_image(6, 16, 16, 1)
    levels = prefilter.mipmaps(image, mesh.surface, seam_budget=0.01)
    larger = prefilter.Surface(mesh.positions * 37.0, mesh.triangles, mesh.uvs)
    for a, b in zip(levels, prefilter.mipmaps(image, larger, seam_budget=0.01), strict=True):
        np.testing.assert_allclose(a, b, atol=2e-5)
    twice = [mesh.surface, mesh.surface]
    for a, b in zip(levels, prefilter.mipmaps(image, twice, seam_budget=0.01), strict=True):
        np.testing.assert_allclose(a, b, atol=2e-4)


def test_results_do_not_depend_on_threads():
    mesh, _, _ = folded()
    image = random_image(7, 200, 160, 3)
    one, many = (
        prefilter.mipmaps(image, mesh.surface, seam_budget=0.01, threads=threads)
        for threads in (1, 4)
    )
    for a, b in zip(one, many, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_change_of_color_along_a_seam_stays():
    mesh, _, _ = folded()
    image = np.zeros((32, 32, 1), np.float32)
    image[:, 17:] = 1.0  # The one square is black and the other white.
    levels = prefilter.mipmaps(image, mesh.surface, seam_budget=0.01, levels=4)
    alone = prefilter.mipmaps(image, mesh.surface, levels=4)
    values = [1.0, 2.0, 3.0]
    error = prefilter.mipmap_error(levels, image, mesh.surface, values)
    least = prefilter.mipmap_error(alone, image, mesh.surface, values)
    assert (error <= least + 0.01).all()


def test_bad_levels_are_refused():
    mesh, _, _ = folded()
    image = random_image(1, 8, 8, 1)
    with pytest.raises(ValueError, match="levels: none"):
        prefilter.seam_contrast([], mesh.surface)
    with pytest.raises(ValueError, match="levels: level 1 has 2 channels"):
        prefilter.seam_contrast([image, random_image(1, 4, 4, 2)], mesh.surface)
    with pytest.raises(
        ValueError, match="levels: a seam reads a texel that is not finite in level 0"
    ):
        prefilter.seam_contrast([np.full((8, 8, 1), np.nan)], mesh.surface)
    with pytest.raises(ValueError, match="surface: none was given"):
        prefilter.seam_contrast([image], [])
