# SPDX-License-Identifier: GPL-3.0-or-later

"""Styles, colors and gradients, against the specification."""

import numpy as np
import prefilter
import pytest
from drawings import SIZE, drawn, image, read, same, svg


def color_of(body, light="srgb", attributes='viewBox="0 0 100 100"'):
    drawing = read(body, attributes, light=light)
    return drawing.shapes_for(SIZE, SIZE)[0].color


RED, LIME, BLUE, BLACK = (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (0, 0, 0, 1)


@pytest.mark.parametrize(
    ("sheet", "attributes", "color"),
    [
        ("", 'fill="lime"', LIME),
        ("", 'fill="lime" style="fill:blue"', BLUE),
        ("rect{fill:red}", 'fill="lime"', RED),
        ("rect{fill:red}", 'style="fill:blue"', BLUE),
        ("rect{fill:red!important}", 'style="fill:blue"', RED),
        ("#a{fill:lime} rect{fill:red} .b{fill:blue}", 'id="a" class="b c"', LIME),
        (".b{fill:blue} rect{fill:red}", 'class="b c"', BLUE),
        (".b{fill:blue} .c{fill:red}", 'class="c b"', RED),
        ("g rect{fill:blue} rect{fill:red}", "", BLUE),
        ("svg &gt; rect{fill:blue} g &gt; rect{fill:lime}", "", LIME),
        ("rect[width='9']{fill:lime}", "", LIME),
        ("text, rect{fill:lime}", "", LIME),
        ("rect{fill:qwe; fill:lime; fill:12}", "", LIME),
        ("/* rect{fill:red} */ rect{fill:lime /* blue */}", "", LIME),
        ("@charset 'utf-8'; rect{fill:lime}", "", LIME),
        ("rect{fill:lime} rect:first-child{fill:red}", "", RED),
        ("", 'style="fill:nonsense"', BLUE),
        ("", 'fill="inherit"', BLUE),
        ("g{fill:lime}", "", LIME),
        ("g{color:lime} rect{fill:currentColor}", "", LIME),
        ("g{color:red;fill:currentColor}", 'color="lime"', LIME),
        ("rect{fill:rgb(0 255 0/100%)", "", LIME),
        ("*{fill:lime}", "", LIME),
    ],
)
def test_the_cascade(sheet, attributes, color):
    body = f'<style>{sheet}</style><g fill="blue"><rect {attributes} width="9" height="9"/></g>'
    assert color_of(body) == pytest.approx(color)


def test_style_sheets_apply_to_earlier_elements():
    body = '<rect width="9" height="9"/><style><![CDATA[ svg>rect{fill:lime} ]]></style>'
    assert color_of(body) == pytest.approx(LIME)


@pytest.mark.parametrize(
    ("text", "color"),
    [
        ("#f80", (1, 136 / 255, 0, 1)),
        ("#FF8000", (1, 128 / 255, 0, 1)),
        ("#f808", (1, 136 / 255, 0, 136 / 255)),
        ("#ff800080", (1, 128 / 255, 0, 128 / 255)),
        ("rgb(255, 128, 0)", (1, 128 / 255, 0, 1)),
        ("rgb(100%, 50%, 0%)", (1, 0.5, 0, 1)),
        ("rgba(255, 128, 0, 0.25)", (1, 128 / 255, 0, 0.25)),
        ("rgb(999, -1, 127.5)", (1, 0, 0.5, 1)),
        ("rgb(255 0 0 / 25%)", (1, 0, 0, 0.25)),
        ("hsl(120, 100%, 25%)", (0, 0.5, 0, 1)),
        ("hsla(-240, 200%, 25%, .5)", (0, 0.5, 0, 0.5)),
        ("hwb(0 0% 50%)", (0.5, 0, 0, 1)),
        ("  ReBeccaPurple ", (102 / 255, 51 / 255, 153 / 255, 1)),
    ],
)
def test_colors(text, color):
    premultiplied = (*(value * color[3] for value in color[:3]), color[3])
    body = f'<rect width="9" height="9" fill="{text}"/>'
    assert color_of(body) == pytest.approx(premultiplied, abs=1e-6)
    decoded = prefilter.to_linear(np.array([[color[:3]]], np.float64))[0, 0] * color[3]
    assert color_of(body, "linear") == pytest.approx((*decoded, color[3]), abs=1e-6)


def test_opacities_multiply():
    body = (
        '<g opacity="50%"><rect width="9" height="9" fill="rgba(255,0,0,.5)" fill-opacity="0.5" '
        'style="opacity:.5"/></g>'
    )
    assert color_of(body) == pytest.approx((1 / 16, 0, 0, 1 / 16))
    assert read(body.replace("50%", "0")).shapes == []
    assert read('<rect width="9" height="9" fill="transparent"/>').shapes == []


def test_fill_rules():
    data = "M 10 10 H 90 V 90 H 10 Z M 30 30 H 60 V 60 H 30 Z"
    whole = drawn(f'<path d="{data}"/>')
    ring = drawn(f'<g fill-rule="evenodd"><path d="{data}"/></g>')
    assert whole[..., 3].sum() == pytest.approx(6400, abs=1e-3)
    assert ring[..., 3].sum() == pytest.approx(5500, abs=1e-3)


@pytest.mark.parametrize(
    "attributes",
    ['display="none"', 'style="display:none"', 'visibility="hidden"', 'fill="none"', 'opacity="0"'],
)
def test_hidden_elements(attributes):
    assert read(f'<g {attributes}><rect width="9" height="9"/></g>').shapes == []


def test_visible_children_of_hidden_groups_show():
    body = '<g visibility="hidden"><rect width="9" height="9" visibility="visible"/></g>'
    assert len(read(body).shapes) == 1
    body = '<g display="none"><rect width="9" height="9" display="inline"/></g>'
    assert read(body).shapes == []


def gradient(stops, attributes="", tag="linearGradient", shape='<rect width="100" height="100" '):
    listed = "".join(
        f'<stop offset="{offset}" stop-color="{color}" stop-opacity="{alpha}"/>'
        for offset, color, alpha in stops
    )
    return f'<{tag} id="g" {attributes}>{listed}</{tag}>{shape} fill="url(#g)"/>'


TWO = (("0", "rgb(255,0,51)", 1), ("100%", "rgb(0,204,255)", 1))
FADING = (("0.2", "yellow", 1), ("0.6", "blue", 0.25), ("0.9", "lime", 0.75))


def straight_colors(stops, offsets):
    """Colors at offsets: each straight value is interpolated linearly."""
    numbers = {"yellow": (1, 1, 0), "blue": (0, 0, 1), "lime": (0, 1, 0)}
    numbers |= {TWO[0][1]: (1, 0, 0.2), TWO[1][1]: (0, 0.8, 1)}
    places = [float(offset.rstrip("%")) / (100 if "%" in offset else 1) for offset, _, _ in stops]
    values = np.array([(*numbers[color], alpha) for _, color, alpha in stops])
    return np.stack([np.interp(offsets, places, values[:, k]) for k in range(4)], -1)


@pytest.mark.parametrize("stops", [TWO, FADING])
@pytest.mark.parametrize("light", ["srgb", "linear"])
def test_gradient_interpolation(stops, light):
    actual = drawn(gradient(stops), light, 64)
    # The mean over each pixel, from many samples.
    offsets = (np.arange(64 * 50) + 0.5) / (64 * 50)
    values = straight_colors(stops, offsets)
    if light == "linear":
        values[:, :3] = prefilter.to_linear(values[None, :, :3])[0]
    values[:, :3] *= values[:, 3:]
    expected = values.reshape(64, 50, 4).mean(1)
    assert np.abs(actual - expected).max() < 1 / 1020
    assert np.abs(actual - actual[:1]).max() < 1e-5


@pytest.mark.parametrize(
    ("attributes", "offset"),
    [
        ("", lambda x, y: x / 100),
        ('x2="0" y2="1"', lambda x, y: y / 100),
        ('x1="25%" x2="75%"', lambda x, y: np.clip((x / 100 - 0.25) * 2, 0, 1)),
        (
            'gradientUnits="userSpaceOnUse" x1="20" x2="70"',
            lambda x, y: np.clip((x - 20) / 50, 0, 1),
        ),
        (
            'gradientUnits="userSpaceOnUse" x1="20%" x2="70%"',
            lambda x, y: np.clip((x - 20) / 50, 0, 1),
        ),
        ('gradientTransform="rotate(90)"', lambda x, y: y / 100),
        ('x2="0.25" spreadMethod="repeat"', lambda x, y: (x / 25) % 1),
        ('x2="0.25" spreadMethod="reflect"', lambda x, y: 1 - abs((x / 25) % 2 - 1)),
    ],
)
def test_linear_gradients(attributes, offset):
    actual = drawn(gradient(TWO, attributes))
    y, x = np.mgrid[0:100, 0:100] + 0.5
    expected = straight_colors(TWO, offset(x, y))
    # Pixels where the gradient restarts mix both ends.
    jumps = np.abs(np.gradient(expected, axis=1)).max(-1) > 0.1
    assert jumps.any() == ("repeat" in attributes)
    assert np.abs(actual - expected)[~jumps].max() < 0.02
    assert np.abs(actual - expected)[~jumps].mean() < 1e-3


@pytest.mark.parametrize(
    ("attributes", "offset"),
    [
        ("", lambda x, y: np.hypot(x - 50, y - 50) / 50),
        ('cx="25%" cy="75%" r="1"', lambda x, y: np.hypot(x - 25, y - 75) / 100),
        (
            'gradientUnits="userSpaceOnUse" cx="30" cy="40" r="20"',
            lambda x, y: np.hypot(x - 30, y - 40) / 20,
        ),
        ('fr="25%"', lambda x, y: (np.hypot(x - 50, y - 50) - 25) / 25),
        ('fx="0.3"', None),
    ],
)
def test_radial_gradients(attributes, offset):
    actual = drawn(gradient(TWO, attributes, "radialGradient"))
    y, x = np.mgrid[0:100, 0:100] + 0.5
    if offset is None:
        # The circle at t has its center on the line from the focus f, and the radius 50 t: |d - t
        # f| = 50 t, which is t^2 (50^2 - f^2) + 2 t (d . f) - |d|^2 = 0.
        dx, dy, f = x - 30, y - 50, 20.0
        a, b = 50.0**2 - f**2, dx * f
        at = (np.sqrt(b * b + a * (dx * dx + dy * dy)) - b) / a
    else:
        at = offset(x, y)
    expected = straight_colors(TWO, np.clip(at, 0, 1))
    assert np.abs(actual - expected).mean() < 1e-3
    assert np.abs(actual - expected).max() < 0.02


@pytest.mark.parametrize(
    ("cx", "r", "fx", "fr"),
    [(70, 10, 20, 0), (70, 10, 20, 4), (70, 10, 30, 25), (50, 10, 50, 40), (60, 20, 70, 45)],
)
@pytest.mark.parametrize("spread", ["pad", "repeat"])
def test_gradients_between_any_two_circles(cx, r, fx, fr, spread):
    """The circle at t has its center on the line from the focus to the center. A pixel has the
    color of the largest t whose circle contains it; without any it is transparent.
    """
    attributes = f'gradientUnits="userSpaceOnUse" cx="{cx}" cy="50" r="{r}" fx="{fx}" fy="50" '
    attributes += f'fr="{fr}" spreadMethod="{spread}"'
    body = gradient(TWO, attributes, "radialGradient")
    actual = image(read(body).shapes_for(SIZE, SIZE))[::-1]
    # The backdrop shows through.
    below = '<circle cx="50" cy="50" r="40" fill="blue"/>'
    over = image(read(below + body).shapes_for(SIZE, SIZE))[::-1]
    alone = image(read(below).shapes_for(SIZE, SIZE))[::-1]
    nothing = (actual[..., 3] == 0.0) & (alone[..., 3] > 1 - 1e-6)
    assert nothing.any() == (fr <= 4 or fx == 30)
    np.testing.assert_allclose(over[nothing], alone[nothing], atol=1e-5)
    steps = np.linspace(-20, 20, 20_001)
    radii, centers = fr + steps * (r - fr), fx + steps * (cx - fx)
    checked = 0
    for x, y in np.random.default_rng(5).integers(2, 98, (30, 2)):
        # Colors may jump within a pixel, unless all of its corners agree.
        corners = [(x + dx, y + dy) for dx in (0.0, 0.5, 1.0) for dy in (0.0, 0.5, 1.0)]
        at = []
        for px, py in corners:
            off = np.hypot(px - centers, py - 50) - radii
            on = np.flatnonzero((off[1:] * off[:-1] <= 0) & (radii[1:] >= 0))
            at.append(steps[on[-1]] if len(on) else None)
        if all(each is None for each in at):
            np.testing.assert_allclose(actual[y, x], 0.0, atol=1e-6)
            checked += 1
        elif None not in at and np.ptp(np.floor(at)) == 0 and np.ptp(at) < 0.2:
            shares = np.array(at) % 1 if spread == "repeat" else np.clip(at, 0, 1)
            expected = straight_colors(TWO, shares).mean(0)
            np.testing.assert_allclose(actual[y, x], expected, atol=0.02)
            checked += 1
    assert checked > 8


def test_gradients_by_reference():
    body = (
        '<linearGradient id="a" xlink:href="#b" x2="0.5"/>'
        '<linearGradient id="b" href="#c" x2="0.1" spreadMethod="reflect"/>'
        '<radialGradient id="c" r="3"><stop stop-color="lime"/><stop offset="1"/></radialGradient>'
        '<rect width="100" height="100" fill="url(#a)"/>'
    )
    direct = (
        '<linearGradient id="a" x2="0.5" spreadMethod="reflect"><stop stop-color="lime"/>'
        '<stop offset="1"/></linearGradient><rect width="100" height="100" fill="url(#a)"/>'
    )
    same(drawn(body), drawn(direct))


def test_gradients_move_with_their_shape():
    body = gradient(
        TWO, shape='<rect width="50" height="100" transform="translate(100) rotate(90)"'
    )
    turned = drawn(body)
    still = drawn(gradient(TWO, shape='<rect width="50" height="100"'))
    np.testing.assert_allclose(turned[:50], np.rot90(still[:, :50], -1), atol=1e-5)


@pytest.mark.parametrize(
    ("definition", "color"),
    [
        ("<linearGradient id='g'/>", None),
        ("<linearGradient id='g' gradientTransform='scale(0)'><stop/></linearGradient>", None),
        ("<linearGradient id='g'><stop stop-color='lime'/></linearGradient>", LIME),
        ("<linearGradient id='g' x2='0'><stop/><stop stop-color='lime'/></linearGradient>", LIME),
        ("<radialGradient id='g' r='0'><stop/><stop stop-color='lime'/></radialGradient>", LIME),
        ("<radialGradient id='g' r='-1'><stop/><stop stop-color='lime'/></radialGradient>", LIME),
        ("<g id='g'/>", None),
        ("", None),
    ],
)
def test_degenerate_gradients(definition, color):
    body = f'{definition}<rect width="9" height="9" fill="url(#g)"/>'
    if color is None:
        assert read(body).shapes == []
        # The fallback color only applies if there is no gradient.
        other = body.replace("url(#g)", "url('#g') blue")
        if "Gradient" in definition:
            assert read(other).shapes == []
        else:
            assert color_of(other) == pytest.approx(BLUE)
    else:
        assert color_of(body) == pytest.approx(color)
        half = body.replace("fill=", 'fill-opacity="0.5" fill=')
        assert color_of(half) == pytest.approx([value / 2 for value in color])


def test_a_box_without_area_has_no_gradient():
    body = gradient(TWO, shape='<path d="M 0 5 H 50"')
    assert read(body).shapes == []


@pytest.mark.parametrize("kind", ["gradient", "pattern"])
@pytest.mark.parametrize("place", ["use", "marker"])
def test_context_paints(kind, place):
    """Each part of marked or used contents is painted as a part of one outline."""
    paint = (
        '<linearGradient id="p" gradientTransform="rotate(20)"><stop stop-color="red"/>'
        '<stop offset="1" stop-color="blue"/></linearGradient>'
        if kind == "gradient"
        else '<pattern id="p" width="0.25" height="0.5"><path d="M0 0H4V9H0z" fill="teal"/>'
        "</pattern>"
    )
    boxes = ((10, 20, 30, 20), (60, 30, 24, 40))
    if place == "use":
        inside = "".join(
            f'<rect x="{(x - 5) / 2}" y="{y - 7}" width="{w / 2}" height="{h}" fill="context-fill" '
            'transform="scale(2 1)"/>'
            for x, y, w, h in boxes
        )
        body = f'<defs><g id="g">{inside}</g></defs><use href="#g" x="5" y="7" fill="url(#p)"/>'
    else:
        # Corners of a box around both; the path itself has no area, and no fill.
        body = (
            '<marker id="m" markerUnits="userSpaceOnUse" markerWidth="9" markerHeight="9" '
            'overflow="visible" orient="90"><path d="M0 0H10V-8H0z" fill="context-fill"/></marker>'
            '<path d="M10 20L84 70" marker-start="url(#m)" marker-end="url(#m)" fill="url(#p)"/>'
        )
        boxes = ((10, 20, 8, 10), (84, 70, 8, 10))
    parts = "".join(f"M{x} {y}h{w}v{h}h{-w}z" for x, y, w, h in boxes)
    clip = f'<clipPath id="c"><path d="{parts}"/></clipPath>'
    # The same paint, in user units instead of fractions of the box.
    shares = "matrix(74 0 0 50 10 20)"
    if kind == "gradient":
        paint += paint.replace(
            'id="p" gradientTransform="',
            f'id="q" gradientUnits="userSpaceOnUse" x2="1" gradientTransform="{shares} ',
        )
    else:
        paint += (
            '<pattern id="q" patternUnits="userSpaceOnUse" x="10" y="20" width="18.5" height="25">'
            '<path d="M0 0H4V9H0z" fill="teal"/></pattern>'
        )
    expected = f'{clip}<rect width="100" height="100" fill="url(#q)" clip-path="url(#c)"/>'
    actual, _ = prefilter.rasterize_svg(svg(paint + body), 100, 100)
    other, _ = prefilter.rasterize_svg(svg(paint + expected), 100, 100)
    np.testing.assert_allclose(actual, other, atol=1e-5)


def test_inherit_keyword():
    rect = '<rect x="10" y="10" width="40" height="40" {}/>'
    tree = '<clipPath id="c"><path d="M0 0H30V30H0z"/></clipPath><g clip-path="url(#c)">'
    both = tree + rect.format('clip-path="inherit" transform="translate(5 5)"') + "</g>"
    same(drawn(both), drawn('<path d="M15 15H30V30H15z"/>'))
    same(drawn(rect.format('clip-path="inherit" overflow="inherit"')), drawn(rect.format("")))


def test_fallback_color_of_patterns():
    pattern = '<pattern id="p" width="1" height="1"><rect width="9" height="9"/></pattern>'
    line = '<path d="M10 50H90" stroke-width="8" stroke="{}"/>'
    same(drawn(pattern + line.format("url(#p) green")), drawn(line.format("green")))
    assert not drawn(pattern + line.format("url(#p)")).any()
