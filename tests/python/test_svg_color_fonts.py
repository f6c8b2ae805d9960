# SPDX-License-Identifier: GPL-3.0-or-later

"""Colored glyphs look the same as their layers written as elements."""

import base64
import itertools

import numpy as np
import prefilter
import pytest
from box_fonts import HIGH, UNITS, make_font
from drawings import SIZE, svg
from fontTools.colorLib.builder import buildCOLR, buildCPAL
from fontTools.ttLib import TTFont, newTable
from fontTools.ttLib.tables.BitmapGlyphMetrics import SmallGlyphMetrics
from fontTools.ttLib.tables.C_B_D_T_ import cbdt_bitmap_format_17
from fontTools.ttLib.tables.DefaultTable import DefaultTable
from fontTools.ttLib.tables.E_B_L_C_ import (
    BitmapSizeTable,
    SbitLineMetrics,
    Strike,
    eblc_index_sub_table_1,
)
from fontTools.ttLib.tables.sbixGlyph import Glyph
from fontTools.ttLib.tables.sbixStrike import Strike as SbixStrike
from prefilter.workflows.files import png

# The letter A is 600 x 500 units, V 400 x 500, and i 200 x 500. A unit is 0.1 with a size of 100.
A, V, SMALL_I = "uni0041", "uni0056", "uni0069"
PALETTE = [(1.0, 0.0, 0.0, 1.0), (0.0, 128 / 255, 0.0, 1.0), (0.0, 0.0, 1.0, 128 / 255)]
RED, GREEN, BLUE, TEXT = 0, 1, 2, 0xFFFF
LEFT, LINE = 20, 80


@pytest.fixture
def drawn(tmp_path):
    """Draws the letter A of a font with these layers, without warnings; row 0 is at the top."""

    def found(layers, more="", letters="A", version=None):
        path = colored(tmp_path / "font.ttf", layers, version)
        return image(text(letters, more), [path])

    return found


def colored(path, layers, version=None):
    font = TTFont(make_font(path, kerning=False))
    font["COLR"] = buildCOLR(
        layers if isinstance(layers, dict) and A in layers else {A: layers},
        version=version,
        glyphMap=font.getReverseGlyphMap(),
    )
    font["CPAL"] = buildCPAL([PALETTE])
    font.save(path)
    return path


def text(letters="A", more=""):
    return (
        f'<text font-family="Boxes" font-size="100" x="{LEFT}" y="{LINE}" {more}>{letters}</text>'
    )


def image(body, fonts=None, is_told=False, **options):
    result, warnings = prefilter.rasterize_svg(svg(body), SIZE, SIZE, fonts=fonts, **options)
    assert is_told or warnings == ()
    return (result[::-1], [str(each) for each in warnings]) if is_told else result[::-1]


def units(body):
    """Elements in font units, y upwards, at the letter's position."""
    return f'<g transform="translate({LEFT} {LINE}) scale(0.1 -0.1)">{body}</g>'


def box(width, fill, more="", high=HIGH):
    return f'<rect width="{width}" height="{high}" fill="{fill}" {more}/>'


def near(one, other):
    np.testing.assert_allclose(one, other, atol=2e-3)


def solid(index, alpha=1.0):
    return {"Format": 2, "PaletteIndex": index, "Alpha": alpha}


def glyph(name, paint):
    return {"Format": 10, "Glyph": name, "Paint": paint}


def stacked(*paints):
    return {"Format": 1, "Layers": list(paints)}


def moved(kind, paint, **values):
    return {"Format": kind, "Paint": paint, **values}


@pytest.mark.parametrize("light", ["srgb", "linear"])
def test_layers_of_one_color(tmp_path, light):
    path = colored(tmp_path / "font.ttf", [(A, RED), (V, BLUE), (SMALL_I, TEXT)], 0)
    actual = image(text("A", 'fill="#0f0"'), [path], light=light)
    boxes = box(600, "red") + box(400, "#00f", 'fill-opacity="0.50196"') + box(200, "#0f0")
    near(actual, image(units(boxes), light=light))


def test_layers_are_as_opaque_as_the_fill(drawn):
    layers = [(A, RED), (V, GREEN)]
    boxes = box(600, "red") + box(400, "green")
    near(drawn(layers, 'fill-opacity="0.5"'), image(f'<g opacity="0.5">{units(boxes)}</g>'))
    assert not drawn(layers, 'fill="none"').any()
    gradient = '<linearGradient id="g"><stop stop-color="red"/></linearGradient>'
    assert drawn(layers, 'fill="url(#none) blue"', "A" + gradient).any()


