# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of whole drawings, against closed forms and equivalent drawings."""

import math

import numpy as np
import prefilter
import pytest
from drawings import GREEN, RED, SIZE, box, composited_boxes, image, same, svg, whole

HALF = 128 / 255


def test_half_black_over_white_is_127():
    ways = [
        'fill-opacity="0.5"',
        'opacity="0.5"',
        'fill="rgba(0,0,0,.5)"',
        'fill="#00000080"',
        'opacity="0.5" stroke="black"',
    ]
    for rest in ways:
        body = box(0, 0, 100, 100, 'fill="white"') + box(-50, -50, 150, 150, rest)
        actual, _ = prefilter.rasterize_svg(svg(body), 8, 8, dtype=np.uint8)
        assert (actual == (127, 127, 127, 255)).all()
        light = whole(body, light="linear")
        # Half of linear light, encoded for display; #80 is a little more than half.
        encoded = np.rint(prefilter.to_srgb(light[50:51, 50, :3]) * 255)
        assert (encoded == (187 if "#" in rest else 188)).all()


def test_drawings_without_layers_equal_their_shapes():
    body = (
        '<linearGradient id="g"><stop stop-color="red"/><stop offset="1"/></linearGradient>'
        '<circle cx="40" cy="40" r="31" fill="url(#g)"/><path d="M9 9L90 33 40 95z" fill="#123"/>'
        '<path d="M9 90L70 33" stroke="green" stroke-width="7" stroke-linecap="round"/>'
    )
    for light in ("srgb", "linear"):
        for name in ("box", "lanczos3"):
            shapes = prefilter.read_svg(svg(body), light=light).shapes_for(60, 40)
            expected = prefilter.rasterize(shapes, 60, 40, filter=name)
            actual, _ = prefilter.rasterize_svg(svg(body), 60, 40, light=light, filter=name)
            same(actual, expected)


def test_a_group_is_translucent_as_a_whole():
    inner = box(10.5, 10, 50, 50, 'fill="red"') + box(30, 30, 70, 70.5, 'fill="green"')
    expected = composited_boxes((10.5, 10, 50, 50, RED), (30, 30, 70, 70.5, GREEN)) * np.float32(
        HALF
    )
    same(whole(f'<g opacity="0.5">{inner}</g>'), expected)
    # The same for an element with a fill and a stroke.
    rest = 'fill="red" stroke="green" stroke-width="10"'
    opaque = whole(box(20, 20, 60, 60, rest))
    same(whole(box(20, 20, 60, 60, f'{rest} opacity="0.5"')), opaque * np.float32(HALF))
    same(whole(f'<g opacity="0.5"><g opacity="0.5">{inner}</g></g>'), expected * np.float32(HALF))
    # A backdrop below.
    behind = box(0, 0, 100, 40, 'fill="blue"')
    below = composited_boxes((0, 0, 100, 40, (0, 0, 1)))
    same(
        whole(behind + f'<g opacity="0.5">{inner}</g>'), expected + below * (1 - expected[..., 3:])
    )


def test_groups_without_overlaps_need_no_layer():
    """Nothing shows through where two halves meet within a pixel."""
    inner = box(10, 10, 30.5, 50, 'fill="red"') + box(30.5, 10, 50, 50, 'fill="red"')
    same(whole(f'<g opacity="0.5">{inner}</g>'), composited_boxes((10, 10, 50, 50, (*RED, HALF))))


