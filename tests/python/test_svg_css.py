# SPDX-License-Identifier: GPL-3.0-or-later

"""Style sheets: variables, colors, calculations, transforms."""

import math

import numpy as np
import prefilter
import pytest
from drawings import SIZE, drawn, polygon, read, same, svg


def color_of(body, attributes='viewBox="0 0 100 100"'):
    """Straight color in the middle of a drawing, in 255ths."""
    result, warnings = prefilter.rasterize_svg(svg(body, attributes), SIZE, SIZE)
    assert warnings == ()
    *rgb, alpha = (float(value) for value in result[50, 50])
    return [round(255.0 * value / alpha) for value in rgb] + [round(alpha, 2)]


def square(fill):
    return f'<rect width="100" height="100" style="fill:{fill}"/>'


# Colors as shown by Chromium 156, which rounds some of them differently.
@pytest.mark.parametrize(
    ("text", "color"),
    [
        ("oklab(0.6 0.1 -0.1)", (159, 99, 186)),
        ("oklch(60% 0.15 320)", (167, 95, 183)),
        ("oklch(none none none)", (0, 0, 0)),
        ("lab(50% 40 -20)", (171, 90, 154)),
        ("lab(120 0 0)", (255, 255, 255)),
        ("lch(50 50 120)", (92, 130, 37)),
        ("color(display-p3 0.2 0.8 0.3)", (0, 208, 50)),
        ("color(rec2020 0.5 0.2 0.9)", (158, 43, 243)),
        ("color(srgb 1.2 50% -0.1)", (255, 128, 0)),
        ("color(srgb-linear .5 .5 .5)", (188, 188, 188)),
        ("color(xyz 0.3 0.3 0.3)", (162, 145, 143)),
        ("color(prophoto-rgb .5 .5 .5)", (146, 146, 146)),
        ("color(a98-rgb .5 .2 .5)", (147, 48, 131)),
        ("hwb(120 20% 30%)", (51, 179, 51)),
        ("rgb(none 128 255)", (0, 128, 255)),
        ("rgb(300 -20 50%)", (255, 0, 128)),
        ("rgb(calc(255 * .5) 0 0)", (128, 0, 0)),
        ("rgb(from red g r b)", (0, 255, 0)),
        ("oklch(from #123456 calc(l + .2) c h)", (72, 108, 145)),
        ("color-mix(in srgb, red 40%, blue)", (102, 0, 153)),
        ("color-mix(in oklch, red, blue)", (186, 0, 194)),
        ("color-mix(in oklab, white 30%, black)", (46, 46, 46)),
        ("color-mix(in hsl longer hue, red, lime)", (0, 0, 255)),
        ("light-dark(#f00, #00f)", (255, 0, 0)),
        ("hsl(0.5turn 100% 50%)", (0, 255, 255)),
    ],
)
def test_colors(text, color):
    np.testing.assert_allclose(color_of(square(text)), [*color, 1.0], atol=1.0)


@pytest.mark.parametrize(
    ("text", "alpha"),
    [
        ("hsl(120 50 50 / .5)", 0.5),
        ("rgb(10% 20% 30% / 40%)", 0.4),
        ("oklab(0.5 0 0 / calc(1 / 4))", 0.25),
        ("color-mix(in srgb, red 20%, blue 20%)", 0.4),
    ],
)
def test_alpha(text, alpha):
    assert color_of(square(text))[3] == pytest.approx(alpha, abs=0.005)


@pytest.mark.parametrize(
    "text",
    ["hsl(120, 50, 50)", "rgb(50%, 128, 0)", "color(nowhere 1 1 1)", "lab(1, 2, 3)", "oklab(1 2)"],
)
def test_invalid_colors_cause_warnings(text):
    actual, warnings = prefilter.rasterize_svg(svg(square(f"lime;fill:{text}")), SIZE, SIZE)
    assert list(actual[50, 50]) == [0.0, 1.0, 0.0, 1.0]
    assert [str(warning).split(":")[0] for warning in warnings] == [f"fill '{text}'"]


