# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels for readers that look once a pixel, against dense quadrature, algebra and waves."""

import numpy as np
import prefilter
import pytest
from scenes import bilinear, join, random_image, random_soup, samples_inside, square
from test_mipmaps_oracle import TOLERANCE, Oracle, Quadrature, halved

WRAPS = [("clamp", "clamp"), ("repeat", "repeat"), ("border", "border"), ("repeat", "clamp")]
REPEAT = ("repeat", "repeat")


def tent_means(image, wrap):
    """Each texel's mean of the interpolated image under its tent; nothing beyond a border counts.

    The products of two tents a texel apart, and of one with itself, integrate to 1/6 and 2/3.
    """
    modes = {"clamp": "edge", "repeat": "wrap", "border": "constant"}
    sums = np.concatenate([image, np.ones((*image.shape[:2], 1))], axis=2)
    for axis, mode in ((1, wrap[0]), (0, wrap[1])):
        around = [(1, 1) if each == axis else (0, 0) for each in range(3)]
        padded = np.pad(sums, around, mode=modes[mode])
        low, middle, high = (np.take(padded, np.arange(k, k + sums.shape[axis]), axis)
                             for k in range(3))  # fmt: skip
        sums = (low + 4 * middle + high) / 6
    return sums[..., :-1] / sums[..., -1:]


def means_of(oracle, shape):
    """The means p of a level, to which its texels are pulled."""
    means = (oracle.pulled_right - oracle.right) / oracle.pull
    return means.reshape(*shape, -1)


class Target:
    """Right-hand sides of a level's equations, by the definition of the footprint."""

    def __init__(self, mesh, image, wrap, steps):
        self._quadrature = Quadrature(mesh, image, wrap, steps)
        self._shapes = halved(*image.shape[:2])
        self._means = [tent_means(image, wrap)]
        self._oracles = {}

    def oracle(self, k):
        if k not in self._oracles:
            self._oracles[k] = Oracle(self._quadrature, self._shapes[k])
        return self._oracles[k]

    def times_tents(self, image, k):
        """Integrals of an image of any size times the tents of level k."""
        of_points = bilinear(image, self._quadrature.uvs, self._quadrature.wrap)
        return self._quadrature.times_tents(of_points, self._shapes[k])

    def right_side(self, k, variance):
        """The right-hand side of level k; `variance` of the footprint, 1 for a box of one texel."""
        oracle = self.oracle(k)
        while len(self._means) <= k:
            level = len(self._means)
            self._means.append(means_of(self.oracle(level), self._shapes[level]))
        fine = self.times_tents(self._means[k - 1], k)
        own = oracle.matrix @ self._means[k].reshape(len(oracle.used), -1)
        if variance <= 1:
            return (1 - variance) * oracle.right + variance * fine
        return ((4 - variance) * fine + (variance - 1) * own) / 3


@pytest.mark.parametrize(
    ("size", "wrap"), [((16, 8), WRAPS[0]), *(((7, 13), w) for w in WRAPS[1:])]
)
def test_levels_fit_the_image_averaged_over_the_footprint(wrap, size):
    # The square makes sure that every texel is read.
    mesh = join(random_soup(3, 12, -0.4, 1.6), square(area=0.05))
    image = random_image(1, *size, 2)
    target = Target(mesh, image, wrap, 160)
    for footprint in (0.5, 1.0, 1.5):
        levels = prefilter.mipmaps(image, mesh.surface, wrap=wrap, bounds=None, footprint=footprint)
        for k, level in enumerate(levels[1:], 1):
            oracle = target.oracle(k)
            averaged = target.right_side(k, footprint**2) - oracle.right
            off = np.abs(oracle.gradient(level, averaged)).max()
            assert off < TOLERANCE, f"{footprint}, level {k}"


@pytest.mark.parametrize(
    ("footprint", "size", "wrap"),
    [(1.0, (16, 16), REPEAT), (0.5, (7, 12), ("clamp", "border"))],
)
def test_trilinear_levels_fit_what_pixels_cover_at_every_mip_value(footprint, size, wrap):
    mesh = join(random_soup(3, 12, -0.2, 1.2), square(area=0.05))
    image = random_image(1, *size, 2)
    options = {"filter": "pam-trilinear", "wrap": wrap, "bounds": None}
    levels = prefilter.mipmaps(image, mesh.surface, footprint=footprint, **options)
    target = Target(mesh, image, wrap, 200)
    # The mean square of a pixel's width in texels of the level, by Simpson's rule.
    steps, shares = np.linspace(0, 1, 65), np.tile([2.0, 4.0], 33)[:65]
    shares[[0, -1]] = 1.0
    covered = (shares * (steps * 4 ** (steps - 1) + (1 - steps) * 4**steps)).sum() / (3 * 64)
    for k in range(1, len(levels) - 1):
        oracle = target.oracle(k)
        right = target.right_side(k, footprint**2 * covered)
        between = [target.times_tents(levels[at], k) for at in (k - 1, k + 1)]
        texels = levels[k].reshape(len(oracle.used), -1)
        pulls = (oracle.pulled - oracle.matrix) @ texels - (oracle.pulled_right - oracle.right)
        gradient = (oracle.matrix @ texels + pulls) * 2 / 3 + sum(between) / 6 - right
        diagonal = 2 / 3 * np.diag(oracle.pulled)
        scale = np.maximum(diagonal, 0.01 * diagonal.mean())
        assert np.abs(gradient / scale[:, None]).max() < TOLERANCE, f"level {k}"


