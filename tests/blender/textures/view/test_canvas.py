# SPDX-License-Identifier: GPL-3.0-or-later

"""The canvas and its letters."""

import bpy
import numpy as np
import outlines
import pytest
import scenes

WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


@pytest.fixture
def canvas(addon):
    """Returns a function that makes a white canvas."""
    return lambda width, height: addon("textures.view.canvas").Canvas(width, height, WHITE)


def ink(made):
    """Returns how much of each pixel is covered with black."""
    return 1 - scenes.to_linear(made.pixels()[..., 0])


def test_rectangle_covers_its_area(canvas):
    made = canvas(8, 6)
    made.rectangle((1.25, 2.0), (4.5, 3.5), BLACK)
    expected = np.outer([0, 0, 1, 0.5, 0, 0], [0, 0.75, 1, 1, 0.5, 0, 0, 0])
    np.testing.assert_allclose(ink(made), expected, atol=1e-5)


def test_line_has_its_width_and_dashes_their_share(canvas):
    made = canvas(60, 40)
    made.line([(10, 20), (50, 20)], BLACK, width=3.0)
    assert ink(made)[:, 30].sum() == pytest.approx(3.0, abs=1e-4)
    assert ink(made)[20, 15:45].min() == pytest.approx(1.0, abs=1e-5)
    assert ink(made).sum() == pytest.approx(40 * 3 + np.pi * 1.5**2, rel=1e-4)
    dashed = canvas(60, 40)
    dashed.line([(10, 20), (50, 20)], BLACK, width=3.0, dashes=5.0)
    assert ink(dashed).sum() == pytest.approx(4 * 5 * 3, rel=1e-4)
    assert ink(dashed)[20, 17] < 1e-5
    assert ink(dashed)[20, 12] > 1 - 1e-5


def test_shapes_outside_the_canvas_are_ignored(canvas):
    made = canvas(8, 8)
    made.line([(-50, -50), (-20, -30)], BLACK, width=2.0)
    made.rectangle((20, 20), (30, 30), BLACK)
    made.letters([], np.eye(2, 3), BLACK)
    made.line([(3.5, 3.5), (3.5, 3.5)], BLACK, width=2.0)
    assert ink(made)[:2].max() == 0
    assert ink(made)[3, 3] > 0.9


def test_blends_in_light(canvas):
    made = canvas(1, 1)
    made.rectangle((0, 0), (0.5, 1), BLACK)
    assert made.pixels()[0, 0, 0] == pytest.approx(scenes.to_srgb(np.float32(0.5)), abs=1e-3)


def test_later_shapes_cover_earlier_ones(canvas):
    made = canvas(4, 4)
    made.rectangle((0.5, 0), (4, 4), BLACK)
    made.rectangle((0.5, 0), (4, 4), WHITE)
    np.testing.assert_allclose(ink(made), 0, atol=1e-5)


def test_letters(addon):
    lettering = addon("bridge.lettering")
    before = (len(bpy.data.curves), len(bpy.data.objects), len(bpy.data.meshes))
    line = lettering.outlines("HI")
    assert len(line.letters) == 2
    (first,), (second,) = line.letters
    assert first.shape[1:] == (4, 3)
    assert first[..., 1].min() == pytest.approx(0.0, abs=0.02)
    assert 0.5 < first[..., 1].max() < 0.9
    assert line.low == pytest.approx(first[..., 0].min())
    assert line.high == pytest.approx(second[..., 0].max())
    for text in ("", " "):
        assert lettering.outlines(text) == lettering.Lettering((), 0.0, 0.0)
    assert lettering.outlines("HIHI").high > 1.8 * line.high
    assert (len(bpy.data.curves), len(bpy.data.objects), len(bpy.data.meshes)) == before


def test_letters_have_the_area_that_blender_gives_them(addon, canvas):
    """Blender makes polygons of curves, which here are fine."""
    text = outlines.text("Mip 4o")
    text.data.resolution_u = 64
    mesh = text.evaluated_get(scenes.depsgraph()).to_mesh()
    area = sum(face.area for face in mesh.polygons)
    made = canvas(160, 80)
    matrix = np.array([[40.0, 0.0, 5.0], [0.0, 40.0, 20.0]])
    made.letters(addon("bridge.lettering").outlines("Mip 4o").letters, matrix, BLACK)
    assert ink(made).sum() == pytest.approx(area * 40**2, rel=1e-3)
    assert ink(made).max() <= 1 + 1e-4