@pytest.mark.parametrize(
    ("body", "color"),
    [
        (square("var(--none, lime)"), "lime"),
        (square("var(--none, var(--neither, lime))"), "lime"),
        ("<style>:root { --a: lime }</style>" + square("var(--a)"), "lime"),
        (
            "<style>:root { --b: 120; --a: hsl(var(--b) 100% var(--c, 50%)) }</style>"
            + square("var(--a)"),
            "lime",
        ),
        ('<g style="--a: lime"><g style="--a: inherit">' + square("var(--a)") + "</g></g>", "lime"),
        (
            '<g style="--a: red"><g style="--a: initial">' + square("var(--a, lime)") + "</g></g>",
            "lime",
        ),
        # Names are case-sensitive.
        (
            '<g style="--A: lime; --a: red"><rect width="100" height="100" fill="var(--A)"/></g>',
            "lime",
        ),
        # A circular variable has no value, so that the fallback applies.
        ('<g style="--a: var(--b); --b: var(--a)">' + square("var(--a, lime)") + "</g>", "lime"),
        # Importance precedes specificity.
        (
            "<style>rect { --a: lime !important }</style>"
            '<rect style="--a: red; fill: var(--a)" width="100" height="100"/>',
            "lime",
        ),
        # Variables take their values at the `use`.
        (
            '<defs><rect id="r" width="100" height="100" fill="var(--a, red)"/></defs>'
            '<use href="#r" style="--a: lime"/>',
            "lime",
        ),
        (square("var(--a);--a:lime;"), "lime"),
        ('<g fill="lime"><rect width="100" height="100" style="fill:unset"/></g>', "lime"),
        ('<g fill="lime"><rect width="100" height="100" style="fill:initial"/></g>', "black"),
    ],
)  # fmt: skip
def test_variables(body, color):
    assert color_of(body)[:3] == ([0, 255, 0] if color == "lime" else [0, 0, 0])


def test_invalid_variables_inherit_the_color():
    body = (
        '<g fill="lime"><rect width="100" height="100" fill="red" style="--x:5px;fill:var(--x)"/>'
    )
    actual, warnings = prefilter.rasterize_svg(svg(f"{body}</g>"), SIZE, SIZE)
    assert list(actual[50, 50]) == [0.0, 1.0, 0.0, 1.0]
    assert [warning.name for warning in warnings] == ["fill 'var(--x)'"]


def test_variables_are_limited():
    names = "".join(f"--v{i}: var(--v{i + 1}) var(--v{i + 1});" for i in range(40))
    read(f'<rect width="9" height="9" style="{names} --v40: 1; fill: var(--v0)"/>')


@pytest.mark.parametrize(
    ("rect", "box"),
    [
        ('x="calc(50% - 10px)" y="0" width="calc(2 * 10px)" height="100%"', (40, 0, 60, 100)),
        (
            'style="x:calc(10px + 20px);y:5px;width:min(40px, 30px);height:calc(1em / 2)"',
            (30, 5, 60, 13),
        ),
        ('x="clamp(10px, 5px, 20px)" width="max(1px, 2px)" height="9"', (10, 0, 12, 9)),
    ],
)  # fmt: skip
def test_calculated_lengths(rect, box):
    left, top, right, bottom = box
    expected = polygon((left, top), (right, top), (right, bottom), (left, bottom))
    same(drawn(f'<rect fill="green" {rect}/>'), expected)


def turned(points, degrees, about):
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    off = np.array(points, float) - about
    return (
        np.stack([cos * off[:, 0] - sin * off[:, 1], sin * off[:, 0] + cos * off[:, 1]], 1) + about
    )


BOX = [(20, 20), (60, 20), (60, 40), (20, 40)]


def moved(x, y):
    return np.array([(left + x, top + y) for left, top in BOX], float)


@pytest.mark.parametrize(
    ("style", "points"),
    [
        (
            "transform:rotate(45deg);transform-box:fill-box;transform-origin:center",
            turned(BOX, 45, (40, 30)),
        ),
        ("transform:rotate(45deg);transform-box:fill-box", turned(BOX, 45, (20, 20))),
        ("rotate:45deg;transform-box:fill-box;transform-origin:50% 50%", turned(BOX, 45, (40, 30))),
        ("transform:rotate(30deg);transform-origin:10px 50%", turned(BOX, 30, (10, 50))),
        ("translate:10px 20%;", moved(10, 20)),
        ("transform:translate(50%, 10%);transform-box:fill-box", moved(20, 2)),
        ("transform:translate(calc(10px + 5%), 1em)", moved(15, 16)),
        ("scale:.5", moved(0, 0) / 2),
        # `translate`, then `rotate`, `scale` and `transform`.
        ("transform:translate(10px);scale:.5;translate:5px", moved(20, 0) / 2),
        (
            "transform:rotate(.25turn);stroke:none;transform-box:stroke-box",
            turned(BOX, 90, (20, 20)),
        ),
    ],
)  # fmt: skip
def test_transforms(style, points):
    rect = f'<rect x="20" y="20" width="40" height="20" fill="green" style="{style}"/>'
    same(drawn(rect), polygon(*points))


