# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels drawn over a model in the 3D view, in a window that nobody sees."""

from pathlib import Path

import numpy as np
import pytest
import scenes

SESSION = Path(__file__).with_name("model_view_session.py")
BYTE = 6.0
"""Rounding of software rendering, in byte values."""


@pytest.fixture
def expected(found):
    """Returns the colors of the coarsest levels, by Box and by the filter of the bake."""
    levels = found["levels"]
    assert list(levels) == ["pam-bilinear", "box"]
    return [255 * scenes.to_srgb(np.array(levels[name])) for name in ("box", "pam-bilinear")]


@pytest.mark.parametrize(
    "which",
    ["coarsest", "far", "MATERIAL True", "MATERIAL False", "SOLID True", "SOLID False"],
)
def test_each_side_shows_its_filter(found, expected, which):
    np.testing.assert_allclose(found[which], expected, atol=BYTE)


def test_the_filters_differ(expected):
    """Half of the image is black, and no surface shows it."""
    assert np.all(expected[1] - expected[0] > 25)


def test_near_is_the_image(found, expected):
    assert np.abs(np.array(found["near"]) - expected).max() > 20


def test_the_model_is_as_it_was(found):
    np.testing.assert_allclose(found["switched off"], found["plain"], atol=1)
    np.testing.assert_allclose(found["ended"], found["plain"], atol=1)
    assert found["data is the same"]
    assert not found["kept"]


def test_hidden_objects_show_no_levels(found):
    assert np.abs(np.array(found["hidden"]) - found["coarsest"]).min() > 20


def test_the_line_is_dragged(found):
    assert found["dragged by"] == pytest.approx(80, abs=1.5)


def test_an_undo_leaves_it(found, expected):
    np.testing.assert_allclose(found["after undo"], expected, atol=BYTE)
