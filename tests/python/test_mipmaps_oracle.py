# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels against an independent oracle: dense quadrature over the surface, dense algebra."""

import numpy as np
import prefilter
import pytest
from scenes import (
    bilinear,
    bilinear_taps,
    in_border,
    join,
    random_image,
    random_soup,
    samples_inside,
    soup,
    square,
    surface_samples,
    wrap_indices,
)

# The part of BilinearSystem's documentation that a caller can see: texels are pulled to the mean of
# the image under their tent by this times the mean diagonal.
PULL = 1e-3

# Tolerance of the gradient: quadrature with 160 steps a triangle is accurate to half of it.
TOLERANCE = 2e-3

WRAPS = [
    ("clamp", "clamp"),
    ("repeat", "repeat"),
    ("border", "border"),
    ("repeat", "clamp"),
    ("clamp", "border"),
    ("border", "repeat"),
]


class Quadrature:
    """Points of a surface, their weights, and an image's values there."""

    def __init__(self, mesh, image, wrap, steps):
        self.wrap = wrap
        self.uvs, self.weights = samples_inside(mesh, steps, wrap)
        for axis, mode in enumerate(wrap):
            if mode == "clamp":
                self.uvs[:, axis] = np.clip(self.uvs[:, axis], 0, 1)
        self.source = bilinear(image, self.uvs, wrap)

    def taps(self, shape):
        """Texels that the points' lookups read, with weights: times area, and plain."""
        taps, shares = bilinear_taps(self.uvs, *shape, self.wrap)
        return taps.T, shares.T * self.weights, shares.T

    def times_tents(self, values, shape):
        """Integrals of values at the points, (n, channels), times the tents of a level."""
        taps, masses, _ = self.taps(shape)
        return np.stack(
            [
                sum(np.bincount(t, m * channel, np.prod(shape))
                    for t, m in zip(taps, masses, strict=True))
                for channel in values.T
            ],
            1,
        )  # fmt: skip


class Oracle:
    """The least-squares problem of one level, by quadrature."""

    def __init__(self, quadrature, shape):
        taps, shares, plain = quadrature.taps(shape)
        count = np.prod(shape)
        self.matrix = np.zeros((count, count))
        for i in range(4):
            for j in range(i, 4):
                flat = taps[i] * count + taps[j]
                part = np.bincount(flat, shares[i] * plain[j], count * count).reshape(count, count)
                self.matrix += part if i == j else part + part.T
        self.right = quadrature.times_tents(quadrature.source, shape)
        masses = np.bincount(taps.ravel(), shares.ravel(), count)
        self.used = np.diag(self.matrix) > 0
        diagonal = np.diag(self.matrix)
        self.pull = PULL * diagonal[self.used].mean()
        means = np.zeros_like(self.right)
        means[self.used] = self.right[self.used] / masses[self.used, None]
        self.pulled = self.matrix + self.pull * np.diag(self.used.astype(float))
        self.pulled_right = self.right + self.pull * means

    def gradient(self, level, more=0.0):
        """Half the objective's gradient over the diagonal: how far each texel would move alone.

        `more` is added to the image's right-hand side.
        Quadrature is inaccurate for texels of almost no weight, so the diagonal counts as at least
        a hundredth of its mean.
        """
        texels = level.reshape(-1, level.shape[2]).astype(np.float64)
        residual = self.pulled @ texels - self.pulled_right - more
        diagonal = np.diag(self.pulled)[self.used]
        return residual[self.used] / np.maximum(diagonal, 0.01 * diagonal.mean())[:, None]


