# SPDX-License-Identifier: GPL-3.0-or-later

"""Geometry of SVG outlines, against shapes drawn manually, and formulas."""

import math

import numpy as np
import prefilter
import pytest
from drawings import SIZE, box_of, drawn, image, outline, polygon, read, same

QUARTER = math.sqrt(0.5)

SQUARE = ((10, 20), (60, 20), (60, 70), (10, 70))


@pytest.mark.parametrize(
    "data",
    [
        "M 10 20 L 60 20 L 60 70 L 10 70 Z",
        "m 10 20 l 50 0 0 50 -50 0 z",
        "M10,20H60V70H10z",
        "M10 20h50v50h-50z",
        "M 10 20 60 20 60 70 10 70",
        "  M1e1 2E1L.6e2 2.0e+1 6e1,70-0,70,10,70Z",
        "M10 20L60 20M0 0m60 70L10 70",
    ],
)
def test_lines(data):
    actual = drawn(f'<path fill="green" d="{data}"/>')
    if data.startswith("  M"):
        expected = polygon((10, 20), (60, 20), (60, 70), (0, 70), (10, 70))
    elif "m60" in data:
        expected = np.zeros((SIZE, SIZE, 4))
    else:
        expected = polygon(*SQUARE)
    same(actual, expected)


@pytest.mark.parametrize(
    "data",
    [
        "M 10 50 C 10 10 50 10 50 50 S 90 90 90 50 Z",
        "M 10 50 c 0 -40 40 -40 40 0 s 40 40 40 0 z",
        "M 10 50 C 10 10 50 10 50 50 50 90 90 90 90 50 Z",
    ],
)
def test_cubic_curves(data):
    def composited_boxes(shape):
        shape.move_to(10, 50)
        shape.curve_to(10, 10, 50, 10, 50, 50)
        shape.curve_to(50, 90, 90, 90, 90, 50)
        shape.close()

    same(drawn(f'<path fill="green" d="{data}"/>'), outline(composited_boxes))


@pytest.mark.parametrize(
    "data",
    [
        "M 10 50 Q 30 10 50 50 T 90 50 L 90 90 Z",
        "M 10 50 q 20 -40 40 0 t 40 0 l 0 40 z",
        "M 10 50 Q 30 10 50 50 70 90 90 50 V 90 z",
    ],
)
def test_quadratic_curves(data):
    def composited_boxes(shape):
        shape.move_to(10, 50)
        shape.curve_to(30, 10, 50, 50)
        shape.curve_to(70, 90, 90, 50)
        shape.line_to(90, 90)
        shape.close()

    same(drawn(f'<path fill="green" d="{data}"/>'), outline(composited_boxes))


def test_smooth_curves_after_other_segments():
    def composited_boxes(shape):
        shape.move_to(10, 50)
        shape.curve_to(30, 10, 50, 50)
        shape.curve_to(50, 50, 90, 90, 90, 50)
        shape.curve_to(90, 50, 20, 90)
        shape.close()

    data = "M 10 50 Q 30 10 50 50 S 90 90 90 50 T 20 90 Z"
    same(drawn(f'<path fill="green" d="{data}"/>'), outline(composited_boxes))


def points_of(segments):
    """Points along the conics and lines of an outline, y downwards."""
    result, at = [], None
    for kind, numbers in segments:
        if kind == "W":
            x1, y1, weight, x2, y2 = numbers
            t = np.linspace(0.0, 1.0, 33)[:, None]
            shares = (1 - t) ** 2, 2 * weight * t * (1 - t), t**2
            points = np.array([at, (x1, y1), (x2, y2)])
            result.append(sum(s * p for s, p in zip(shares, points, strict=True)) / sum(shares))
        at = numbers[-2:] if numbers else at
    return np.concatenate(result)


