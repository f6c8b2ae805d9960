# SPDX-License-Identifier: GPL-3.0-or-later

"""Filters against closed forms, and against equivalent drawings."""

import math

import numpy as np
import prefilter
import pytest
from drawings import SIZE, same, svg

WIDE = 'filterUnits="userSpaceOnUse" x="-50" y="-50" width="200" height="200"'
AS_ENCODED = 'color-interpolation-filters="sRGB"'


def drawn(steps, element, rest=f"{WIDE} {AS_ENCODED}", **options):
    """Draws elements with a filter; row 0 is at the top."""
    body = f'<filter id="f" {rest}>{steps}</filter>{element}'
    result, warnings = prefilter.rasterize_svg(svg(body), SIZE, SIZE, **options)
    assert warnings == ()
    return result[::-1]


def box(left, top, right, bottom, rest='filter="url(#f)"'):
    return f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" {rest}/>'


def plain(element):
    return drawn("", element)


BOX = box(30, 20, 60, 50)


def test_an_offset_moves():
    for matrix in ("", "scale(2)", "rotate(90 50 50)", "translate(-5 9)"):
        around = f'<g transform="{matrix}">{{}}</g>'
        actual = drawn('<feOffset dx="10" dy="-5.5"/>', around.format(BOX))
        same(actual, plain(around.format(box(40, 14.5, 70, 44.5, ""))))
    shares = drawn('<feOffset dx="0.5"/>', BOX, f'{WIDE} primitiveUnits="objectBoundingBox"')
    same(shares, plain(box(45, 20, 75, 50, "")))


@pytest.mark.parametrize("deviation", [0.5, 1.5, 1.9])
def test_small_blurs_are_gaussian(deviation):
    """A Gaussian turns an edge into its integral."""
    actual = drawn(f'<feGaussianBlur stdDeviation="{deviation} 0"/>', box(-99, -99, 50, 199))
    for x in range(40, 60):
        # The weights at whole pixels that reach the edge add up.
        distances = np.arange(-20, 21)
        weights = np.exp(-(distances**2) / (2 * deviation**2))
        expected = weights[distances <= 49 - x].sum() / weights.sum()
        assert actual[50, x, 3] == pytest.approx(expected, abs=1e-4)
    if deviation < 1:
        return
    middle = actual[50, 30:70, 3].astype(float)
    exact = [0.5 * math.erfc((x + 0.5 - 50) / deviation / math.sqrt(2)) for x in range(30, 70)]
    np.testing.assert_allclose(middle, exact, atol=0.02)


@pytest.mark.parametrize("deviation", [2.0, 3.1, 5.0, 8.3])
def test_large_blurs_are_box_blurs(deviation):
    actual = drawn(f'<feGaussianBlur stdDeviation="0 {deviation}"/>', box(0, 40, 100, 55))
    count = math.floor(deviation * 3 * math.sqrt(2 * math.pi) / 4 + 0.5)
    line = np.zeros(200)
    line[90:105] = 1
    shifts = (0, 0, 0) if count % 2 else (0, 1, 0)
    sizes = (count,) * 3 if count % 2 else (count, count, count + 1)
    for size, shift in zip(sizes, shifts, strict=True):
        full = np.convolve(line, np.ones(size) / size)
        begin = (size - 1) // 2 + shift
        line = full[begin : begin + 200]
    np.testing.assert_allclose(actual[:, 50, 3], line[50:150], atol=1e-6)
    # It approximates a Gaussian, with the same center and sum.
    places = np.arange(100) + 0.5
    assert actual[:, 50, 3].sum() == pytest.approx(15, rel=1e-3)
    assert (places * actual[:, 50, 3]).sum() / 15 == pytest.approx(47.5, abs=0.05)


def test_flat_colors_survive_decoding():
    element = box(0, 0, 100, 100, 'fill="#4080c0" filter="url(#f)"')
    for light in ("srgb", "linear"):
        for space in ("sRGB", "linearRGB"):
            rest = f'{WIDE} color-interpolation-filters="{space}"'
            same(
                drawn("<feOffset/>", element, rest, light=light),
                drawn("", element.replace("filter=", "id="), light=light),
            )


