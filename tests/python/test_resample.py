# SPDX-License-Identifier: GPL-3.0-or-later

"""Images under affine and projective maps, against positions and Jacobians by numpy."""

import numpy as np
import prefilter
import pytest
from scenes import random_image

INTERPOLATING = ("box", "tent", "lanczos2", "lanczos3")
GAUSSIAN = prefilter.SamplingTable.standard("gaussian")
PERSPECTIVE = np.array([(2.0, 0.3, -5.0), (0.1, 1.5, -8.0), (0.002, 0.05, -0.2)])


def places_by_numpy(transform, width, height, image):
    """Coordinates and Jacobians of all pixels, and which of them are in front of the horizon."""
    y, x = np.mgrid[:height, :width] + 0.5

    def carried(x, y):
        xw, yw, w = np.einsum("kl,lji->kji", transform, np.stack([x, y, np.ones_like(x)]))
        return np.stack([xw, yw]) / w, w

    with np.errstate(divide="ignore", invalid="ignore"):
        place, w = carried(x, y)
        # Central differences of a complex step are exact to rounding.
        step = 1e-30j
        along_i = carried(x + step, y.astype(complex))[0].imag / 1e-30
        along_j = carried(x.astype(complex), y + step)[0].imag / 1e-30
    size = (image.shape[1], image.shape[0])
    jacobians = np.stack([along_i, along_j], axis=-1)  # [x or y, row, column, i or j]
    coordinates = place.transpose(1, 2, 0) / size
    return (
        coordinates.reshape(-1, 2),
        jacobians.transpose(1, 2, 0, 3).reshape(-1, 2, 2),
        (w > 0).ravel(),
    )


def expected_pixels(image, transform, width, height, sampled):
    coordinates, jacobians, visible = places_by_numpy(transform, width, height, image)
    expected = np.zeros((height * width, image.shape[2]), np.float32)
    expected[visible] = sampled(coordinates[visible], jacobians[visible])
    return expected.reshape(height, width, -1)


def larger(jacobians):
    return np.linalg.svd(jacobians, compute_uv=False)[:, 0]


@pytest.mark.parametrize("wrap", ["clamp", "repeat", ("border", "repeat")])
@pytest.mark.parametrize(
    "transform",
    [
        PERSPECTIVE,
        -2.5 * np.array([(-1, -0.2, -3), (0.4, -1.7, 50), (0, 0, -1)]),
        np.array([(0.3, 0, 1), (0.1, 0.2, 2), (0, 0, 1)]),
        np.array([(1, 0, 0), (0, 1, 0), (0, 1, -3.5)]),
    ],
)
def test_each_pixel_is_the_sample_at_its_place(transform, wrap):
    image = random_image(0, 24, 32, 3)
    levels = prefilter.sampling_levels(image, wrap=wrap)
    table = prefilter.SamplingTable.standard()
    gaussian_levels = prefilter.sampling_levels(image, "gaussian", wrap=wrap)
    ways = {
        "table": ({}, lambda p, j: prefilter.sample(levels, table, p, larger(j), wrap=wrap)),
        "trilinear": (
            {"table": "trilinear"},
            lambda p, j: prefilter.sample(levels, "trilinear", p, larger(j), wrap=wrap),
        ),
        "exact": (
            {"exact": True, "filter": "mitchell"},
            lambda p, j: prefilter.sample_exact(image, p, larger(j), filter="mitchell", wrap=wrap),
        ),
        "probes": (
            {"table": GAUSSIAN, "max_probes": 5},
            lambda p, j: prefilter.sample_anisotropic(
                gaussian_levels, GAUSSIAN, p, j, max_probes=5, wrap=wrap
            ),
        ),
        "ellipses": (
            {"filter": "gaussian", "max_probes": 2, "exact": True},
            lambda p, j: prefilter.sample_ewa(image, p, j, wrap=wrap),
        ),
    }
    for name, (options, sampled) in ways.items():
        found = prefilter.resample(image, transform, 20, 28, wrap=wrap, **options)
        expected = expected_pixels(image, transform, 20, 28, sampled)
        assert found.dtype == np.float32
        assert found.any()
        # Rounding moves a sample across the border of a subdomain here and there: see
        # SamplingTable for how far its weights jump there.
        off = np.abs(found - expected).max(axis=2)
        assert np.quantile(off, 0.99) < 2e-6, name
        assert off.max() < (0.1 if name in ("table", "probes") else 2e-5), name