@pytest.mark.parametrize(
    ("clip", "element", "expected"),
    [
        # Clipping a shape at its own edge does not square its coverage.
        (box(10.5, 10.5, 50.5, 50.5), box(10.5, 10.5, 50.5, 50.5, "{}"), (10.5, 10.5, 50.5, 50.5)),
        (box(20.25, 0, 90, 90), box(10, 10.5, 50, 50, "{}"), (20.25, 10.5, 50, 50)),
        (box(20, 20, 60, 60), f"<g {{}}>{box(0, 0, 99, 30)}</g>", (20, 20, 60, 30)),
        (
            box(0, 0, 10, 10, 'transform="translate(5.5 5)"'),
            box(0, 0, 99, 99, "{}"),
            (5.5, 5, 15.5, 15),
        ),
        # Overlapping children: the clip is their union.
        (box(0, 0, 30, 30) + box(20, 0, 60, 30), box(10, 10, 50, 50, "{}"), (10, 10, 50, 30)),
        # A child with a clip path of its own, and a child by `use`.
        (box(0, 0, 90, 90, 'clip-path="url(#d)"'), box(10, 10, 60, 60, "{}"), (10, 10, 40, 40)),
        ('<use href="#r" x="5"/>', box(0, 0, 99, 99, "{}"), (7, 3, 17, 13)),
        (
            '<path clip-rule="evenodd" d="M0 0H99V99H0zM50 0H99V99H50z"/>',
            box(9, 9, 99, 20, "{}"),
            (9, 9, 50, 20),
        ),
    ],
)
def test_clip_paths_are_exact(clip, element, expected):
    defs = (
        f"<defs>{box(2, 3, 12, 13, 'id=' + chr(34) + 'r' + chr(34))}</defs>"
        f'<clipPath id="d">{box(0, 0, 40, 40)}</clipPath>'
    )
    body = f'{defs}<clipPath id="c">{clip}</clipPath>' + element.format('clip-path="url(#c)"')
    same(whole(body), composited_boxes((*expected, (0, 0, 0))))
    shapes = prefilter.read_svg(svg(body)).shapes_for(SIZE, SIZE)
    same(image(shapes)[::-1], composited_boxes((*expected, (0, 0, 0))))


def test_a_clip_path_of_curves_has_its_area():
    """The lens common to two discs of radius r at a distance d."""
    r, d = 30.0, 25.0
    lens = 2 * r * r * math.acos(d / (2 * r)) - d / 2 * math.sqrt(4 * r * r - d * d)
    body = (
        '<clipPath id="c"><circle cx="40" cy="50" r="30"/></clipPath>'
        '<circle cx="65" cy="50" r="30" clip-path="url(#c)"/>'
    )
    assert whole(body)[..., 3].sum(dtype=float) == pytest.approx(lens, rel=1e-6)


def test_clip_paths_in_units_of_a_box():
    clip = f'<clipPath id="c" clipPathUnits="objectBoundingBox">{box(0, 0, 0.5, 0.5)}</clipPath>'
    inner = box(20, 20, 40, 40) + box(60, 60, 80, 80) + box(0, 0, 99, 99, 'display="none"')
    expected = composited_boxes((20, 20, 40, 40, (0, 0, 0)))
    same(whole(f'{clip}<g clip-path="url(#c)">{inner}</g>'), expected)
    # Empty: a clip path without children, or in fractions of an empty box.
    assert not whole(f'<clipPath id="c"/><g clip-path="url(#c)">{inner}</g>').any()
    assert not whole(f'{clip}<g clip-path="url(#c)"/>').any()


def test_drawings_are_clipped_at_their_page():
    page = 'width="40" height="20"'
    body = box(-50, -50, 150, 150, 'stroke="black"')
    expected = np.zeros((40, 40, 4), np.float32)
    expected[10:30, :, 3] = 1
    # Other proportions leave a border.
    actual, _ = prefilter.rasterize_svg(svg(body, f'{page} viewBox="0 0 40 20"'), 40, 40)
    same(actual, expected)
    shapes = prefilter.read_svg(svg(body, f'{page} viewBox="0 0 40 20"')).shapes_for(40, 40)
    same(image(shapes, 40, 40), expected)
    actual, _ = prefilter.rasterize_svg(
        svg(body, f'{page} viewBox="0 0 40 20" overflow="visible"'), 40, 40
    )
    same(actual[..., 3], np.ones((40, 40)))
    # The page may exceed the view box.
    actual, _ = prefilter.rasterize_svg(svg(body, f'{page} viewBox="0 0 10 10"'), 40, 20)
    same(actual[..., 3], np.ones((20, 40)))


def test_language_of_the_root_does_not_matter():
    body = box(10, 10, 50, 50, 'fill="green"')
    actual = whole(body, attributes='viewBox="0 0 100 100" systemLanguage="ru"')
    same(actual, composited_boxes((10, 10, 50, 50, GREEN)))


def test_viewports_clip():
    inner = box(-50, -50, 150, 150)
    for attributes, expected in (
        ("", (10.5, 20, 40, 50)),
        ('overflow="hidden"', (10.5, 20, 40, 50)),
        ('overflow="visible"', (0, 0, 100, 100)),
        ('viewBox="0 0 5 5"', (10.5, 20, 40, 50)),
    ):
        body = f'<svg x="10.5" y="20" width="29.5" height="30" {attributes}>{inner}</svg>'
        same(whole(body), composited_boxes((*expected, (0, 0, 0))))
    symbol = f'<symbol id="s" viewBox="0 0 10 10">{inner}</symbol>'
    same(
        whole(f'{symbol}<use href="#s" x="5" y="5" width="20" height="20"/>'),
        composited_boxes((5, 5, 25, 25, (0, 0, 0))),
    )