def test_primitives_work_on_decoded_colors():
    half = '<feComponentTransfer><feFuncG type="linear" slope="0.5"/></feComponentTransfer>'
    element = box(0, 0, 100, 100, 'fill="white" filter="url(#f)"')
    as_light = float(prefilter.to_srgb([[0.5]])[0, 0])
    assert drawn(half, element)[50, 50, 1] == pytest.approx(0.5, abs=1e-5)
    assert drawn(half, element, WIDE)[50, 50, 1] == pytest.approx(as_light, abs=1e-5)
    assert drawn(half, element, WIDE, light="linear")[50, 50, 1] == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize(
    ("operator", "shares"),
    [
        ("over", lambda a, b: (1, 1 - a)),
        ("in", lambda a, b: (b, 0)),
        ("out", lambda a, b: (1 - b, 0)),
        ("atop", lambda a, b: (b, 1 - a)),
        ("xor", lambda a, b: (1 - b, 1 - a)),
        ("lighter", lambda a, b: (1, 1)),
        ('arithmetic" k2="0.5" k3="0.25', lambda a, b: (0.5, 0.25)),
    ],
)
def test_composites(operator, shares):
    """Red with alpha 0.6 over blue with alpha 0.2."""
    flood = '<feFlood flood-color="{}" flood-opacity="{}" result="{}"/>'
    steps = flood.format("red", 0.6, "a") + flood.format("blue", 0.2, "b")
    steps += f'<feComposite in="a" in2="b" operator="{operator}"/>'
    red, blue = shares(0.6, 0.2)
    expected = (0.6 * red, 0, 0.2 * blue, 0.6 * red + 0.2 * blue)
    np.testing.assert_allclose(drawn(steps, BOX)[50, 50], expected, atol=1e-6)


def test_drop_shadow_equals_its_primitives():
    shadow = '<feDropShadow dx="7" dy="4" stdDeviation="3" flood-color="teal" flood-opacity="0.7"/>'
    steps = (
        '<feGaussianBlur in="SourceAlpha" stdDeviation="3"/><feOffset dx="7" dy="4" result="o"/>'
        '<feFlood flood-color="teal" flood-opacity="0.7"/><feComposite in2="o" operator="in"/>'
        '<feMerge><feMergeNode/><feMergeNode in="SourceGraphic"/></feMerge>'
    )
    element = BOX.replace("<rect", '<rect fill="orange"')
    for rest in (f"{WIDE} {AS_ENCODED}", WIDE):
        same(drawn(shadow, element, rest), drawn(steps, element, rest))


def test_color_matrices():
    element = box(0, 0, 100, 100, 'fill="rgb(51,102,204)" filter="url(#f)"')
    color = np.array([51, 102, 204]) / 255

    def with_matrix(attributes):
        return drawn(f"<feColorMatrix {attributes}/>", element)[50, 50]

    np.testing.assert_allclose(with_matrix(""), (*color, 1), atol=1e-6)
    np.testing.assert_allclose(with_matrix('type="hueRotate" values="0"'), (*color, 1), atol=1e-6)
    gray = color @ (0.213, 0.715, 0.072)
    np.testing.assert_allclose(
        with_matrix('type="saturate" values="0"'), (gray, gray, gray, 1), atol=1e-6
    )
    np.testing.assert_allclose(with_matrix('type="luminanceToAlpha"'), (0, 0, 0, gray), atol=1e-6)
    # Four rotations by 90 degrees restore colors, except for clamping to [0, 1].
    turned = with_matrix('type="hueRotate" values="90"')[:3]
    assert turned @ (0.213, 0.715, 0.072) == pytest.approx(gray, abs=2e-3)
    swapped = with_matrix('values="0 1 0 0 0  0 0 1 0 0  1 0 0 0 0  0 0 0 .5 .25"')
    np.testing.assert_allclose(swapped, (*(color[[1, 2, 0]] * 0.75), 0.75), atol=1e-6)


def test_component_transfers():
    element = box(0, 0, 100, 100, 'fill="rgb(51,102,204)" filter="url(#f)"')
    steps = (
        '<feComponentTransfer><feFuncR type="table" tableValues="1 0"/>'
        '<feFuncG type="discrete" tableValues="0.1 0.9 0.5"/><feFuncB type="table" '
        'tableValues="0 1 0"/><feFuncA type="linear" slope="0.25" intercept="0.25"/>'
        "</feComponentTransfer>"
    )
    expected = np.array([0.8, 0.9, 0.4, 1]) * 0.5
    np.testing.assert_allclose(drawn(steps, element)[50, 50], expected, atol=1e-6)