@pytest.mark.parametrize("rotation", [0.0, 30.0, -200.0])
@pytest.mark.parametrize("is_large", [False, True])
@pytest.mark.parametrize("is_positive", [False, True])
def test_arcs_lie_on_their_ellipse(rotation, is_large, is_positive):
    from prefilter.shapes._svg.model.outline import read_path

    start, end, rx, ry = np.array([20.0, 30.0]), np.array([47.0, 61.0]), 30.0, 45.0
    data = f"M 20 30 A {rx} {ry} {rotation} {int(is_large)} {int(is_positive)} 47 61"
    path, is_whole = read_path(data)
    assert is_whole
    points = points_of(path.segments())
    np.testing.assert_allclose(points[[0, -1]], [start, end])
    # In units of the ellipse, all points are at a distance of 1 from its center.
    angle = math.radians(rotation)
    turned = points @ [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    unit = turned / [rx, ry]
    system = np.column_stack([2 * unit, np.ones(len(unit))])
    (cx, cy, rest), *_ = np.linalg.lstsq(system, (unit**2).sum(1), rcond=None)
    assert rest + cx * cx + cy * cy == pytest.approx(1.0, abs=1e-9)
    np.testing.assert_allclose(np.hypot(*(unit - (cx, cy)).T), 1.0, atol=1e-12)
    turns = np.unwrap(np.arctan2(unit[:, 1] - cy, unit[:, 0] - cx))
    assert (abs(turns[-1] - turns[0]) > math.pi) == is_large
    assert (turns[-1] > turns[0]) == is_positive


def test_arcs_with_small_radii_grow_or_are_lines():
    half = drawn('<path fill="green" d="M 20 50 A 1 1 0 0 1 80 50 Z"/>')
    # Half a disc of radius 30, above its diameter.
    assert half[..., 1].sum() * 255 / 128 == pytest.approx(math.pi * 450, abs=1e-3)
    assert half[50:].sum() == pytest.approx(0.0, abs=1e-4)
    line = drawn('<path fill="green" d="M 10 20 H 60 A 0 9 0 0 1 60 70 H 10 Z"/>')
    same(line, polygon(*SQUARE))


def test_flags_of_arcs_need_no_separators():
    spaced = drawn('<path fill="green" d="M 20 50 A 30 30 0 1 1 80 50 Z"/>')
    same(drawn('<path fill="green" d="M20 50A30 30 0 1180 50Z"/>'), spaced)
    drawing = read('<path d="M 20 50 A 30 3001 180 50 Z"/>')
    assert [warning.kind for warning in drawing.warnings] == ["broken"]


@pytest.mark.parametrize("tail", ["L 5", "L 5#5 1", "Q 1 1", "A 5 5 0 2 0 1 1", "X", "L 1e999 5"])
def test_a_path_is_drawn_up_to_its_first_error(tail):
    drawing = read(
        f'<path fill="green" d="M 10 20 H 60 V 70 H 10 {tail} L 99 99 5 5"/>', light="srgb"
    )
    same(image(drawing.shapes_for(SIZE, SIZE))[::-1], polygon(*SQUARE))
    (warning,) = drawing.warnings
    assert (warning.kind, warning.name, warning.line) == ("broken", "path data", 1)
    assert "line 1" in str(warning)


@pytest.mark.parametrize("data", ["", "M", "M 1 2", "L 5 5 9 9", "A 5 5 0 0 1 50 50", "Z", "1 2"])
def test_paths_that_draw_nothing(data):
    assert read(f'<path d="{data}"/>').shapes_for(SIZE, SIZE) == [] or data == "M 1 2"


def ellipse(shape, cx, cy, rx, ry):
    shape.move_to(cx + rx, cy)
    for x1, y1, x2, y2 in ((1, 1, 0, 1), (-1, 1, -1, 0), (-1, -1, 0, -1), (1, -1, 1, 0)):
        shape.conic_to(cx + rx * x1, cy + ry * y1, QUARTER, cx + rx * x2, cy + ry * y2)
    shape.close()


def test_circles_and_ellipses_are_exact():
    actual = drawn('<circle cx="50" cy="40" r="30" fill="green"/>')
    same(actual, outline(lambda shape: ellipse(shape, 50, 40, 30, 30)))
    assert actual[..., 3].sum() == pytest.approx(math.pi * 900, abs=1e-3)
    same(
        drawn('<ellipse cx="50" cy="40" rx="30" ry="10" fill="green"/>'),
        outline(lambda shape: ellipse(shape, 50, 40, 30, 10)),
    )


@pytest.mark.parametrize(
    ("attributes", "rx", "ry"),
    [
        ('rx="10" ry="20"', 10, 20),
        ('rx="10"', 10, 10),
        ('ry="10%"', 10, 10),
        ('rx="80" ry="5"', 25, 5),
        ('rx="-3" ry="7"', 7, 7),
        ('rx="0" ry="9"', 0, 0),
        ("", 0, 0),
    ],
)
def test_rectangles(attributes, rx, ry):
    actual = drawn(f'<rect x="10" y="20" width="50" height="50" {attributes} fill="green"/>')
    if rx == 0:
        same(actual, polygon(*SQUARE))
        return
    # The corners lack the difference of a box and an ellipse.
    assert actual[..., 3].sum() == pytest.approx(2500 - (4 - math.pi) * rx * ry, abs=1e-3)
    assert np.abs(actual - polygon(*SQUARE))[20 + math.ceil(ry) : 69 - math.ceil(ry)].max() < 1e-6


def test_lines_and_polygons():
    points = "10,20 60 20,60,70 10-0"
    expected = polygon((10, 20), (60, 20), (60, 70), (10, 0))
    same(drawn(f'<polygon points="{points}" fill="green"/>'), expected)
    same(drawn(f'<polyline points="{points}" fill="green"/>'), expected)
    assert not drawn('<line x1="10" y1="10" x2="90" y2="90" fill="green"/>').any()


@pytest.mark.parametrize(
    ("length", "pixels"),
    [
        ("30", 30),
        ("30px", 30),
        (" 0.5in ", 48),
        ("1cm", 96 / 2.54),
        ("10mm", 96 / 2.54),
        ("40Q", 96 / 2.54),
        ("18pt", 24),
        ("2PC", 32),
        ("2em", 40),
        ("4ex", 40),
        ("30%", 30),
        ("3e1", 30),
    ],
)
def test_lengths(length, pixels):
    drawing = read(f'<g font-size="20"><rect width="{length}" height="10"/></g>')
    assert box_of(drawing) == pytest.approx((0, 0, pixels, 10))


def test_percentages_are_of_the_viewport():
    body = '<rect x="10%" y="10%" width="50%" height="50%"/><circle r="10%"/>'
    drawing = read(body, 'viewBox="0 0 80 60" width="160" height="120"')
    (left, low), (right, high) = drawing.shapes[0].bounds
    assert (left, 120 - high, right, 120 - low) == pytest.approx((16, 12, 96, 72))
    radius = 0.1 * math.sqrt((80**2 + 60**2) / 2) * 2
    assert drawing.shapes[1].bounds[1] == pytest.approx((radius, 120 + radius))


@pytest.mark.parametrize(
    ("text", "matrix"),
    [
        ("translate(10 20)", [[1, 0, 10], [0, 1, 20]]),
        ("translate(10)", [[1, 0, 10], [0, 1, 0]]),
        ("scale(2)", [[2, 0, 0], [0, 2, 0]]),
        ("scale(2,-.5)", [[2, 0, 0], [0, -0.5, 0]]),
        ("rotate(90)", [[0, -1, 0], [1, 0, 0]]),
        ("rotate(90 10 20)", [[0, -1, 30], [1, 0, 10]]),
        ("skewX(45)", [[1, 1, 0], [0, 1, 0]]),
        ("skewY(45)", [[1, 0, 0], [1, 1, 0]]),
        (" matrix ( 1 2 3 4-5 .6 ) ", [[1, 3, -5], [2, 4, 0.6]]),
        ("translate(10,20) scale(2)", [[2, 0, 10], [0, 2, 20]]),
        ("scale(2),translate(10,20)", [[2, 0, 20], [0, 2, 40]]),
    ],
)
def test_transforms(text, matrix):
    drawing = read(f'<path transform="{text}" d="M 1 2 L 4 2 4 7 Z"/>')
    corners = np.array([[1, 2, 1], [4, 2, 1], [4, 7, 1]]) @ np.transpose(matrix)
    expected = (*corners.min(0), *corners.max(0))
    assert box_of(drawing) == pytest.approx(expected, abs=1e-9)
    styled = read(f'<g><path style="transform:{text}" d="M 1 2 L 4 2 4 7 Z"/></g>')
    assert box_of(styled) == pytest.approx(expected, abs=1e-9)


def test_nested_transforms():
    body = '<g transform="translate(10 0)"><rect transform="scale(2)" width="5" height="5"/></g>'
    assert box_of(read(body)) == pytest.approx((10, 0, 20, 10))
    for flat in ("matrix(0 0 0 0 0 0)", "scale(0 1)", "scale(1e-30)"):
        assert read(f'<rect width="9" height="9" transform="{flat}"/>').shapes == []


@pytest.mark.parametrize(
    ("aspect", "box"),
    [
        ("", (0, 25, 100, 75)),
        ("xMidYMid", (0, 25, 100, 75)),
        ("xMinYMin meet", (0, 0, 100, 50)),
        ("xMaxYMax", (0, 50, 100, 100)),
        ("xMidYMid slice", (-50, 0, 150, 100)),
        ("xMinYMid slice", (0, 0, 200, 100)),
        ("xMaxYMid slice", (-100, 0, 100, 100)),
        ("none", (0, 0, 100, 100)),
        ("what", (0, 25, 100, 75)),
    ],
)
def test_preserve_aspect_ratio(aspect, box):
    rectangle = '<rect x="5" y="6" width="40" height="20"/>'
    drawing = read(rectangle, f'viewBox="5 6 40 20" preserveAspectRatio="{aspect}"')
    assert (drawing.width, drawing.height) == (40, 20)
    assert box_of(drawing) == pytest.approx(box)
    nested = read(
        f'<svg x="10" y="20" width="50" height="50" viewBox="5 6 40 20" '
        f'preserveAspectRatio="{aspect}">{rectangle}</svg>'
    )
    # The viewport clips the rest.
    expected = np.array(box).clip(0, 100) / 2 + (10, 20, 10, 20)
    assert box_of(nested) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("attributes", "size"),
    [
        ('width="30" height="20"', (30, 20)),
        ('width="30mm" height="1in"', (30 * 96 / 25.4, 96)),
        ('viewBox="0 0 40 20"', (40, 20)),
        ('viewBox="0 0 40 20" width="80"', (80, 40)),
        ('viewBox="0 0 40 20" height="80"', (160, 80)),
        ('viewBox="0 0 40 20" width="100%" height="100%"', (40, 20)),
        ("", (300, 150)),
        ('width="70"', (70, 150)),
    ],
)
def test_sizes(attributes, size):
    drawing = read('<rect width="100%" height="100%"/>', attributes)
    assert (drawing.width, drawing.height) == pytest.approx(size)
    if "viewBox" not in attributes or attributes.count("=") == 1:
        (low, high) = drawing.shapes[0].bounds
        np.testing.assert_allclose((low, high), ((0, 0), size), atol=1e-9)