def test_letters_without_layers_have_the_color_of_the_text(drawn):
    actual = drawn([(SMALL_I, RED)], 'fill="blue" letter-spacing="-10"', "iA")
    near(
        actual,
        image(
            units(box(200, "blue")) + f'<g transform="translate(10)">{units(box(200, "red"))}</g>'
        ),
    )


def test_layers_are_clipped(tmp_path):
    clip = '<clipPath id="c"><rect x="30" y="40" width="20" height="20"/></clipPath>'
    letter = text("A", 'clip-path="url(#c)"')
    actual = image(clip + letter, [colored(tmp_path / "font.ttf", [(A, RED)])])
    near(actual, image('<rect x="30" y="40" width="20" height="20" fill="red"/>'))


def linear(x0, y0, x1, y1, x2, y2, stops=((0, RED), (1, GREEN)), extend=0):
    line = {
        "Extend": extend,
        "ColorStop": [{"StopOffset": at, "PaletteIndex": i, "Alpha": 1.0} for at, i in stops],
    }
    places = dict(zip(("x0", "y0", "x1", "y1", "x2", "y2"), (x0, y0, x1, y1, x2, y2), strict=True))
    return {"Format": 4, "ColorLine": line, **places}


def radial(numbers, stops=((0, RED), (1, GREEN)), extend=0):
    result = linear(0, 0, 0, 0, 0, 0, stops, extend)
    line = result["ColorLine"]
    names = ("x0", "y0", "r0", "x1", "y1", "r1")
    return {"Format": 6, "ColorLine": line, **dict(zip(names, numbers, strict=True))}


def svg_gradient(
    kind, numbers, stops='<stop stop-color="red"/><stop offset="1" stop-color="green"/>', more=""
):
    names = ("x1", "y1", "x2", "y2") if kind == "linear" else ("fx", "fy", "fr", "cx", "cy", "r")
    said = " ".join(f'{name}="{value}"' for name, value in zip(names, numbers, strict=True))
    return (
        f'<{kind}Gradient id="g" gradientUnits="userSpaceOnUse" {said} {more}>{stops}'
        f"</{kind}Gradient>"
    )


@pytest.mark.parametrize(
    ("paint", "gradient"),
    [
        # The third point is beside the first.
        (linear(100, 0, 400, 0, 100, 50), svg_gradient("linear", (100, 0, 400, 0))),
        # Color lines lead to the third point along (1, 1); colors change across them.
        (linear(0, 0, 400, 0, 100, 100), svg_gradient("linear", (0, 0, 200, -200))),
        (
            linear(100, 0, 200, 0, 100, 50, extend=1),
            svg_gradient("linear", (100, 0, 200, 0), more='spreadMethod="repeat"'),
        ),
        (
            linear(100, 0, 200, 0, 100, 50, extend=2),
            svg_gradient("linear", (100, 0, 200, 0), more='spreadMethod="reflect"'),
        ),
        # Stops that begin late and end early, or outside [0, 1].
        (
            linear(0, 0, 400, 0, 0, 50, ((0.25, RED), (0.75, GREEN))),
            svg_gradient("linear", (100, 0, 300, 0)),
        ),
        (
            linear(200, 0, 300, 0, 200, 50, ((-1, RED), (1.5, GREEN))),
            svg_gradient("linear", (100, 0, 350, 0)),
        ),
        (
            radial((300, 250, 0, 300, 250, 200)),
            svg_gradient("radial", (300, 250, 0, 300, 250, 200)),
        ),
        (
            radial((250, 250, 50, 300, 250, 200)),
            svg_gradient("radial", (250, 250, 50, 300, 250, 200)),
        ),
        # From the outer circle inwards.
        (
            radial((300, 250, 200, 250, 250, 50), ((0, GREEN), (1, RED))),
            svg_gradient("radial", (250, 250, 50, 300, 250, 200)),
        ),
        # End circle without a radius.
        (
            radial((300, 250, 200, 250, 250, 0), ((0, GREEN), (1, RED))),
            svg_gradient("radial", (250, 250, 0, 300, 250, 200)),
        ),
    ],
)
def test_gradients(drawn, paint, gradient):
    actual = drawn(glyph(A, paint))
    near(actual, image(gradient + units(box(600, "url(#g)"))))