def halved(height, width):
    """The sizes of all levels."""
    sizes = [(height, width)]
    while sizes[-1] != (1, 1):
        sizes.append((max(1, sizes[-1][0] // 2), max(1, sizes[-1][1] // 2)))
    return sizes


@pytest.mark.parametrize(
    ("size", "channels", "wrap"),
    [
        *(((16, 8), 1, wrap) for wrap in WRAPS),
        *(((7, 13), 1, wrap) for wrap in WRAPS),
        *(((16, 8), 3, wrap) for wrap in WRAPS[:1]),
        *(((10, 7), 2, wrap) for wrap in WRAPS[1:3]),
        *(((1, 19), 1, wrap) for wrap in WRAPS[:3]),
        *(((5, 1), 3, wrap) for wrap in WRAPS[3:]),
        *(((3, 3), 1, wrap) for wrap in WRAPS[1:4]),
    ],
)
def test_unbounded_levels_solve_the_normal_equations(wrap, size, channels):
    mesh = random_soup(3, 12, -0.4, 1.6)
    image = random_image(1, *size, channels)
    levels = prefilter.mipmaps(image, mesh.surface, wrap=wrap, bounds=None)
    assert [level.shape[:2] for level in levels] == halved(*size)
    quadrature = Quadrature(mesh, image, wrap, steps=160)
    for level in levels[1:]:
        oracle = Oracle(quadrature, level.shape[:2])
        assert np.abs(oracle.gradient(level)).max() < TOLERANCE


def clipped_optimally(texels, gradient):
    """Asserts that no texel could move within [0, 1] to gain; returns how many are at a bound."""
    low, high = texels <= 0.0, texels >= 1.0
    assert (gradient[low] > -TOLERANCE).all()
    assert (gradient[high] < TOLERANCE).all()
    assert np.abs(gradient[~low & ~high]).max() < TOLERANCE
    return int(low.sum() + high.sum())


@pytest.mark.parametrize("wrap", WRAPS[:3])
def test_bounded_levels_meet_the_optimality_conditions(wrap):
    mesh = random_soup(5, 10, -0.2, 1.2)
    image = (random_image(2, 16, 16, 3) > 0.5).astype(np.float32)
    levels = prefilter.mipmaps(image, mesh.surface, wrap=wrap, bounds=(0.0, 1.0))
    clipped = 0
    quadrature = Quadrature(mesh, image, wrap, steps=300)
    for level in levels[1:4]:
        oracle = Oracle(quadrature, level.shape[:2])
        gradient = oracle.gradient(level)
        texels = level.reshape(-1, 3)[oracle.used]
        clipped += clipped_optimally(texels, gradient)
    assert clipped > 10


def test_bounded_level_matches_a_dense_solver():
    optimize = pytest.importorskip("scipy.optimize")
    mesh = random_soup(7, 8)
    image = (random_image(4, 16, 16, 1) > 0.5).astype(np.float32)
    level = prefilter.mipmaps(image, mesh.surface, bounds=(0.0, 1.0))[1]
    oracle = Oracle(Quadrature(mesh, image, ("clamp", "clamp"), steps=300), level.shape[:2])
    used = oracle.used
    factor = np.linalg.cholesky(oracle.pulled[np.ix_(used, used)])
    target = np.linalg.solve(factor, oracle.pulled_right[used, 0])
    solved = optimize.lsq_linear(factor.T, target, bounds=(0.0, 1.0), tol=1e-12)
    weak = np.diag(oracle.pulled)[used] < 0.02 * np.diag(oracle.pulled)[used].mean()
    difference = np.abs(solved.x - level.reshape(-1)[used])[~weak]
    assert difference.max() < 5e-3

    clipped = np.clip(np.linalg.solve(oracle.pulled[np.ix_(used, used)],
                                      oracle.pulled_right[used, 0]), 0, 1)  # fmt: skip
    assert np.abs(clipped - solved.x).max() > 0.05, "the case must tell solving from clipping"


def test_levels_across_tiles_solve_the_normal_equations():
    mesh = join(
        soup([[(0.02, 0.1), (0.97, 0.03), (0.6, 0.95)], [(0.9, 0.99), (0.1, 0.8), (0.4, 0.4)]]),
        square((0.7, 0.7), (1.25, 1.1), area=0.3),
    )
    image = random_image(6, 64, 128, 1)
    wrap = ("repeat", "repeat")
    levels = prefilter.mipmaps(image, mesh.surface, wrap=wrap, bounds=None)
    quadrature = Quadrature(mesh, image, wrap, steps=500)
    for k in (3, 4, 5, 6, 7):
        oracle = Oracle(quadrature, levels[k].shape[:2])
        assert np.abs(oracle.gradient(levels[k])).max() < TOLERANCE, f"level {k}"


@pytest.mark.parametrize("size", [(65, 127), (97, 33)])
def test_levels_that_do_not_nest_solve_the_normal_equations_across_tiles(size):
    mesh = join(
        soup([[(0.02, 0.1), (0.97, 0.03), (0.6, 0.95)], [(0.9, 0.99), (0.1, 0.8), (0.4, 0.4)]]),
        square((0.7, 0.7), (1.25, 1.1), area=0.3),
    )
    image = random_image(6, *size, 1)
    wrap = ("repeat", "repeat")
    levels = prefilter.mipmaps(image, mesh.surface, wrap=wrap, bounds=None)
    quadrature = Quadrature(mesh, image, wrap, steps=500)
    for k in range(3, len(levels)):
        oracle = Oracle(quadrature, levels[k].shape[:2])
        assert np.abs(oracle.gradient(levels[k])).max() < TOLERANCE, f"level {k}"


def trilinear_gradient(levels, mesh, image, wrap, steps):
    """Gradient of half the integral over mip values and surface, over the diagonal, per level.

    Quadrature over the surface, and Simpson's rule over each interval of mip values, which is
    exact for products of the levels' weights.
    """
    quadrature = Quadrature(mesh, image, wrap, steps)
    lookups = [bilinear(level, quadrature.uvs, wrap) for level in levels]
    source = quadrature.source
    pulls = [np.zeros_like(source) for _ in levels]
    for k in range(len(levels) - 1):
        for f, share in ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6)):
            residual = (1 - f) * lookups[k] + f * lookups[k + 1] - source
            pulls[k] += share * (1 - f) * residual
            pulls[k + 1] += share * f * residual
    for level, pull in zip(levels[1:-1], pulls[1:-1], strict=True):
        oracle = Oracle(quadrature, level.shape[:2])
        gradient = quadrature.times_tents(pull, level.shape[:2])
        texels = level.reshape(-1, image.shape[2])
        pulled = oracle.pulled - oracle.matrix
        gradient += 2 / 3 * (pulled @ texels - (oracle.pulled_right - oracle.right))
        diagonal = 2 / 3 * np.diag(oracle.pulled)[oracle.used]
        scale = np.maximum(diagonal, 0.01 * diagonal.mean())
        yield texels[oracle.used], gradient[oracle.used] / scale[:, None]


@pytest.mark.parametrize(
    ("size", "wrap"),
    [
        ((16, 8), ("clamp", "clamp")),
        ((16, 16), ("repeat", "repeat")),
        ((11, 13), ("clamp", "repeat")),
        ((7, 12), ("repeat", "repeat")),
        ((1, 21), ("clamp", "clamp")),
        ((10, 18), ("border", "clamp")),
    ],
)
def test_trilinear_levels_solve_the_normal_equations_together(size, wrap):
    mesh = random_soup(3, 12, -0.2, 1.2)
    image = random_image(1, *size, 2)
    levels = prefilter.mipmaps(image, mesh.surface, filter="pam-trilinear", wrap=wrap, bounds=None)
    assert [level.shape[:2] for level in levels] == halved(*size)
    for _, gradient in trilinear_gradient(levels, mesh, image, wrap, 200):
        assert np.abs(gradient).max() < TOLERANCE
    if "border" not in wrap:  # There a lookup fades to 0 away from the only texel's center.
        mean = prefilter.mipmaps(image, mesh.surface, wrap=wrap, bounds=None)[-1]
        np.testing.assert_allclose(levels[-1], mean, atol=1e-5)


def test_bounded_trilinear_levels_meet_the_optimality_conditions():
    mesh = random_soup(5, 10, -0.2, 1.2)
    wrap = ("repeat", "repeat")
    image = (random_image(2, 16, 16, 3) > 0.5).astype(np.float32)
    levels = prefilter.mipmaps(image, mesh.surface, filter="pam-trilinear", wrap=wrap)
    clipped = 0
    for texels, gradient in trilinear_gradient(levels, mesh, image, wrap, 200):
        clipped += clipped_optimally(texels, gradient)
    assert clipped > 10


def test_fewer_trilinear_levels_are_the_first_of_all():
    mesh = random_soup(6, 10)
    image = random_image(3, 40, 24, 3)
    whole = prefilter.mipmaps(image, mesh.surface, filter="pam-trilinear")
    few = prefilter.mipmaps(image, mesh.surface, filter="pam-trilinear", levels=3)
    assert len(few) == 3
    for a, b in zip(few, whole, strict=False):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("wrap", ["clamp", "repeat", "border"])
@pytest.mark.parametrize("size", [(8, 16), (7, 13), (1, 9)])
def test_pam_box_is_the_mean_over_the_surface(wrap, size):
    mesh = random_soup(11, 9, -0.3, 1.3)
    image = random_image(5, *size, 2)
    levels = prefilter.mipmaps(image, mesh.surface, filter="pam-box", wrap=wrap)
    uvs, weights = surface_samples(mesh, 500)
    kept = ~in_border(uvs, (wrap, wrap))
    uvs, weights = uvs[kept], weights[kept]

    def texels(height, width):
        column, _ = wrap_indices(np.floor(uvs[:, 0] * width).astype(int), width, wrap)
        row, _ = wrap_indices(np.floor(uvs[:, 1] * height).astype(int), height, wrap)
        return row, column

    row, column = texels(*size)
    for k, level in enumerate(levels[1:], 1):
        height, width = level.shape[:2]
        level_row, level_column = texels(height, width)
        flat = level_row * width + level_column
        mass = np.bincount(flat, weights, height * width)
        for c in range(2):
            sums = np.bincount(flat, weights * image[row, column, c], height * width)
            strong = mass > 0.05 * mass.mean()
            found = level[..., c].reshape(-1)[strong]
            assert np.abs(found - sums[strong] / mass[strong]).max() < 1e-2, f"level {k}"


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("size", [(16, 32), (13, 47), (40, 1)])
def test_error_is_the_error_of_lookups(wrap, size):
    mesh = random_soup(13, 7, -0.2, 1.2)
    image = random_image(8, *size, 3)
    levels = [random_image(k, *level, 3) for k, level in enumerate(halved(*size))]
    values = [0.0, 0.3, 1.0, 2.75, 4.5, 5.0]
    found = prefilter.mipmap_error(levels, image, mesh.surface, values, wrap=wrap)
    uvs, weights = surface_samples(mesh, 150)
    kept = ~in_border(uvs, wrap)
    uvs, weights = uvs[kept], weights[kept]
    for axis, mode in enumerate(wrap):
        if mode == "clamp":
            uvs[:, axis] = np.clip(uvs[:, axis], 0, 1)
    source = bilinear(image, uvs, wrap)
    for value, error in zip(values, found, strict=True):
        k = min(int(value), 4)
        f = value - k
        lookup = (1 - f) * bilinear(levels[k], uvs, wrap) + f * bilinear(levels[k + 1], uvs, wrap)
        squared = ((lookup - source) ** 2).mean(axis=1)
        expected = np.sqrt((squared * weights).sum() / weights.sum())
        assert error == pytest.approx(expected, rel=2e-3)


def test_error_of_flat_triangles_is_along_their_lines():
    line = soup([[(0.1, 0.2), (0.9, 0.7), (0.5, 0.45)]])
    point = soup([[(0.3, 0.6)] * 3], np.array([0.25]))
    image = random_image(9, 16, 16, 1)
    levels = prefilter.mipmaps(image, surface=square().surface)
    mesh = join(line, point)
    found = prefilter.mipmap_error(levels, image, mesh.surface, [1.0, 2.0])
    uvs, weights = surface_samples(mesh, 1000)
    source = bilinear(image, uvs, ("clamp", "clamp"))
    for k, error in zip((1, 2), found, strict=True):
        lookup = bilinear(levels[k], uvs, ("clamp", "clamp"))
        expected = np.sqrt((((lookup - source) ** 2)[:, 0] * weights).sum() / weights.sum())
        assert error == pytest.approx(expected, rel=1e-4)