def test_what_is_beyond_the_horizon_is_zero():
    image = np.ones((8, 8, 3), np.float32)
    rows = prefilter.resample(image, [(1, 0, 0), (0, 1, 0), (0, 1, -3)], 4, 6)
    assert not rows[:3].any()  # w = -2.5, -1.5, -0.5
    np.testing.assert_allclose(rows[3:], 1, rtol=0, atol=1e-6)
    for transform in (np.zeros((3, 3)), -np.eye(3), np.diag((1, 1, 1e-320)), np.diag((0, 0, -1))):
        assert not prefilter.resample(image, transform, 3, 3).any()


@pytest.mark.parametrize("filter", INTERPOLATING)
def test_the_identity_and_whole_shifts_keep_pixels(filter):
    image = random_image(1, 9, 14, 4)
    for wrap in ("clamp", "repeat", "border"):
        options = {"filter": filter, "wrap": wrap, "premultiplied": True, "exact": True}
        same = prefilter.resample(image, np.eye(3), 14, 9, **options)
        np.testing.assert_allclose(same, image, rtol=0, atol=2e-7)
        shifted = prefilter.resample(image, [(1, 0, -3), (0, 1, 2)], 20, 9, **options)
        y, x = np.mgrid[:9, :20]
        inside = (x >= 3) & (x < 17) & (y < 7)
        x, y = x - 3, y + 2
        if wrap == "clamp":
            x, y = np.clip(x, 0, 13), np.clip(y, 0, 8)
        expected = image[y % 9, x % 14]
        if wrap == "border":
            expected = expected * inside[..., None]
        np.testing.assert_allclose(shifted, expected, rtol=0, atol=2e-7)


@pytest.mark.parametrize("options", [{}, {"table": "trilinear"}, {"exact": True}])
def test_quarter_turns_turn_the_result(options):
    image = random_image(2, 16, 16, 3)
    scale = 2.7
    # Off the diagonal, on both sides of which a table has the same sets, mirrored.
    straight = prefilter.resample(image, [(scale, 0, 0.4), (0, scale, 0.9)], 6, 6, **options)
    turn = [(0, -scale, 6 * scale + 0.4), (scale, 0, 0.9)]
    turned = prefilter.resample(image, turn, 6, 6, **options)
    np.testing.assert_allclose(turned, np.rot90(straight), rtol=0, atol=1e-5)


