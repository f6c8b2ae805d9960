# SPDX-License-Identifier: GPL-3.0-or-later

"""Strokes, against strokes of shapes drawn manually, and their areas."""

import math

import numpy as np
import prefilter
import pytest
from drawings import SIZE, drawn, image, read

RED, LIME = (1, 0, 0, 1), (0, 1, 0, 1)


def stroked(draw, width, **options):
    shape = prefilter.Shape(color=(0.0, 128 / 255, 0.0, 1.0))
    draw(shape)
    outlined = shape.stroked(width, tolerance=1 / 1024, **options)
    return image([outlined.transformed([[1, 0, 0], [0, -1, SIZE]])])[::-1]


def corner(shape):
    shape.move_to(20, 80)
    shape.line_to(50, 20)
    shape.line_to(70, 80)


@pytest.mark.parametrize(
    ("attributes", "options"),
    [
        ("", {}),
        ('stroke-linejoin="round"', {"join": "round"}),
        ('stroke-linejoin="bevel" stroke-linecap="round"', {"join": "bevel", "cap": "round"}),
        ('stroke-linecap="square"', {"cap": "square"}),
        ('stroke-miterlimit="1.5"', {"miter_limit": 1.5}),
        ('stroke-dasharray="10 5%"', {"dashes": (10, 5)}),
        (
            'stroke-dasharray="9,3 5" stroke-dashoffset="4"',
            {"dashes": (9, 3, 5, 9, 3, 5), "dash_offset": 4},
        ),
        ('stroke-dasharray="0 0"', {}),
        ('stroke-dasharray="5 -5"', {}),
    ],
)
def test_strokes(attributes, options):
    lines = '<path d="M 20 80 L 50 20 70 80" fill="none" stroke="green" stroke-width="8"'
    drawing = read(f"{lines} {attributes}/>", light="srgb")
    actual = image(drawing.shapes_for(SIZE, SIZE))[::-1]
    np.testing.assert_allclose(actual, stroked(corner, 8, **options), atol=2e-3)


def test_strokes_are_transformed():
    body = (
        '<g transform="scale(4 1)"><path d="M 5 0 V 50 H 20" stroke="green" fill="none" '
        'stroke-width="2"/></g>'
    )
    actual = drawn(body)
    # A vertical line is widened to 8 pixels; a horizontal one stays 2 pixels wide.
    assert actual[10, :, 3].sum() == pytest.approx(8, abs=1e-3)
    assert actual[:, 50, 3].sum() == pytest.approx(2, abs=1e-3)


def test_strokes_are_computed_for_the_size():
    circle = '<circle cx="50" cy="50" r="40" fill="none" stroke="black" stroke-width="10"/>'
    drawing = read(circle)
    for size in (20, 100, 500):
        actual = image(drawing.shapes_for(size, size), size, size)
        area = math.pi * (45**2 - 35**2) * (size / 100) ** 2
        assert actual[..., 3].sum() == pytest.approx(area, rel=2e-4)


def test_paint_order():
    body = '<rect x="20" y="20" width="60" height="60" fill="red" stroke="lime" stroke-width="10"/>'
    np.testing.assert_allclose(drawn(body)[50, 22], LIME, atol=1e-5)
    first = body.replace("<rect", '<rect paint-order="stroke"')
    np.testing.assert_allclose(drawn(first)[50, 22], RED, atol=1e-5)
    np.testing.assert_allclose(drawn(first)[50, 17], LIME, atol=1e-5)