def test_uses_and_symbols():
    body = (
        '<defs><rect id="box" width="10" height="10"/><symbol id="sign" viewBox="0 0 10 10">'
        '<rect width="10" height="10"/></symbol></defs>'
        '<use xlink:href="#box" x="5" y="6" transform="scale(2)"/>'
        '<use href="#sign" x="50" y="60" width="20" height="20" opacity="0.5"/>'
        '<symbol id="faint" opacity="0.5" transform="scale(2)"><use href="#box"/></symbol>'
        '<use href="#faint"/>'
    )
    drawing = read(body)
    assert drawing.warnings == ()
    assert len(drawing.shapes) == 3
    assert box_of(drawing, 0) == pytest.approx((10, 12, 30, 32))
    assert box_of(drawing, 1) == pytest.approx((50, 60, 70, 80))
    assert box_of(drawing, 2) == pytest.approx((0, 0, 20, 20))
    assert [shape.color[3] for shape in drawing.shapes] == [1.0, 0.5, 0.5]


def test_used_elements_inherit_the_style_of_their_use():
    body = '<defs><rect id="a" width="10" height="10"/></defs><use href="#a" fill="lime"/>'
    assert read(body, light="srgb").shapes[0].color == pytest.approx((0, 1, 0, 1))


def test_add_path_equals_single_segments():
    def by_steps(shape):
        shape.move_to(10, 20)
        shape.line_to(60, 20)
        shape.curve_to(90, 30, 60, 50)
        shape.conic_to(60, 80, 0.5, 40, 70)
        shape.curve_to(30, 60, 20, 90, 10, 60)
        shape.close()
        shape.move_to(20, 30)
        shape.line_to(40, 30)
        shape.line_to(30, 50)

    numbers = [10, 20, 60, 20, 90, 30, 60, 50, 60, 80, 0.5, 40, 70, 30, 60, 20, 90, 10, 60]
    numbers += [20, 30, 40, 30, 30, 50]
    same(outline(by_steps), outline(lambda shape: shape.add_path("MLQWCZMLL", numbers)))
    shape = prefilter.Shape()
    shape.add_path("", [])
    assert shape.bounds is None


@pytest.mark.parametrize(
    ("letters", "numbers", "words"),
    [
        ("MX", [1, 2], "letters: 'X' is not one of"),
        ("LM", [1, 2, 3, 4], "letters: begin with 'L'; M is needed"),
        (3, [1, 2], "letters: 3"),
        ("ML", [1, 2, 3], "numbers: 3; the letters need 4"),
        ("M", [[1, 2]], "numbers: shape (1, 2)"),
        ("M", ["a", "b"], "numbers: shape (2,)"),
        ("M", [1, math.nan], "numbers: one is not finite"),
        ("MW", [1, 2, 3, 4, 0, 5, 6], "numbers: a weight of 0"),
    ],
)
def test_paths_that_are_refused(letters, numbers, words):
    with pytest.raises(ValueError, match=words.split(":")[0]) as caught:
        prefilter.Shape().add_path(letters, numbers)
    assert words in str(caught.value)
