"""The canvas and its letters."""

import bpy
import numpy as np
import pytest
import scenes

WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


@pytest.fixture
def canvas(addon):
    """Returns a function that makes a white canvas."""
    return lambda width, height: addon("mipmaps.view.canvas").Canvas(width, height, WHITE)


def ink(made):
    """Returns how much of each pixel is covered with black."""
    return 1 - scenes.to_linear(made.pixels()[..., 0])


def test_rectangle_covers_its_area(canvas):
    made = canvas(8, 6)
    made.rectangle((1.25, 2.0), (4.5, 3.5), BLACK)
    expected = np.outer([0, 0, 1, 0.5, 0, 0], [0, 0.75, 1, 1, 0.5, 0, 0, 0])
    np.testing.assert_allclose(ink(made), expected, atol=1e-5)


def test_triangle_covers_its_area(canvas):
    """Against 64 x 64 points in each pixel."""
    corners = np.array([[(1.3, 0.7), (9.2, 3.1), (4.4, 10.6)], [(10, 10), (11.5, 10), (10, 11.5)]])
    made = canvas(12, 12)
    made.triangles(corners, BLACK)
    place = (np.arange(12 * 64) + 0.5) / 64
    x, y = np.meshgrid(place, place)
    inside = np.zeros(x.shape, bool)
    for a, b, c in corners:
        sides = [
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) >= 0
            for p, q in ((a, b), (b, c), (c, a))
        ]
        inside |= np.all(sides, axis=0)
    expected = inside.reshape(12, 64, 12, 64).mean(axis=(1, 3))
    np.testing.assert_allclose(ink(made), expected, atol=0.01)


def test_line_has_its_width_and_dashes_their_share(canvas):
    made = canvas(60, 40)
    made.line([(10, 20), (50, 20)], BLACK, width=3.0)
    assert ink(made)[:, 30].sum() == pytest.approx(3.0, abs=1e-4)
    assert ink(made)[20, 15:45].min() == pytest.approx(1.0, abs=1e-5)
    whole = ink(made).sum()
    dashed = canvas(60, 40)
    dashed.line([(10, 20), (50, 20)], BLACK, width=3.0, dashes=5.0)
    assert 0.5 * whole < ink(dashed).sum() < 0.75 * whole
    assert ink(dashed)[20, 17] < 0.1
    assert ink(dashed)[20, 12] > 0.9


def test_what_is_off_the_sheet_is_left_out(canvas):
    made = canvas(8, 8)
    made.line([(-50, -50), (-20, -30)], BLACK, width=2.0)
    made.rectangle((20, 20), (30, 30), BLACK)
    made.triangles(np.array([[(-9.0, -9.0), (-5.0, -9.0), (-9.0, -5.0)]]), BLACK)
    made.triangles(np.zeros((0, 3, 2)), BLACK)
    made.line([(3.5, 3.5), (3.5, 3.5)], BLACK, width=2.0)
    assert ink(made)[:2].max() == 0
    assert ink(made)[3, 3] > 0.9


def test_blends_in_light(canvas):
    made = canvas(1, 1)
    made.rectangle((0, 0), (0.5, 1), BLACK)
    assert made.pixels()[0, 0, 0] == pytest.approx(scenes.to_srgb(np.float32(0.5)), abs=1e-3)


def test_letters(addon):
    lettering = addon("bridge.lettering")
    before = (len(bpy.data.curves), len(bpy.data.objects), len(bpy.data.meshes))
    corners = lettering.triangles("HI")
    assert corners.shape[1:] == (3, 2)
    assert corners[..., 1].min() == pytest.approx(0.0, abs=0.02)
    assert 0.5 < corners[..., 1].max() < 0.9
    assert len(lettering.triangles("")) == len(lettering.triangles(" ")) == 0
    wide = lettering.triangles("HIHI")[..., 0].max()
    assert wide > 1.8 * corners[..., 0].max()
    assert (len(bpy.data.curves), len(bpy.data.objects), len(bpy.data.meshes)) == before


def test_letters_have_the_area_of_their_outlines(addon, canvas):
    corners = addon("bridge.lettering").triangles("Mip 4") * 40 + np.array([5.0, 20.0])
    made = canvas(160, 80)
    made.triangles(corners, BLACK)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2
    assert ink(made).sum() == pytest.approx(area, rel=1e-3)
    assert ink(made).max() <= 1 + 1e-4
