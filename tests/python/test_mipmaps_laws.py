# SPDX-License-Identifier: GPL-3.0-or-later

"""Laws that hold for every filter and all numbers."""

import itertools

import kernels
import numpy as np
import prefilter
import pytest
from scenes import bilinear_taps, join, random_image, random_soup, soup, square, surface_samples

PLAIN = ["box", "tent", "bspline2", "mitchell", "lanczos2", "lanczos3", "gaussian"]
COVERED = ["box-covered", "mitchell-covered", "lanczos3-covered"]
PAM = ["pam-box", "pam-bilinear", "pam-trilinear"]
ALL = [*PLAIN, *(f"{name}-covered" for name in PLAIN), "ls-bilinear", *PAM]
CLAMP = ("clamp", "clamp")


def box_mean(image: np.ndarray, level: int) -> np.ndarray:
    height, width, channels = image.shape
    rows, columns = max(1, height >> level), max(1, width >> level)
    blocks = image.reshape(rows, height // rows, columns, width // columns, channels)
    return blocks.mean(axis=(1, 3), dtype=np.float64)


@pytest.mark.parametrize("filter", ALL)
@pytest.mark.parametrize("wrap", ["clamp", "repeat"])
def test_a_constant_image_stays_constant(filter, wrap):
    image = np.full((32, 64, 4), (0.2, 0.4, 0.6, 1.0), np.float32)
    surface = random_soup(1, 5, -0.2, 1.2).surface
    for level in prefilter.mipmaps(image, surface, filter=filter, wrap=wrap):
        # The matrix blocks that couple levels add rounding errors of their own.
        rounding = 5e-6 if filter == "pam-trilinear" else 2e-6
        assert np.abs(level - image[0, 0]).max() < rounding


@pytest.mark.parametrize("filter", ALL)
def test_sizes_types_and_level_zero(filter):
    image = random_image(0, 8, 64, 2)
    levels = prefilter.mipmaps(image.astype(np.float64), square().surface, filter=filter)
    sizes = [(8, 64), (4, 32), (2, 16), (1, 8), (1, 4), (1, 2), (1, 1)]
    assert [level.shape for level in levels] == [(*size, 2) for size in sizes]
    assert all(level.dtype == np.float32 for level in levels)
    assert np.array_equal(levels[0], image)
    some = prefilter.mipmaps(image, square().surface, filter=filter, levels=3)
    assert len(some) == 3
    assert all(np.array_equal(a, b) for a, b in zip(some, levels, strict=False))


@pytest.mark.parametrize("filter", ["box", "box-covered", "pam-box"])
def test_box_filters_are_block_means_under_an_even_parameterization(filter):
    image = random_image(2, 64, 32, 3)
    levels = prefilter.mipmaps(image, square().surface, filter=filter)
    for k, level in enumerate(levels):
        assert np.abs(level - box_mean(image, k)).max() < 1e-6


def quadratic_b_spline(x):
    """A box convolved with a tent: the mean of the tent over [x - 1/2, x + 1/2]."""
    low, high = (np.clip(x + step, -1, 1) for step in (-0.5, 0.5))
    return (high - high * np.abs(high) / 2) - (low - low * np.abs(low) / 2)


def mitchell(x):
    """Convex combination of the cubic B-spline and the Catmull-Rom spline, 1 : 2."""
    x = np.abs(x)
    b_spline = np.where(x < 1, 2 / 3 - x**2 + x**3 / 2, (2 - x) ** 3 / 6)
    catmull_rom = np.where(x < 1, 1 - 2.5 * x**2 + 1.5 * x**3, 2 - 4 * x + 2.5 * x**2 - 0.5 * x**3)
    return b_spline / 3 + catmull_rom * 2 / 3


def test_kernels_are_those_of_splines():
    x = np.linspace(-1.99, 1.99, 400)
    narrow = x[np.abs(x) < 1.5]
    np.testing.assert_allclose(kernels.bspline2(narrow), quadratic_b_spline(narrow), atol=1e-15)
    np.testing.assert_allclose(kernels.mitchell(x), mitchell(x), atol=1e-15)


def test_filters_are_named_for_every_kernel():
    names = [f.name for f in prefilter.MIPMAP_FILTERS]
    assert names == ALL
    assert [f.name for f in prefilter.MIPMAP_FILTERS if not f.needs_surface] == [
        *PLAIN,
        "ls-bilinear",
    ]
    assert [f.name for f in prefilter.MIPMAP_FILTERS if f.is_fit] == ["ls-bilinear", *PAM[1:]]


@pytest.mark.parametrize("name", PLAIN)
def test_kernels_are_their_definitions(name):
    """Over all texels, and over covered ones: filter(image * covered) / filter(covered)."""
    offsets = (np.arange(-16, 20) + 0.5 - 2) / 4
    inside = np.abs(offsets) < kernels.RADII[name]
    weights = np.where(inside, 1.0 if name == "box" else kernels.KERNELS[name][0](offsets), 0)
    weights /= weights.sum()

    def filtered(image, row, column):
        rows = (np.arange(-16, 20) + 4 * row) % 16
        columns = (np.arange(-16, 20) + 4 * column) % 16
        return weights @ image[np.ix_(rows, columns)] @ weights

    image = random_image(3, 16, 16, 1)
    flat = image[..., 0].astype(np.float64)
    covered = np.zeros((16, 16))
    covered[1:15, 2:15] = 1  # Every texel of level 2 has some.
    touching = square((2 / 16, 1 / 16), (15 / 16, 15 / 16)).surface
    options = {"wrap": "repeat", "bounds": None, "levels": 3}
    plain = prefilter.mipmaps(image, filter=name, **options)[2]
    masked = prefilter.mipmaps(image, touching, filter=f"{name}-covered", **options)[2]
    for row, column in [(0, 0), (1, 2), (3, 3)]:
        expected = filtered(flat, row, column)
        assert plain[row, column, 0] == pytest.approx(expected, abs=2e-6)
        expected = filtered(flat * covered, row, column) / filtered(covered, row, column)
        assert masked[row, column, 0] == pytest.approx(expected, abs=1e-5)


def test_weights_sum_to_the_surface_area():
    # A texel's weight is its contribution to the last level, which is one mean over the surface.
    mesh = random_soup(4, 6)
    _, weights = surface_samples(mesh, 300)
    assert weights.sum() == pytest.approx(mesh.surface.area)
    total = 0.0
    for row in range(4):
        for column in range(4):
            image = np.zeros((4, 4, 1), np.float32)
            image[row, column] = 1
            total += prefilter.mipmaps(image, mesh.surface, filter="pam-box")[-1].item()
    assert total == pytest.approx(1.0, abs=1e-6)


def test_doubling_a_chart_doubles_its_weight():
    left, right = square((0, 0), (0.5, 1)), square((0.5, 0), (1, 1))
    image = np.zeros((16, 16, 1), np.float32)
    image[:, 8:] = 1
    for meshes, share in [((left, right), 1 / 2), ((left, right, right), 2 / 3)]:
        one_mesh = prefilter.mipmaps(image, join(*meshes).surface, filter="pam-box")
        several = prefilter.mipmaps(image, [m.surface for m in meshes], filter="pam-box")
        assert one_mesh[-1].item() == pytest.approx(share, abs=1e-6)
        assert several[-1].item() == pytest.approx(share, abs=1e-6)


def test_half_the_surface_in_a_sixteenth_of_the_texture():
    """Figure 7.2: two colors share a plane evenly, and the texture unevenly."""
    green, blue = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    image = np.full((64, 64, 3), blue, np.float32)
    image[:16, :16] = green
    mesh = join(
        square((0, 0), (0.25, 0.25), area=1.0),
        square((0.25, 0), (1, 0.25), area=0.2),
        square((0, 0.25), (1, 1), area=0.8),
    )
    box = prefilter.mipmaps(image, mesh.surface, filter="box")
    assert box[-1][0, 0] == pytest.approx((0, 1 / 16, 15 / 16), abs=1e-6)
    for filter in PAM:
        coarsest = prefilter.mipmaps(image, mesh.surface, filter=filter)[-1]
        assert coarsest[0, 0] == pytest.approx((0, 0.5, 0.5), abs=0.01)


def test_mirrored_and_moved_charts_change_nothing():
    mesh = random_soup(5, 6)
    image = random_image(5, 16, 16, 1)
    mirrored = soup(mesh.uvs[:, ::-1], mesh.areas)
    moved = soup(mesh.uvs + np.array([3, -2]), mesh.areas)
    for filter in PAM:
        expected = prefilter.mipmaps(image, mesh.surface, filter=filter, wrap="repeat")
        for other in (mirrored, moved):
            found = prefilter.mipmaps(image, other.surface, filter=filter, wrap="repeat")
            for a, b in zip(expected, found, strict=True):
                assert np.abs(a - b).max() < 1e-4


def test_whole_tiles_weigh_as_much_as_their_parts():
    image = random_image(6, 16, 16, 2)
    many_tiles = square((-2.5, -1.25), (7.5, 4.75))
    one_by_one = soup(np.concatenate([
        square((u / 4, v / 4), ((u + 1) / 4, (v + 1) / 4)).uvs
        for u in range(-10, 30) for v in range(-5, 19)
    ]))  # fmt: skip
    for filter in PAM:
        found = prefilter.mipmaps(image, many_tiles.surface, filter=filter, wrap="repeat")
        expected = prefilter.mipmaps(image, one_by_one.surface, filter=filter, wrap="repeat")
        for a, b in zip(found, expected, strict=True):
            assert np.abs(a - b).max() < 1e-4


@pytest.fixture(scope="module")
def charts():
    """A surface that uses a part of an image of 64 x 64 texels, and the texels that it may use."""
    squares = [square((0.1, 0.15), (0.43, 0.4)), square((0.6, 0.55), (0.8, 0.95), area=0.2)]
    mesh = join(*squares, soup([[(0.2, 0.7), (0.4, 0.9), (0.3, 0.8)]]))
    uvs, _ = surface_samples(mesh, 400)
    used = np.zeros((64, 64), bool)
    taps, shares = bilinear_taps(uvs, 64, 64, CLAMP)
    used.reshape(-1)[taps[shares > 0]] = True
    # Samples may miss a texel that a corner just enters.
    near = used.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            near |= np.roll(near, step, axis)
    return mesh.surface, near


@pytest.mark.parametrize(
    ("filter", "kind", "paint"),
    [
        *itertools.product(
            ["box-covered", *PAM], ["colors", "alpha", "opaque"], [np.nan, np.inf, -1e30, 1e30]
        ),
        # The other kernels weigh texels where "box-covered" does.
        *((filter, "colors", np.nan) for filter in COVERED if filter != "box-covered"),
    ],
)
def test_unused_texels_have_no_influence_at_all(charts, filter, kind, paint):
    surface, near = charts
    image = random_image(7, 64, 64, 3 if kind == "colors" else 4) * np.float32(0.8)
    if kind == "opaque":
        image[..., 3] = 1
    painted = image.copy()
    painted[~near] = paint
    for a, b in zip(
        prefilter.mipmaps(image, surface, filter=filter)[1:],
        prefilter.mipmaps(painted, surface, filter=filter)[1:],
        strict=True,
    ):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("filter", COVERED + PAM)
def test_unused_texels_are_filled_with_colors_of_the_image(filter):
    image = np.zeros((64, 64, 3), np.float32)
    image[...] = (1, 0, 1)
    mesh = square((0.2, 0.2), (0.45, 0.45))
    image[12:30, 12:30] = (0.1, 0.5, 0.2)
    for level in prefilter.mipmaps(image, mesh.surface, filter=filter)[1:]:
        assert np.abs(level - (0.1, 0.5, 0.2)).max() < 1e-5


@pytest.mark.parametrize("filter", ALL)
def test_results_do_not_depend_on_threads(filter):
    mesh = join(random_soup(8, 30, -0.5, 1.5), square(area=0.1))
    image = random_image(8, 128, 256, 3)
    for wrap in ("clamp", "repeat"):
        one = prefilter.mipmaps(image, mesh.surface, filter=filter, wrap=wrap, threads=1)
        for threads in (2, 5):
            many = prefilter.mipmaps(image, mesh.surface, filter=filter, wrap=wrap, threads=threads)
            assert all(np.array_equal(a, b) for a, b in zip(one, many, strict=True))
        errors = [
            prefilter.mipmap_error(one, image, mesh.surface, [1, 2.5, 4], wrap=wrap, threads=n)
            for n in (1, 3)
        ]
        assert np.array_equal(*errors)


@pytest.mark.parametrize("filter", ALL)
def test_bounds_hold(filter):
    image = (random_image(9, 32, 32, 1) > 0.5).astype(np.float32)
    mesh = random_soup(9, 8)
    for bounds in [(0.0, 1.0), (0.25, 0.75), (None, 0.6), (0.4, None)]:
        low = -np.inf if bounds[0] is None else np.float32(bounds[0])
        high = np.inf if bounds[1] is None else np.float32(bounds[1])
        for level in prefilter.mipmaps(image, mesh.surface, filter=filter, bounds=bounds)[1:]:
            assert level.min() >= low
            assert level.max() <= high


def test_least_squares_is_best_over_the_surface():
    mesh = random_soup(10, 40)
    image = random_image(10, 64, 64, 3)
    image = np.clip(box_mean(image, 1).repeat(2, 0).repeat(2, 1) * 3 - 1, 0, 1).astype(np.float32)
    errors = {
        filter: prefilter.mipmap_error(
            prefilter.mipmaps(image, mesh.surface, filter=filter), image, mesh.surface, range(1, 7)
        )
        for filter in ALL
    }
    for filter in ALL[:-1]:
        assert (errors["pam-bilinear"] <= errors[filter] * (1 + 1e-3)).all(), filter


def test_the_error_of_the_image_itself_is_zero():
    image = random_image(11, 32, 32, 4)
    mesh = random_soup(11, 20)
    levels = prefilter.mipmaps(image, mesh.surface, levels=1)
    assert prefilter.mipmap_error(levels, image, mesh.surface, [0.0, -3.0, 9.0]).max() < 1e-7


def test_straight_alpha_weighs_colors():
    image = random_image(12, 16, 16, 4)
    image[..., 3] = image[..., 3] > 0.4
    hidden = image[..., 3] == 0
    painted = image.copy()
    painted[hidden, :3] = (1, 0, 1)
    seen = image[~hidden, :3].min(axis=0), image[~hidden, :3].max(axis=0)
    mesh = join(random_soup(12, 10), square())
    for filter in ALL:
        levels = prefilter.mipmaps(image, mesh.surface, filter=filter)
        others = prefilter.mipmaps(painted, mesh.surface, filter=filter)
        for a, b in zip(levels[1:], others[1:], strict=True):
            assert np.array_equal(a, b)
        associated = image.copy()
        associated[..., :3] *= image[..., 3:]
        expected = prefilter.mipmaps(
            associated, mesh.surface, filter=filter, premultiplied=True, bounds=None
        )
        if filter in ("ls-bilinear", "pam-bilinear", "pam-trilinear"):
            continue  # Its bounds are part of the problem; the constant color below is its test.
        for straight, product in zip(levels[1:], expected[1:], strict=True):
            alpha = product[..., 3:]
            assert np.abs(straight[..., 3:] - np.clip(alpha, 0, 1)).max() < 1e-5
            some = alpha[..., 0] > 0.2
            quotient = np.clip(product[..., :3] / np.maximum(alpha, 1e-6), *seen)
            assert np.abs(straight[..., :3] - quotient)[some].max() < 1e-4


@pytest.mark.parametrize("filter", ALL)
@pytest.mark.parametrize("bounds", [(0.0, 1.0), None, (0.0, None)])
def test_a_constant_color_stays_constant_under_any_alpha(filter, bounds):
    color = np.array((0.9, 0.5, 0.7), np.float32)
    random = np.random.default_rng(13)
    y, x = np.mgrid[:64, :64] / 64 - 0.5
    alphas = [
        random.uniform(0, 1, (64, 64)),
        random.uniform(0, 1, (64, 64)) > 0.5,
        np.hypot(x, y) < 0.35,
        np.sin(40 * x) * np.cos(25 * y) > 0.2,
    ]
    for alpha in alphas:
        image = np.empty((64, 64, 4), np.float32)
        image[..., :3] = color
        image[..., 3] = alpha
        for level in prefilter.mipmaps(image, square().surface, filter=filter, bounds=bounds)[1:]:
            seen = level[..., 3] > 0
            assert np.abs(level[..., :3] - color)[seen].max() < 1e-4


def test_alpha_of_one_everywhere_is_no_alpha():
    image = random_image(14, 32, 32, 4)
    image[..., 3] = 1
    mesh = random_soup(14, 8)
    for filter in ALL:
        with_alpha = prefilter.mipmaps(image, mesh.surface, filter=filter)
        without = prefilter.mipmaps(image[..., :3], mesh.surface, filter=filter)
        for a, b in zip(with_alpha, without, strict=True):
            assert np.abs(a[..., :3] - b).max() < 1e-5


@pytest.mark.parametrize("brightness", [6e4, 1e6])
def test_a_bright_spot_on_another_chart_changes_nothing(brightness):
    mesh = join(square((0.05, 0.05), (0.42, 0.95)), square((0.58, 0.05), (0.95, 0.95)))
    dark = random_image(15, 64, 64, 1)
    bright = dark.copy()
    bright[30:33, 50:53] = brightness
    for k in (1, 2, 3):
        a, b = (
            prefilter.mipmaps(image, mesh.surface, bounds=(0.0, None))[k]
            for image in (dark, bright)
        )
        left = a.shape[1] * 3 // 8
        assert np.abs(a[:, :left] - b[:, :left]).max() < 2e-3, f"level {k}"


def test_degenerate_triangles_weigh_by_their_area_in_space():
    """Section 7.2: triangles whose image is a line or a point still count."""
    image = np.zeros((8, 8, 1), np.float32)
    image[:, 4:] = 1
    flat = soup([[(0.75, 0.1), (0.75, 0.9), (0.75, 0.4)]], np.array([3.0]))
    point = soup([[(0.7, 0.3)] * 3], np.array([2.0]))
    for other in (flat, point, join(flat, point)):
        mesh = join(square((0.05, 0.05), (0.45, 0.95), area=1.0), other)
        coarsest = prefilter.mipmaps(image, mesh.surface, filter="pam-box")[-1].item()
        heavy = other.areas.sum()
        assert coarsest == pytest.approx(heavy / (1 + heavy), abs=1e-6)
    corners = soup([[(1.0, 1.0)] * 3, [(0.0, 0.0)] * 3])
    for wrap in ("clamp", "border", "repeat"):
        assert np.isfinite(prefilter.mipmaps(image, corners.surface, wrap=wrap)[-1]).all()
    no_area = soup([[(0.1, 0.6), (0.9, 0.7), (0.5, 0.8)]], np.array([0.0]))
    mesh = join(square((0.05, 0.05), (0.45, 0.45)), no_area)
    expected = prefilter.mipmaps(image, square((0.05, 0.05), (0.45, 0.45)).surface)
    for a, b in zip(prefilter.mipmaps(image, mesh.surface), expected, strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("channels", [3, 4])
def test_coarser_levels_are_light(encoding, kind, channels):
    stored = np.random.default_rng(3).integers(0, np.iinfo(kind).max, (24, 40, channels), kind)
    values = (stored / np.iinfo(kind).max).astype(np.float32)
    light = prefilter.to_linear(values) if encoding == "srgb" else values
    expected = prefilter.mipmaps(light, filter="ls-bilinear")[1:]
    found = prefilter.coarser_levels(stored, filter="ls-bilinear", encoding=encoding)
    assert found.filter == "ls-bilinear"
    assert len(found) == len(expected)
    for level, other in zip(found, expected, strict=True):
        assert level.dtype == np.float32
        np.testing.assert_allclose(level, other, atol=1e-6)
    for level, other in zip(
        prefilter.coarser_levels(light, filter="ls-bilinear"), expected, strict=True
    ):
        np.testing.assert_array_equal(level, other)