@pytest.mark.parametrize(
    ("style", "color"),
    [
        ("background:#ff0000", (1, 0, 0, 1)),
        ("background-color: rgb(0 255 0 / 50%)", (0, HALF, 0, HALF)),
        ("color:#00f;background: no-repeat currentColor", (0, 0, 1, 1)),
        ("background: none", (0, 0, 0, 0)),
    ],
)
def test_the_page_has_a_background(style, color):
    actual = whole("", attributes=f'viewBox="0 0 100 100" style="{style}"')
    same(actual, np.broadcast_to(np.float32(color), actual.shape))
    half, _ = prefilter.rasterize_svg(svg("", f'viewBox="0 0 9 9" style="{style}"'), 20, 10)
    same(half[5, [0, 10, 19]], np.float32([(0, 0, 0, 0), color, (0, 0, 0, 0)]))


def formula(mode, b, s):
    """Formulas per channel, as in the recommendation."""
    match mode:
        case "multiply":
            return b * s
        case "screen":
            return 1 - (1 - b) * (1 - s)
        case "overlay":
            return formula("hard-light", s, b)
        case "darken":
            return min(b, s)
        case "lighten":
            return max(b, s)
        case "color-dodge":
            return 0 if b == 0 else 1 if s == 1 else min(1, b / (1 - s))
        case "color-burn":
            return 1 if b == 1 else 0 if s == 0 else 1 - min(1, (1 - b) / s)
        case "hard-light":
            return 2 * b * s if s <= 0.5 else 1 - 2 * (1 - b) * (1 - s)
        case "soft-light":
            if s <= 0.5:
                return b - (1 - 2 * s) * b * (1 - b)
            d = ((16 * b - 12) * b + 4) * b if b <= 0.25 else math.sqrt(b)
            return b + (2 * s - 1) * (d - b)
        case "difference":
            return abs(b - s)
        case "exclusion":
            return b + s - 2 * b * s
        case "normal":
            return s
    raise AssertionError


SEPARABLE = ("normal", "multiply", "screen", "overlay", "darken", "lighten", "color-dodge")
SEPARABLE += ("color-burn", "hard-light", "soft-light", "difference", "exclusion")


@pytest.mark.parametrize("mode", SEPARABLE)
def test_separable_blend_modes(mode):
    below, above = (0, 255, 51), (255, 153, 25)
    for first, second in ((below, above), (above, below), ((20, 100, 200), (70, 140, 20))):
        for alpha_b, alpha_s in ((255, 255), (128, 51), (51, 204)):
            colors = [
                "#" + "".join(f"{value:02x}" for value in (*color, alpha))
                for color, alpha in ((first, alpha_b), (second, alpha_s))
            ]
            body = box(0, 0, 99, 99, f'fill="{colors[0]}"')
            body += box(0, 0, 99, 99, f'fill="{colors[1]}" style="mix-blend-mode:{mode}"')
            actual = whole(body)[50, 50]
            b_alpha, s_alpha = alpha_b / 255, alpha_s / 255
            for channel, (b, s) in enumerate(zip(first, second, strict=True)):
                mixed = (1 - b_alpha) * s / 255 + b_alpha * formula(mode, b / 255, s / 255)
                expected = (1 - s_alpha) * b_alpha * b / 255 + s_alpha * mixed
                assert actual[channel] == pytest.approx(expected, abs=2e-6), (mode, b, s)
            assert actual[3] == pytest.approx(b_alpha + s_alpha - b_alpha * s_alpha, abs=1e-6)


def luminosity(color):
    return 0.3 * color[0] + 0.59 * color[1] + 0.11 * color[2]


