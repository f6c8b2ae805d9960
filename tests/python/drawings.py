# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawings for tests, and images of them."""

import numpy as np
import prefilter

SIZE = 100
RED, GREEN = (1.0, 0.0, 0.0), (0.0, 128 / 255, 0.0)


def svg(body, attributes='viewBox="0 0 100 100"'):
    names = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    return f"<svg {names} {attributes}>{body}</svg>"


def read(body, attributes='viewBox="0 0 100 100"', **options):
    return prefilter.read_svg(svg(body, attributes), **options)


def image(shapes, width=SIZE, height=SIZE):
    return prefilter.rasterize(shapes, width, height, overlap="cover")


def drawn(body, light="srgb", size=SIZE):
    """Rasterizes a drawing of 100 x 100 units without warnings; row 0 is at the top."""
    drawing = read(body, light=light)
    assert drawing.warnings == ()
    return image(drawing.shapes_for(size, size), size, size)[::-1]


def outline(draw, rule="nonzero"):
    """Rasterizes a green shape drawn in units with y downwards; row 0 is at the top."""
    shape = prefilter.Shape(fill_rule=rule, color=(0.0, 128 / 255, 0.0, 1.0))
    draw(shape)
    return image([shape.transformed([[1, 0, 0], [0, -1, SIZE]])])[::-1]


def polygon(*points):
    return outline(lambda shape: shape.add_polygon(np.array(points, np.float64)))


def box_of(drawing, index=0, size=SIZE):
    """Left, top, right and bottom of a shape at a size, y downwards."""
    (left, low), (right, high) = drawing.shapes_for(size, size)[index].bounds
    return left, size - high, right, size - low


def same(one, other):
    np.testing.assert_allclose(one, other, atol=1e-6)


def whole(body, size=SIZE, attributes='viewBox="0 0 100 100"', **options):
    """Rasterizes a whole drawing without warnings; row 0 is at the top."""
    result, warnings = prefilter.rasterize_svg(svg(body, attributes), size, size, **options)
    assert warnings == ()
    return result[::-1]


def box(left, top, right, bottom, rest=""):
    return f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" {rest}/>'


def composited_boxes(*boxes, size=SIZE):
    """Composites boxes (left, top, right, bottom, color with straight alpha)."""
    shapes = []
    for left, top, right, bottom, color in boxes:
        alpha = color[3] if len(color) > 3 else 1.0
        shape = prefilter.Shape(color=(*(alpha * value for value in color[:3]), alpha))
        low, high = SIZE - bottom, SIZE - top
        shape.add_polygon([(left, low), (right, low), (right, high), (left, high)])
        shapes.append(shape.transformed([[size / SIZE, 0, 0], [0, size / SIZE, 0]]))
    return image(shapes, size, size)[::-1]