@pytest.mark.parametrize(
    "paint",
    [
        radial((300, 250, 0, 100, 250, 0)),
        radial((300, 250, 100, 300, 250, 100)),
        radial((300, 250, 100, 300, 250, 200), ((-2, RED), (-1.5, GREEN))),
        radial((300, 250, 0, 300, 250, 200), ((0.5, RED), (0.5, GREEN))),
        linear(100, 0, 100, 0, 100, 50),
        linear(100, 0, 200, 0, 300, 0),
        linear(100, 0, 200, 0, 100, 50, ((0.5, RED),)),
    ],
)
def test_odd_gradients_are_drawn(drawn, paint):
    assert drawn(glyph(A, paint))[..., 3].sum() > 0.0


@pytest.mark.parametrize(
    ("kind", "values", "transform"),
    [
        (12, {"Transform": (0.5, 0.1, -0.2, 0.75, 100, 50)}, "matrix(0.5 0.1 -0.2 0.75 100 50)"),
        (14, {"dx": 100, "dy": -50}, "translate(100 -50)"),
        (16, {"scaleX": 0.5, "scaleY": 1.25}, "scale(0.5 1.25)"),
        (
            18,
            {"scaleX": 0.5, "scaleY": 1.25, "centerX": 100, "centerY": 200},
            "translate(100 200) scale(0.5 1.25) translate(-100 -200)",
        ),
        (20, {"scale": 0.5}, "scale(0.5)"),
        (
            22,
            {"scale": 0.5, "centerX": 100, "centerY": 200},
            "translate(100 200) scale(0.5) translate(-100 -200)",
        ),
        (24, {"angle": 45}, "rotate(45)"),
        (26, {"angle": 45, "centerX": 100, "centerY": 200}, "rotate(45 100 200)"),
        (28, {"xSkewAngle": 22.5, "ySkewAngle": 0}, "skewX(-22.5)"),
        (28, {"xSkewAngle": 0, "ySkewAngle": 22.5}, "skewY(22.5)"),
        (
            30,
            {"xSkewAngle": 22.5, "ySkewAngle": 0, "centerX": 100, "centerY": 200},
            "translate(100 200) skewX(-22.5) translate(-100 -200)",
        ),
    ],
)
def test_transforms(drawn, kind, values, transform):
    paint = linear(100, 0, 300, 0, 100, 50)
    gradient = svg_gradient("linear", (100, 0, 300, 0))
    # Transforms of the glyph, of the paint alone, and nested.
    whole = f'<g transform="{transform}">{box(400, "url(#g)")}</g>'
    near(drawn(moved(kind, glyph(V, paint), **values)), image(gradient + units(whole)))
    inner = svg_gradient("linear", (100, 0, 300, 0), more=f'gradientTransform="{transform}"')
    near(drawn(glyph(V, moved(kind, paint, **values))), image(inner + units(box(400, "url(#g)"))))
    both = moved(14, glyph(V, moved(kind, paint, **values)), dx=50, dy=20)
    shifted = f'<g transform="translate(50 20)">{box(400, "url(#g)")}</g>'
    near(drawn(both), image(inner + units(shifted)))


def test_glyphs_clip_their_paint(drawn):
    inside = stacked(glyph(A, solid(RED)), moved(14, glyph(A, solid(GREEN)), dx=100, dy=100))
    actual = drawn(glyph(V, inside))
    boxes = box(400, "red") + '<rect x="100" y="100" width="300" height="400" fill="green"/>'
    near(actual, image(units(boxes)))
    # Without a glyph, colors fill the clip.
    near(
        drawn(glyph(V, stacked(solid(RED), solid(BLUE)))),
        image(units(box(400, "red") + box(400, "blue", 'fill-opacity="0.50196"'))),
    )


def test_layers_may_be_other_glyphs(drawn):
    layers = {
        A: stacked({"Format": 11, "Glyph": V}, moved(14, {"Format": 11, "Glyph": V}, dx=300, dy=0)),
        V: glyph(SMALL_I, solid(GREEN)),
    }
    boxes = box(200, "green") + f'<g transform="translate(300)">{box(200, "green")}</g>'
    near(drawn(layers), image(units(boxes)))


@pytest.mark.parametrize("mode", ["multiply", "screen", "difference", "hue", "luminosity"])
def test_blend_modes(drawn, mode):
    name = {"hue": "hsl_hue", "luminosity": "hsl_luminosity"}.get(mode, mode)
    below, above = glyph(A, solid(RED)), glyph(V, solid(BLUE))
    actual = drawn(
        {"Format": 32, "SourcePaint": above, "CompositeMode": name, "BackdropPaint": below}
    )
    blended = box(400, "blue", f'fill-opacity="0.50196" style="mix-blend-mode:{mode}"')
    near(actual, image(units(box(600, "red") + blended)))


