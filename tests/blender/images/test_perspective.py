# SPDX-License-Identifier: GPL-3.0-or-later

"""The proportions of rectangles that a known camera saw."""

import math

import numpy as np
import pytest
from prefilter.workflows.images import perspective as perspectives
from prefilter.workflows.images import placement as placing

WIDTH, HEIGHT = 1500, 1100
DIAGONAL = math.hypot(WIDTH, HEIGHT)


@pytest.fixture
def proportions(addon):
    return perspectives.proportions


def seen(aspect, *, focal, yaw=0.0, pitch=0.0, roll=0.0, aside=(0.0, 0.0), far=3.0):
    """Returns the corners, in pixels, of a rectangle 1 high that a camera looks at.

    Args:
        aspect: Its width.
        focal: The focal length of the camera, in diagonals of its image.
        yaw: How the camera is turned, in degrees, first about the vertical axis.
        pitch: Then upwards.
        roll: Then about its line of sight.
        aside: Where the middle of the rectangle is from the line of sight.
        far: How far away it is.
    """
    a, b, c = np.radians([yaw, pitch, roll])
    about_y = [[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]]
    about_x = [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]
    about_z = [[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]]
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * (aspect / 2, 0.5, 0)
    space = corners @ (np.array(about_z) @ about_x @ about_y).T + (*aside, far)
    assert np.all(space[:, 2] > 0)
    return focal * DIAGONAL * space[:, :2] / space[:, 2:] + (WIDTH / 2, HEIGHT / 2)


@pytest.mark.parametrize("aspect", [4 / 3, 1.0, 0.4])
@pytest.mark.parametrize("focal", [0.5, 0.7, 2.0])
@pytest.mark.parametrize(
    "pose",
    [
        {"yaw": 35, "pitch": 12},
        {"yaw": -50, "pitch": -8, "roll": 3},
        {"yaw": 20, "pitch": 30, "roll": -40, "aside": (0.4, 0.3)},
        {"yaw": 5, "pitch": 4, "far": 1.5},
        {"yaw": 60, "pitch": 10, "aside": (-0.5, 0.2), "far": 6.0},
    ],
)
def test_a_rectangle_seen_at_an_angle(proportions, aspect, focal, pose):
    found = proportions(seen(aspect, focal=focal, **pose), WIDTH, HEIGHT)
    assert found.is_certain
    assert found.aspect == pytest.approx(aspect, rel=1e-6)


def test_either_way_around(proportions):
    corners = seen(4 / 3, focal=0.7, yaw=35, pitch=12)
    mirrored = corners[[1, 0, 3, 2]]
    turned = np.roll(corners, 1, axis=0)
    assert proportions(mirrored, WIDTH, HEIGHT).aspect == pytest.approx(4 / 3, rel=1e-6)
    assert proportions(turned, WIDTH, HEIGHT).aspect == pytest.approx(3 / 4, rel=1e-6)


@pytest.mark.parametrize("roll", [0, 25])
def test_from_the_front_any_lens_will_do(proportions, roll):
    for focal in (0.4, 3.0):
        corners = seen(4 / 3, focal=focal, roll=roll, aside=(0.7, -0.2))
        found = proportions(corners, WIDTH, HEIGHT)
        assert found.is_certain
        assert found.aspect == pytest.approx(4 / 3, rel=1e-6)


@pytest.mark.parametrize("pose", [{"yaw": 35}, {"pitch": 40}, {"yaw": 35, "aside": (0.3, 0.5)}])
def test_a_level_camera_leaves_the_lens_open(proportions, pose):
    """One vanishing point is at infinity: the proportions fit a usual lens."""
    usual = proportions(seen(4 / 3, focal=0.65, **pose), WIDTH, HEIGHT)
    assert not usual.is_certain
    assert usual.aspect == pytest.approx(4 / 3, rel=1e-6)
    other = proportions(seen(4 / 3, focal=0.8, **pose), WIDTH, HEIGHT)
    assert not other.is_certain
    assert other.aspect == pytest.approx(4 / 3, rel=0.15)


def test_proportions_without_a_lens_are_a_guess(proportions):
    # Both vanishing points on one side of the image: the sides are nowhere at right angles.
    corners = np.array([(200, 200), (900, 250), (820, 800), (150, 900)])
    found = proportions(corners, WIDTH, HEIGHT)
    assert math.isfinite(found.aspect)
    assert found.aspect > 0


def test_a_pixel_more_or_less_changes_little(proportions):
    random = np.random.default_rng(3)
    corners = seen(4 / 3, focal=0.65, yaw=35, pitch=10, far=1.6)
    for _ in range(50):
        found = proportions(corners + random.uniform(-0.5, 0.5, (4, 2)), WIDTH, HEIGHT)
        assert found.aspect == pytest.approx(4 / 3, rel=0.02)


def test_the_result_has_these_proportions(addon):
    """And no side has fewer pixels than in the image."""
    choices, placement = (
        addon("images.choices"),
        placing,
    )
    corners = seen(4 / 3, focal=0.65, yaw=35, pitch=10, far=1.6)
    named = dict(zip(choices.CORNERS, map(tuple, corners), strict=True))
    options = {"warp": "rectify", "use_pixels": True, **named}

    def size(**more):
        placed = placement.placement(choices.ResampleSettings(**options, **more), WIDTH, HEIGHT)
        return placed.width, placed.height

    sides = size(proportions="sides")
    for found, aspect in ((size(), 4 / 3), (size(proportions="given", aspect=2.5), 2.5)):
        assert found[0] == pytest.approx(aspect * found[1], abs=2)
        assert all(one >= least for one, least in zip(found, sides, strict=True))
        assert any(abs(one - least) <= 1 for one, least in zip(found, sides, strict=True))
    assert sides[0] / sides[1] != pytest.approx(4 / 3, rel=0.02)
    settings = choices.ResampleSettings(**options)
    assert placement.knows_proportions(settings, WIDTH, HEIGHT)
    level = dict(zip(choices.CORNERS, seen(4 / 3, focal=0.65, yaw=35), strict=True))
    settings = choices.ResampleSettings(warp="rectify", use_pixels=True, **level)
    assert not placement.knows_proportions(settings, WIDTH, HEIGHT)
