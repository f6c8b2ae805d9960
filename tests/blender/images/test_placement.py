# SPDX-License-Identifier: GPL-3.0-or-later

"""The placement of an image in its result."""

import math

import numpy as np
import pytest
from prefilter.workflows.images import placement as placing

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


@pytest.fixture
def place(addon):
    """Returns a function that places an image of 60 x 40 pixels with the settings given."""
    settings = addon("images.choices").ResampleSettings

    def run(**options):
        return placing.placement(settings(**options), 60, 40)

    return run


@pytest.fixture
def applied(addon):
    """Returns the function that applies a transform to points."""
    return placing.applied


def dlt(source, target):
    """Returns the transform of four points to four others: the null vector of the eight equations
    that they give for its nine entries."""
    rows = []
    for (x, y), (u, v) in zip(source, target, strict=True):
        rows += [
            [x, y, 1, 0, 0, 0, -u * x, -u * y, -u],
            [0, 0, 0, x, y, 1, -v * x, -v * y, -v],
        ]
    return np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)


@pytest.mark.parametrize("mirrored", [False, True])
def test_homography_is_the_only_one(addon, mirrored):
    random = np.random.default_rng(7)
    for _ in range(20):
        source = 100 * SQUARE + random.uniform(-20, 20, (4, 2))
        target = 3 * SQUARE + random.uniform(-0.6, 0.6, (4, 2))
        if mirrored:
            target[:, 0] *= -1
        found = placing.homography(source, target)
        expected = dlt(source, target)
        np.testing.assert_allclose(
            found / np.linalg.norm(found),
            expected * np.sign(expected[2] @ [50, 50, 1]) / np.linalg.norm(expected),
            atol=1e-11,
        )


@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (0, 0), (1, 1), (0, 1)],
        [(0, 0), (1, 0), (2, 0), (0, 1)],
        [(0, 0), (1, 1), (1, 0), (0, 1)],
        [(0, 0), (1, 0), (0.2, 0.2), (0, 1)],
        [(0, 0)] * 4,
        [(0, 0), (1, 0), (1, math.nan), (0, 1)],
        [(0, 0), (1, 0), (2, 1e-12), (3, 0)],
    ],
)
def test_corners_that_fold_are_refused(addon, corners):
    names = addon("images.choices").CORNERS
    settings = addon("images.choices").ResampleSettings
    for warp in ("corners", "rectify"):
        chosen = settings(warp=warp, **dict(zip(names, corners, strict=True)))
        with pytest.raises(ValueError, match=r"^Corners: found .*convex quadrilateral"):
            placing.placement(chosen, 60, 40)