def test_filter_regions_and_subregions():
    flood = '<feFlood flood-color="black" {}/>'
    # The default region is a tenth larger than the box on each side.
    same(drawn(flood.format(""), BOX, ""), plain(box(27, 17, 63, 53, "")))
    step = flood.format('x="20" y="30" width="10" height="99"')
    same(drawn(step, BOX, WIDE), plain(box(20, 30, 30, 129, "")))
    shares = flood.format('x="0.5" width="0.5"')
    rest = 'primitiveUnits="objectBoundingBox"'
    same(drawn(shares, BOX, rest), plain(box(45, 17, 60, 53, "")))


def test_clip_paths_masks_and_opacity_come_after_filters():
    clip = f'<clipPath id="c">{box(0, 0, 45.5, 99, "")}</clipPath>'
    move = '<feOffset dx="20"/>'
    actual = drawn(
        move, f'{clip}<g clip-path="url(#c)" filter="url(#f)">{box(10, 10, 60, 60, "")}</g>'
    )
    same(actual, plain(box(30, 10, 45.5, 60, "")))
    # A clip path inside the group precedes the filter.
    actual = drawn(move, f'{clip}<g filter="url(#f)">{box(10, 10, 60, 60, clip_path("c"))}</g>')
    same(actual, plain(box(30, 10, 65.5, 60, "")))
    mask = f'<mask id="c" {WIDE.replace("filter", "mask")}>{box(0, 0, 45, 99, FILL)}</mask>'
    actual = drawn(move, f'{mask}<g mask="url(#c)" filter="url(#f)">{box(10, 10, 60, 60, "")}</g>')
    same(actual, plain(box(30, 10, 45, 60, "")))
    actual = drawn(move, f'<g opacity="0.2" filter="url(#f)">{box(10, 10, 60, 60, "")}</g>')
    same(actual, plain(box(30, 10, 80, 60, "")) * np.float32(0.2))


FILL = 'fill="white"'


def clip_path(name):
    return f'clip-path="url(#{name})"'


def test_unsupported_filters_cause_one_warning():
    body = f'<filter id="f"><feOffset in="FillPaint" dx="5"/></filter>{BOX}{BOX}'
    actual, (warning,) = prefilter.rasterize_svg(svg(body), SIZE, SIZE)
    words = "FillPaint: replaced by the result before it (first in line 1, 2 times)"
    assert str(warning) == words
    same(actual[::-1], drawn('<feOffset dx="5"/>', BOX, ""))
    body = f'<filter id="f"><feWarp/></filter>{BOX}'
    actual, (warning,) = prefilter.rasterize_svg(svg(body), SIZE, SIZE)
    assert str(warning) == "filter with <feWarp>: ignored (in line 1)"
    same(actual[::-1], plain(box(30, 20, 60, 50, "")))
    assert prefilter.read_svg(svg(f"<filter id='f'><feOffset/></filter>{BOX}")).warnings


@pytest.mark.parametrize(
    "steps",
    [
        "",
        '<feGaussianBlur stdDeviation="1e9"/>',
        '<feGaussianBlur stdDeviation="-1"/><feOffset dx="1e300" dy="nan"/>',
        '<feMerge/><feComposite in="x" in2="y" operator="arithmetic" k1="1e300" k4="-1e300"/>',
        '<feColorMatrix values="1e300"/><feColorMatrix type="hueRotate" values="1e300"/>',
        '<feComponentTransfer><feFuncR type="table" tableValues=""/><feFuncG type="table"/>'
        '<feFuncB type="discrete" tableValues="2"/></feComponentTransfer>',
        '<feFlood x="1e9" width="-1" height="1e300" flood-color="none" flood-opacity="9"/>',
        '<feDropShadow stdDeviation="1 2 3" dx="x"/><feBlend mode="hue" in="SourceAlpha"/>',
    ],
    ids=lambda steps: steps[:30],
)
def test_odd_filters(steps):
    for rest in ("", WIDE, 'width="1e9" height="1e9"', 'width="0"'):
        body = f'<filter id="f" {rest}>{steps}</filter>{BOX}'
        actual, _ = prefilter.rasterize_svg(svg(body), 16, 16)
        assert np.isfinite(actual).all()
    if not steps:
        assert not actual.any()