def test_nonseparable_blend_modes():
    colors = [(220, 40, 90), (30, 160, 200), (128, 128, 128), (250, 250, 20), (5, 60, 0)]
    for b in colors:
        for s in colors:
            actual = {}
            for mode in ("hue", "saturation", "color", "luminosity"):
                body = box(0, 0, 99, 99, f'fill="rgb{b}"')
                body += box(0, 0, 99, 99, f'fill="rgb{s}" style="mix-blend-mode:{mode}"')
                actual[mode] = whole(body)[50, 50, :3].astype(float) * 255
            for mode in ("hue", "saturation", "color"):
                assert luminosity(actual[mode]) == pytest.approx(luminosity(b), abs=0.01)
            assert luminosity(actual["luminosity"]) == pytest.approx(luminosity(s), abs=0.01)
            for found in actual.values():
                assert found.min() >= -0.001
                assert found.max() <= 255.001
    gray = box(0, 0, 99, 99, 'fill="rgb(220,40,90)"') + box(
        0, 0, 99, 99, 'fill="#777" style="mix-blend-mode:saturation"'
    )
    assert np.ptp(whole(gray)[50, 50, :3]) < 1e-6


def test_isolated_groups_do_not_blend_with_the_backdrop():
    blending = box(20, 20, 80, 80, 'fill="#808080" style="mix-blend-mode:multiply"')
    behind = box(0, 0, 100, 100, 'fill="red"')
    mixed = whole(f"{behind}<g>{blending}</g>")[50, 50]
    np.testing.assert_allclose(mixed, (HALF, 0, 0, 1), atol=1e-6)
    for rest in ('style="isolation:isolate"', 'clip-path="url(#c)"', 'opacity="0.999999"'):
        clip = f'<clipPath id="c">{box(0, 0, 99, 99)}</clipPath>'
        alone = whole(f"{behind}{clip}<g {rest}>{blending}</g>")[50, 50]
        np.testing.assert_allclose(alone, (HALF, HALF, HALF, 1), atol=1e-5)


def test_luminance_masks():
    green = box(0, 0, 100, 100, 'fill="green" mask="url(#m)"')

    def masked(attributes, inner, element=green):
        return whole(f'<mask id="m" {attributes}>{inner}</mask>{element}')

    white = box(10, 10, 50.5, 50, 'fill="white"')
    same(masked("", white), composited_boxes((10, 10, 50.5, 50, GREEN)))
    for color, share in (("red", 0.2125), ("lime", 0.7154), ("blue", 0.0721), ("black", 0.0)):
        actual = masked("", box(10, 10, 50.5, 50, f'fill="{color}"'))
        same(actual, composited_boxes((10, 10, 50.5, 50, GREEN)) * np.float32(share))
    by_alpha = masked('mask-type="alpha"', box(10, 10, 50.5, 50, 'opacity="0.5"'))
    same(by_alpha, composited_boxes((10, 10, 50.5, 50, (*GREEN, HALF))))
    by_alpha = masked('style="mask-type:alpha"', box(10, 10, 50.5, 50))
    same(by_alpha, composited_boxes((10, 10, 50.5, 50, GREEN)))
    # Limited by its region: a tenth around the element by default.
    region = 'maskUnits="userSpaceOnUse" x="20" y="20" width="10" height="10"'
    same(masked(region, white), composited_boxes((20, 20, 30, 30, GREEN)))
    shares = 'x="0" y="0" width="0.25" height="1" maskContentUnits="objectBoundingBox"'
    actual = masked(shares, box(0, 0, 1, 0.5, 'fill="white"'))
    same(actual, composited_boxes((0, 0, 25, 50, GREEN)))
    gray = masked("", box(10, 10, 50, 50, 'fill="#808080"'))[30, 30, 3]
    assert gray == pytest.approx(HALF, abs=1e-5)
    linear = masked('color-interpolation="linearRGB"', box(10, 10, 50, 50, 'fill="#808080"'))
    assert linear[30, 30, 3] == pytest.approx(float(prefilter.to_linear([[HALF]])[0, 0]), abs=1e-5)


def test_masks_of_masks_are_as_in_browsers():
    white = box(10, 10, 50, 50, 'fill="white"')
    green = box(0, 0, 100, 100, 'fill="green" mask="url(#m)"')
    other = '<mask id="n"><rect x="20" y="20" width="10" height="10" fill="white"/></mask>'
    # The mask itself has no mask, but its children may.
    outer = f'{other}<mask id="m" mask="url(#n)">{white}</mask>{green}'
    same(whole(outer), composited_boxes((10, 10, 50, 50, GREEN)))
    inside = f'{other}<mask id="m"><g mask="url(#n)">{white}</g></mask>{green}'
    same(whole(inside), composited_boxes((20, 20, 30, 30, GREEN)))