@pytest.mark.parametrize(
    ("mode", "boxes"),
    [
        ("clear", ""),
        ("src", box(400, "blue", 'fill-opacity="0.50196"')),
        ("dest", box(600, "red")),
        ("src_over", box(600, "red") + box(400, "blue", 'fill-opacity="0.50196"')),
        ("dest_over", box(600, "red")),
        ("src_in", box(400, "blue", 'fill-opacity="0.50196"')),
        ("dest_in", box(400, "red", 'fill-opacity="0.50196"')),
    ],
)
def test_composites(drawn, mode, boxes):
    below, above = glyph(A, solid(RED)), glyph(V, solid(BLUE))
    paint = {"Format": 32, "SourcePaint": above, "CompositeMode": mode, "BackdropPaint": below}
    near(drawn(paint), image(units(boxes)))


@pytest.mark.parametrize(
    ("paint", "words"),
    [
        (
            {
                "Format": 8,
                "ColorLine": linear(0, 0, 0, 0, 0, 0)["ColorLine"],
                "centerX": 0, "centerY": 0, "startAngle": 0, "endAngle": 90,
            },
            "sweep gradients",
        ),
        (
            {
                "Format": 32,
                "SourcePaint": solid(RED), "CompositeMode": "xor", "BackdropPaint": solid(RED),
            },
            "composite mode",
        ),
        ({"Format": 11, "Glyph": A}, "too many layers"),
        ({"Format": 11, "Glyph": V}, "not there"),
    ],
)  # fmt: skip
def test_unsupported_paints_cause_one_warning(tmp_path, paint, words):
    path = colored(tmp_path / "font.ttf", paint)
    actual, (warning,) = image(text("A"), [path], is_told=True)
    assert "font 'Boxes': drawn without its colors" in warning
    assert words in warning
    # The glyph itself remains.
    near(actual, image(units(box(600, "black"))))


def test_exponential_layers_are_limited(tmp_path):
    """Thirty levels, each with two references to the next."""
    names = [A, V, SMALL_I, "space"]
    layers = {
        name: stacked({"Format": 11, "Glyph": after}, {"Format": 11, "Glyph": after})
        for name, after in itertools.pairwise(names)
    }
    inner = glyph(SMALL_I, solid(RED))
    for _ in range(13):
        inner = stacked(inner, inner)
    path = colored(tmp_path / "font.ttf", {**layers, "space": inner})
    _, (warning,) = image(text("A"), [path], is_told=True)
    assert "too many layers" in warning


def test_damaged_tables_are_named(tmp_path):
    font = TTFont(make_font(tmp_path / "plain.ttf"))
    for tag in ("COLR", "CBDT", "sbix", "SVG "):
        for data in (bytes(14), b"\x00\x01" + bytes(40), b"\xff" * 60, b""):
            font[tag] = DefaultTable(tag)
            font[tag].data = data
            font.save(tmp_path / "colored.ttf")
            actual, _ = image(text("A"), [tmp_path / "colored.ttf"], is_told=True)
            near(actual, image(units(box(600, "black"))))
            del font[tag]


def picture(width=6, height=5):
    texels = np.zeros((height, width, 4), np.uint8)
    texels[..., 0] = np.arange(width) * 40
    texels[..., 1] = np.arange(height)[:, None] * 50
    texels[..., 3] = 255
    texels[0, 0, 3] = 100
    return as_png(texels)


def as_png(texels):
    return png.encoded(texels[::-1])


def embedded(x, y, width, height):
    data = base64.b64encode(picture()).decode()
    return (
        f'<image x="{x}" y="{y}" width="{width}" height="{height}" '
        f'preserveAspectRatio="none" href="data:image/png;base64,{data}"/>'
    )


def with_sbix(path):
    font = TTFont(make_font(path, kerning=False))
    font["sbix"] = newTable("sbix")
    for ppem in (10, 20):
        strike = font["sbix"].strikes[ppem] = SbixStrike(ppem=ppem)
        data = picture() if ppem == 20 else as_png(np.zeros((2, 2, 4), np.uint8))
        strike.glyphs[A] = Glyph(A, None, 2, 1, "png ", data)
        strike.glyphs[V] = Glyph(V, A, 0, 0, "dupe")
    font.save(path)
    return path


LINE_METRICS = (
    "ascender descender widthMax caretSlopeNumerator caretSlopeDenominator caretOffset "
    "minOriginSB minAdvanceSB maxBeforeBL minAfterBL pad1 pad2"
)