def test_nothing_is_moved_by_default(place):
    for warp in ("affine", "corners", "rectify"):
        for size in ("fit", "image"):
            found = place(warp=warp, size=size)
            assert (found.width, found.height) == (60, 40)
            np.testing.assert_allclose(found.transform, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("quarters", [-4, -1, 1, 2, 3])
def test_quarter_turns_are_exact(place, quarters):
    # Blender stores angles in radians.
    found = place(rotation=float(np.float32(quarters * math.pi / 2)))
    assert (found.width, found.height) == ((60, 40) if quarters % 2 == 0 else (40, 60))
    assert set(np.abs(found.transform[:2, :2]).ravel()) == {0.0, 1.0}


def test_scale_then_turn_about_the_center(place, applied):
    options = {"scale_x": 2.0, "scale_y": -0.5, "rotation": math.radians(30)}
    found = place(**options, size="pixels", width=300, height=200, offset_x=7.0, offset_y=-3.0)
    cosine, sine = math.sqrt(3) / 2, 0.5
    x, y = 2.0 * 11, -0.5 * 5
    there = (150 + 7 + cosine * x - sine * y, 100 - 3 + sine * x + cosine * y)
    np.testing.assert_allclose(applied(found.transform, [there]), [(30 + 11, 20 + 5)], atol=1e-12)
    fitted = place(**options)
    extents = (120 * cosine + 20 * sine, 120 * sine + 20 * cosine)
    assert (fitted.width, fitted.height) == tuple(math.ceil(extent) for extent in extents)
    np.testing.assert_allclose(
        applied(fitted.transform, [(fitted.width / 2, fitted.height / 2)]), [(30, 20)], atol=1e-12
    )


def test_corners_are_shares_or_pixels(place, applied):
    corners = {
        "lower_left": (0.1, 0.0),
        "lower_right": (0.9, 0.2),
        "upper_right": (1.0, 1.0),
        "upper_left": (0.0, 0.7),
    }
    shares = np.array(list(corners.values()))
    image = 1.0 * np.array([(0, 0), (60, 0), (60, 40), (0, 40)])
    for size, unit in (("pixels", (200, 100)), ("image", (60, 40)), ("fit", (60, 40))):
        found = place(warp="corners", size=size, width=200, height=100, **corners)
        assert (found.width, found.height) == unit
        np.testing.assert_allclose(applied(found.transform, shares * unit), image, atol=1e-9)
    pixels = {name: (500 + 100 * x, 30 * y) for name, (x, y) in corners.items()}
    found = place(warp="corners", use_pixels=True, **pixels)
    assert (found.width, found.height) == (100, 30)
    np.testing.assert_allclose(applied(found.transform, shares * (100, 30)), image, atol=1e-9)


def test_rectified_places_fill_the_result(place, applied):
    corners = {
        "lower_left": (0.25, 0.25),
        "lower_right": (0.75, 0.0),
        "upper_right": (0.75, 1.0),
        "upper_left": (0.25, 0.75),
    }
    places = np.array(list(corners.values())) * (60, 40)
    found = place(warp="rectify", proportions="sides", **corners)
    # The longest of the sides that face each other.
    assert (found.width, found.height) == (math.ceil(math.hypot(30, 10)), 40)
    for size, width, height in (("fit", 32, 40), ("image", 60, 40), ("pixels", 9, 5)):
        options = {"size": size, "width": 9, "height": 5, "proportions": "sides"}
        found = place(warp="rectify", **options, **corners)
        ends = SQUARE * (width, height)
        np.testing.assert_allclose(applied(found.transform, ends), places, atol=1e-9)


def test_points_beyond_the_horizon_have_a_negative_w(place):
    """The sides of the image meet at (0.5, 2): rows above that are behind the viewer."""
    found = place(
        warp="corners",
        size="pixels",
        width=100,
        height=300,
        use_pixels=True,
        lower_right=(100.0, 0.0),
        upper_right=(75.0, 100.0),
        upper_left=(25.0, 100.0),
    )
    factors = [(found.transform @ (50.0, y, 1.0))[2] for y in (0.0, 99.0, 199.0, 201.0, 300.0)]
    assert [factor > 0 for factor in factors] == [True, True, True, False, False]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scale_x": 0.0}, "Scale X: found 0"),
        ({"scale_y": 0.0}, "Scale Y: found 0"),
        ({"scale_x": 1000.0, "scale_y": 1e5}, "4000000 pixels long; allowed: 1048576"),
        (
            {"warp": "corners", "lower_right": (1e6, 0.0), "upper_right": (1e6, 1.0)},
            "60000000 pixels long; allowed: 1048576",
        ),
    ],
)
def test_wrong_settings(place, options, message):
    with pytest.raises(ValueError, match=message):
        place(**options)


def test_a_result_has_a_pixel_at_least(place):
    found = place(scale_x=0.001, scale_y=0.001)
    assert (found.width, found.height) == (1, 1)


def test_squeeze(addon, place):
    squeeze = placing.mean_footprint
    assert squeeze(place(), 60, 40) == pytest.approx(1)
    assert squeeze(place(scale_x=3.0), 60, 40) == pytest.approx(1)
    assert squeeze(place(scale_x=0.5, scale_y=0.25), 60, 40) == pytest.approx(16)
    half = place(scale_x=0.5, size="image")
    assert squeeze(half, 60, 40) == pytest.approx(4 / 2)
    pinned = place(warp="corners", upper_left=(0.4, 1.0), upper_right=(0.6, 1.0))
    assert 2 < squeeze(pinned, 60, 40) < 5
    # At most all of the image for a pixel.
    tiny = place(scale_x=0.001, scale_y=0.001)
    assert squeeze(tiny, 60, 40) <= 60**2