def test_d_is_a_property():
    body = """<path fill="green" d="M0 0H5V5z" style='d:path("M10 10H70V70H10Z")'/>"""
    same(drawn(body), polygon((10, 10), (70, 10), (70, 70), (10, 70)))
    assert read('<path d="M0 0H5V5z" style="d:none"/>').shapes == []


def test_unsupported_rules_cause_warnings():
    css = (
        "rect { foo: 1; inset: 2px; animation: x 1s; fill: nothing; cursor: help; -x-y: 1; --z: 1 }"
    )
    drawing = read(f'<style>{css}</style><rect width="9" height="9"/>')
    assert {warning.name for warning in drawing.warnings} == {
        "foo",
        "inset",
        "animation",
        "fill 'nothing'",
    }


@pytest.mark.parametrize("offset", [0.0, 1e6, 1e8, 9e8, -9e8])
def test_large_coordinates(offset):
    attributes = f'viewBox="{offset} {offset} 100 100"'
    body = (
        f'<path fill="green" d="M{offset + 10} {offset + 10}h50v20h-50z"/>'
        f'<path stroke="green" stroke-width="4" d="M{offset + 10} {offset + 50}h50"/>'
        f'<g transform="translate({offset} {offset})">'
        '<rect fill="green" x="10" y="60" width="50" height="20"/></g>'
    )  # fmt: skip
    actual, warnings = prefilter.rasterize_svg(svg(body, attributes), SIZE, SIZE)
    assert warnings == ()
    assert actual[..., 3].sum() == pytest.approx(1000 + 200 + 1000, abs=1e-3)


@pytest.mark.parametrize("far", ["1e4", "1e8", "1e10", "1e30", "-1e30", "1e90"])
def test_one_distant_point(far):
    wide = 90 if not far.startswith("-") else 10
    actual = drawn(f'<path fill="green" d="M10 10H{far}V30H10Z"/>')
    assert actual[..., 3].sum() == pytest.approx(20 * wide, rel=1e-4)
    actual = drawn(f'<path fill="none" stroke="green" stroke-width="4" d="M10 20H{far}"/>')
    assert actual[..., 3].sum() == pytest.approx(4 * wide, rel=1e-4)


def test_a_page_within_a_large_clip():
    body = (
        '<clipPath id="c"><path d="M0 0H1e7V5H0z"/></clipPath>'
        '<rect width="9" height="9" fill="green" clip-path="url(#c)"/>'
    )
    same(drawn(body), polygon((0, 0), (9, 0), (9, 5), (0, 5)))


def test_crisp_edges_fill_whole_pixels():
    y, x = np.mgrid[:SIZE, :SIZE] + 0.5
    actual = drawn('<circle cx="40" cy="41" r="30.2" shape-rendering="crispEdges"/>')[..., 3]
    np.testing.assert_array_equal(actual, np.hypot(x - 40, y - 41) < 30.2)
    ring = (
        '<circle cx="40" cy="41" r="30" stroke="red" stroke-width="3.1" fill="none" '
        'style="shape-rendering:crispEdges"/>'
    )
    np.testing.assert_array_equal(
        drawn(ring)[..., 3], np.abs(np.hypot(x - 40, y - 41) - 30) < 1.55
    )  # fmt: skip
    star = '<path d="M50 5L80 95L5 35H95L20 95z" fill-rule="{}" shape-rendering="crispEdges"/>'
    areas = [drawn(star.format(rule))[..., 3].sum() for rule in ("nonzero", "evenodd")]
    assert areas[1] < 0.8 * areas[0]


def test_a_crisp_line_is_one_pixel_wide():
    actual = drawn('<line x1="10" x2="10" y2="100" stroke="#000" shape-rendering="crispEdges"/>')
    np.testing.assert_array_equal(actual[50, 8:12, 3], [0.0, 1.0, 0.0, 0.0])


def test_non_scaling_strokes():
    line = '<line x1="10" x2="10" y1="0" y2="100" stroke="green" stroke-width="4" {}/>'
    unscaled = line.format('vector-effect="non-scaling-stroke"')
    body = f'<g transform="scale(4 1)">{unscaled}</g>'
    same(drawn(body), polygon((38, 0), (42, 0), (42, 100), (38, 100)))
    # The gradient does not move with the stroke.
    gradient = (
        '<linearGradient id="g" gradientUnits="userSpaceOnUse" x1="9" x2="11">'
        '<stop stop-color="lime"/><stop offset="1" stop-color="red"/></linearGradient>'
    )
    body = gradient + body.replace('stroke="green"', 'stroke="url(#g)"')
    actual = drawn(body)[50, 38:42, 0]
    np.testing.assert_allclose(actual, (np.arange(38, 42) + 0.5 - 36) / 8, atol=1e-6)