@pytest.mark.parametrize("scale", [1.0, 2.0, 4.0])
def test_rounding_does_not_choose_the_texels_of_rotations(scale):
    image = random_image(9, 32, 32, 3)
    angle = 0.4
    turn = scale * np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])
    transform = np.column_stack([turn, (3, 1)])
    found = prefilter.resample(image, transform, 16, 16, wrap="repeat")
    whole = np.vstack([transform, (0, 0, 1)])
    coordinates, _, _ = places_by_numpy(whole, 16, 16, image)
    levels = prefilter.sampling_levels(image, wrap="repeat")
    table = prefilter.SamplingTable.standard()
    expected = prefilter.sample(levels, table, coordinates, scale, wrap="repeat")
    np.testing.assert_allclose(found.reshape(-1, 3), expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize("filter", prefilter.SAMPLING_FILTERS)
def test_shrinking_by_whole_numbers_is_resizing(filter):
    for channels in (1, 2, 3, 4):
        image = random_image(3 + channels, 12, 20, channels)
        for wrap in ("clamp", "repeat"):
            found = prefilter.resample(
                image, np.diag((4.0, 4.0, 1.0)), 5, 3, filter=filter, exact=True, wrap=wrap
            )
            expected = prefilter.resize(image, 5, 3, filter=filter, wrap=wrap)
            np.testing.assert_allclose(found, expected, rtol=0, atol=3e-6)


@pytest.mark.parametrize("channels", [2, 4])
def test_colors_are_weighted_by_alpha(channels):
    image = random_image(8, 16, 16, channels)
    image[:, 8:, -1] = 0
    image[:, 8:, 0] = 50.0  # of what cannot be seen
    multiplied = image.copy()
    multiplied[..., :-1] *= image[..., -1:]
    turn = [(1.5, 0.4, -2), (-0.4, 1.5, 1)]
    found = prefilter.resample(image, turn, 10, 10)
    sums = prefilter.resample(multiplied, turn, 10, 10, premultiplied=True)
    seen = sums[..., -1] > 0.01
    shown = np.clip(sums[seen][:, :-1] / sums[seen][:, -1:], 0, image[:, :8].max())
    low, high = image[:, :8, :-1].min(axis=(0, 1)), image[:, :8, :-1].max(axis=(0, 1))
    np.testing.assert_allclose(found[seen][:, :-1], np.clip(shown, low, high), atol=1e-4)
    np.testing.assert_allclose(found[..., -1], np.clip(sums[..., -1], 0, 1), atol=1e-6)
    assert found.max() <= 1


@pytest.mark.parametrize("options", [{}, {"exact": True}, {"filter": "gaussian", "max_probes": 4}])
def test_an_opaque_image_keeps_its_color_up_to_a_transparent_border(options):
    color = np.array((0.25, 0.5, 0.75, 1.0), np.float32)
    image = np.tile(color, (12, 12, 1))
    turned = prefilter.resample(
        image, [(1, 0.5, -8), (-0.5, 1, 0)], 24, 24, wrap="border", **options
    )
    alpha = turned[..., 3]
    assert alpha[0, 0] == alpha[-1, -1] == 0
    np.testing.assert_allclose(alpha.max(), 1, atol=1e-6)
    assert ((alpha > 0.2) & (alpha < 0.8)).any()
    np.testing.assert_allclose(
        turned[alpha > 0.01][:, :3], np.tile(color[:3], ((alpha > 0.01).sum(), 1)), atol=1e-5
    )


def test_any_number_of_channels_bytes_and_affine_maps():
    image = random_image(10, 16, 16, 7)
    affine = [(1.5, 0.4, -2), (-0.4, 1.5, 1)]
    together = prefilter.resample(image, affine, 9, 9)
    for c in range(7):
        alone = prefilter.resample(image[..., c : c + 1], [*affine, (0, 0, 1)], 9, 9)
        np.testing.assert_array_equal(together[..., c : c + 1], alone)
    bytes_ = np.random.default_rng(11).integers(0, 256, (16, 16, 3), np.uint8)
    np.testing.assert_array_equal(
        prefilter.resample(bytes_, affine, 9, 9),
        prefilter.resample(bytes_ / np.float32(255), affine, 9, 9),
    )


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"exact": True},
        {"filter": "gaussian", "max_probes": 4},
        {"filter": "gaussian", "max_probes": 4, "exact": True},
    ],
)
def test_threads_progress_and_canceling(options):
    image = random_image(12, 32, 32, 4)
    one, four = (
        prefilter.resample(image, PERSPECTIVE, 90, 80, threads=n, **options) for n in (1, 4)
    )
    np.testing.assert_array_equal(one, four)
    told = []
    prefilter.resample(image, PERSPECTIVE, 90, 80, progress=told.append, **options)
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(prefilter.Cancelled):
        prefilter.resample(image, PERSPECTIVE, 90, 80, progress=lambda _: False, **options)


@pytest.mark.parametrize("wrap", ["clamp", "repeat", "border"])
@pytest.mark.parametrize(
    "options",
    [{}, {"exact": True}, {"filter": "gaussian", "max_probes": 3}, {"table": "trilinear"}],
)
def test_nasty_transforms_give_finite_pixels(options, wrap):
    image = random_image(13, 5, 3, 4)
    for transform in (
        np.full((3, 3), 1e-300),
        np.full((3, 3), 1e300),
        np.diag((1e200, 1e-200, 1)),
        np.array([(0, 0, 1e-300), (0, 0, 1), (0, 0, 1)]),
        np.array([(1, 1, 0), (1, 1, 0), (1e-9, 1e-9, -1e-8)]),
        np.array([(1e308, 0, 0), (0, 1e308, 0), (0, 0, 1e-308)]),
    ):
        assert np.isfinite(prefilter.resample(image, transform, 4, 4, wrap=wrap, **options)).all()
    tiny = prefilter.resample(image[:1, :1], PERSPECTIVE, 1, 1, wrap=wrap, **options)
    assert tiny.shape == (1, 1, 4)