# Waves that the level can hold, and whose images in the interpolated means are faint.
@pytest.mark.parametrize(
    ("footprint", "spline", "frequency"),
    [(1.0, 0.5, 4), (1.0, 0.5, 8), (1.0, 0.5, 16), (1.0, 0.5, 24), (2.0, 1.0, 4), (2.0, 1.0, 12)],
)
def test_waves_fade_as_under_a_cubic_b_spline(footprint, spline, frequency):
    size, level = 128, 1
    wave = np.cos(2 * np.pi * frequency * (np.arange(size) + 0.5) / size)
    image = np.broadcast_to(wave[None, :, None], (4, size, 1)).astype(np.float32)
    options = {"filter": "ls-bilinear", "wrap": "repeat", "bounds": None, "levels": 2}
    plain = prefilter.mipmaps(image, **options)[level]
    faded = prefilter.mipmaps(image, footprint=footprint, **options)[level]
    expected = np.sinc(spline * frequency * 2**level / size) ** 4
    found = (faded * plain).sum() / (plain * plain).sum()
    assert found == pytest.approx(expected, abs=0.03)


def test_means_over_the_surface_stay():
    mesh = random_soup(9, 10)
    image = random_image(2, 32, 32, 3)
    uvs, weights = samples_inside(mesh, 300, ("clamp", "clamp"))

    def mean(level):
        return (weights[:, None] * bilinear(level, uvs, ("clamp", "clamp"))).sum(0) / weights.sum()

    expected = mean(image)
    for footprint in (0.7, 1.0, 2.0):
        levels = prefilter.mipmaps(image, mesh.surface, bounds=None, footprint=footprint)
        for level in levels[2:]:
            np.testing.assert_allclose(mean(level), expected, atol=2e-3)


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear"])
@pytest.mark.parametrize("paint", [1e6, np.nan, np.inf])
def test_texels_that_nothing_reads_have_no_influence(filter, paint):
    mesh = square((0.25, 0.25), (0.5, 0.5))
    image = random_image(4, 64, 64, 3)
    painted = image.copy()
    painted[:12] = painted[:, 40:] = paint
    a, b = (
        prefilter.mipmaps(each, mesh.surface, filter=filter, footprint=1.0)
        for each in (image, painted)
    )
    for before, after in zip(a[1:], b[1:], strict=True):
        np.testing.assert_array_equal(before, after)


@pytest.mark.parametrize("filter", ["ls-bilinear", "pam-bilinear", "pam-trilinear"])
def test_levels_do_not_depend_on_threads(filter):
    mesh = random_soup(5, 30)
    image = random_image(4, 150, 200, 4)
    one, four = (
        prefilter.mipmaps(image, mesh.surface, filter=filter, footprint=1.0, threads=threads)
        for threads in (1, 4)
    )
    for a, b in zip(one, four, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("footprint", [-0.1, 2.1, np.nan, np.inf])
def test_what_a_footprint_can_be(footprint):
    image = random_image(1, 8, 8, 1)
    with pytest.raises(ValueError, match=r"footprint: .* 0 to 2 texels"):
        prefilter.mipmaps(image, filter="ls-bilinear", footprint=footprint)


def test_what_has_a_footprint():
    image = random_image(1, 8, 8, 1)
    with pytest.raises(ValueError, match=r"footprint: 1; .*ls-bilinear, pam-bilinear"):
        prefilter.mipmaps(image, filter="box", footprint=1.0)
    with pytest.raises(ValueError, match=r"footprint: 1; .*linear reader"):
        prefilter.mipmaps(image, filter="ls-bilinear", reader="srgb-after", footprint=1.0)


@pytest.mark.parametrize("wrap", WRAPS)
def test_least_squares_without_a_surface_are_those_of_the_unit_square(wrap):
    image = random_image(3, 24, 40, 3)
    alone = prefilter.mipmaps(image, filter="ls-bilinear", wrap=wrap)
    over = prefilter.mipmaps(image, square().surface, wrap=wrap)
    other = prefilter.mipmaps(image, random_soup(1, 3).surface, filter="ls-bilinear", wrap=wrap)
    for a, b, c in zip(alone, over, other, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-5)
        np.testing.assert_array_equal(a, c)