def test_circular_masks_are_ignored():
    masks = "".join(
        f'<mask id="{name}"><rect x="{left}" y="{left}" width="{side}" height="{side}" '
        f'fill="white" mask="url(#{other})"/></mask>'
        for name, left, side, other in (("m", 10, 40, "n"), ("n", 20, 70, "m"))
    )
    body = masks + "".join(
        box(left, 0, left + 50, 100, f'fill="green" mask="url(#{name})"')
        for left, name in ((0, "m"), (50, "n"))
    )
    actual, (warning,) = prefilter.rasterize_svg(svg(body), SIZE, SIZE)
    assert "refers to itself" in str(warning)
    # The first is multiplied by both masks, the second by its own.
    same(actual[::-1], composited_boxes((20, 20, 50, 50, GREEN), (50, 20, 90, 90, GREEN)))


def test_patterns_equal_their_tiles():
    pattern = (
        '<pattern id="p" x="3" y="2" width="20" height="10" patternUnits="userSpaceOnUse">'
        f"{box(0, 0, 7.5, 4, 'fill=' + chr(34) + 'red' + chr(34))}</pattern>"
    )
    tiles = [
        (left, top, left + 7.5, top + 4, RED)
        for left in range(3, 100, 20)
        for top in range(2, 100, 10)
    ]
    actual = whole(pattern + box(0, 0, 100, 100, 'fill="url(#p)"'))
    same(actual[5:95, 5:95], composited_boxes(*tiles)[5:95, 5:95])
    # In an outline, half opaque, in fractions of its box, and rotated.
    actual = whole(pattern + box(20, 20, 60, 60, 'fill="url(#p)" fill-opacity="0.5"'))
    same(actual[20:60, 20:60], composited_boxes(*tiles)[20:60, 20:60] * np.float32(0.5))
    assert not actual[:20].any()
    shares = (
        '<pattern id="p" width="0.5" height="1" patternContentUnits="objectBoundingBox">'
        f"{box(0, 0, 0.25, 1, 'fill=' + chr(34) + 'red' + chr(34))}</pattern>"
    )
    actual = whole(shares + box(20, 20, 60, 60, 'fill="url(#p)"'))
    same(actual, composited_boxes((20, 20, 30, 60, RED), (40, 20, 50, 60, RED)))
    turned = pattern.replace("patternUnits", 'patternTransform="rotate(90)" patternUnits')
    same(
        whole(turned + box(0, 0, 100, 100, 'fill="url(#p)"')),
        whole(turned + box(-9, -9, 109, 109, 'fill="url(#p)"')),
    )


@pytest.mark.parametrize("side", [0.01, 0.07])
def test_fine_patterns_are_their_mean(side):
    pattern = (
        f'<pattern id="p" width="{side}" height="{2 * side}" patternUnits="userSpaceOnUse">'
        f'<rect width="{side}" height="{side / 2}" fill="red"/></pattern>'
    )
    actual = whole(pattern + box(20, 20, 60, 60, 'fill="url(#p)"'))
    np.testing.assert_allclose(
        actual[25:55, 25:55], np.broadcast_to((0.25, 0, 0, 0.25), (30, 30, 4)), atol=1e-3
    )


def test_markers_are_at_vertices_and_rotate():
    marker = (
        '<marker id="m" refX="2" refY="1" markerWidth="4" markerHeight="2" orient="{}">'
        '<rect width="4" height="2" fill="green"/></marker>'
    )
    line = '<path d="M20 20H60V80" fill="none" stroke-width="5" {}="url(#m)"/>'

    def at(orient, name):
        return whole(marker.format(orient) + line.format(name))

    same(at("0", "marker-start"), composited_boxes((10, 15, 30, 25, GREEN)))
    same(at("0", "marker-end"), composited_boxes((50, 75, 70, 85, GREEN)))
    same(at("auto", "marker-end"), composited_boxes((55, 70, 65, 90, GREEN)))
    same(at("90deg", "marker-mid"), composited_boxes((55, 10, 65, 30, GREEN)))
    middle = whole(
        '<rect x="-10" y="-5" width="20" height="10" fill="green" '
        'transform="translate(60 20) rotate(45)"/>'
    )
    same(at("auto", "marker-mid"), middle)
    # Markers are clipped; strokes may give them their color.
    lent = marker.replace('fill="green"', 'x="-9" width="99" fill="context-stroke"').replace(
        ' width="4" height="2" x', ' height="2" x'
    )
    actual = whole(lent.format("0") + line.format('stroke="green" marker-start'))
    same(actual[:, :18], composited_boxes((10, 15, 30, 25, GREEN))[:, :18])