def with_cbdt(path):
    font = TTFont(make_font(path, kerning=False))
    font["CBDT"], font["CBLC"] = newTable("CBDT"), newTable("CBLC")
    font["CBDT"].version = font["CBLC"].version = 3.0
    one = cbdt_bitmap_format_17(b"", font)
    one.imageData, one.metrics = picture(), SmallGlyphMetrics()
    for name, value in (
        ("height", 5),
        ("width", 6),
        ("BearingX", 2),
        ("BearingY", 6),
        ("Advance", 12),
    ):
        setattr(one.metrics, name, value)
    font["CBDT"].strikeData = [{A: one}]
    strike, part = Strike(), eblc_index_sub_table_1(b"", font)
    strike.bitmapSizeTable = size = BitmapSizeTable()
    for name in ("hori", "vert"):
        metrics = SbitLineMetrics()
        for key in LINE_METRICS.split():
            setattr(metrics, key, 0)
        setattr(size, name, metrics)
    size.colorRef = size.flags = 0
    size.startGlyphIndex = size.endGlyphIndex = font.getGlyphID(A)
    size.ppemX = size.ppemY = 20
    size.bitDepth = 32
    part.indexFormat, part.imageFormat, part.names = 1, 17, [A]
    part.firstGlyphIndex = part.lastGlyphIndex = font.getGlyphID(A)
    strike.indexSubTables = [part]
    font["CBLC"].strikes = [strike]
    # Bitmap fonts have no outlines.
    for tag in ("glyf", "loca"):
        del font[tag]
    font.save(path)
    return path


@pytest.mark.parametrize("make", [with_sbix, with_cbdt])
def test_bitmap_glyphs(tmp_path, make):
    """Six pixels at 20 per em are 0.3 em; the lowest row is one pixel above the baseline."""
    actual = image(text("A"), [make(tmp_path / "font.ttf")])
    side = 100 / 20
    near(actual, image(embedded(LEFT + 2 * side, LINE - 6 * side, 6 * side, 5 * side)))


def test_duplicate_bitmaps(tmp_path):
    path = with_sbix(tmp_path / "font.ttf")
    near(image(text("V"), [path]), image(text("A"), [path]))


def test_bitmaps_are_decoded_and_counted_once(tmp_path, monkeypatch):
    path = with_sbix(tmp_path / "font.ttf")
    monkeypatch.setattr("prefilter.shapes._svg.model.limits.MAX_TEXELS", 40)
    assert image(text("AAAA", 'style="font-size:20px"'), [path]).any()
    monkeypatch.setattr("prefilter.shapes._svg.model.limits.MAX_TEXELS", 20)
    with pytest.raises(ValueError, match="images of more than 20 pixels"):
        image(text("A"), [path])


def test_bitmaps_have_the_advance_of_their_font(tmp_path):
    path = with_cbdt(tmp_path / "font.ttf")
    actual = image(text('A<tspan fill="red">A</tspan>', 'style="font-size:50px"'), [path])
    one = embedded(LEFT + 5, LINE - 15, 15, 12.5)
    other = embedded(LEFT + 5 + 0.6 * 50, LINE - 15, 15, 12.5)
    near(actual, image(one + other))


def test_damaged_bitmaps_are_left_out(tmp_path):
    path = with_sbix(tmp_path / "font.ttf")
    font = TTFont(path)
    font["sbix"].strikes[20].glyphs[A].imageData = picture()[:40]
    font.save(path)
    actual, (warning,) = image(text("A"), [path], is_told=True)
    assert not actual.any()
    assert "letter: left out" in warning


def test_color_fonts_come_first_for_emoji_only(tmp_path):
    plain = make_font(tmp_path / "a.ttf", "Plain", widths={"\U0001f600": 600, "1": 600})
    emoji = make_font(tmp_path / "b.ttf", "Emoji", widths={"\U0001f600": 200, "1": 200})
    actual = TTFont(emoji)
    actual["COLR"] = buildCOLR({"uni1F600": [("uni1F600", RED)]}, version=0)
    actual["CPAL"] = buildCPAL([PALETTE])
    actual.save(emoji)
    for order in ([plain, emoji], [emoji, plain]):
        fonts = [make_font(tmp_path / "c.ttf"), *order]
        near(image(text("\U0001f600"), fonts), image(units(box(200, "red"))))
        near(image(text("1"), fonts), image(units(box(600, "black"))))
    assert UNITS == 1000
