# SPDX-License-Identifier: GPL-3.0-or-later

"""Text, with a font whose letters are boxes, so that all positions are known."""

import base64
import io
import itertools
import tracemalloc
import unicodedata

import numpy as np
import prefilter
import pytest
from box_fonts import KERNING, UNITS, WIDTHS, make_font, make_variable
from drawings import SIZE, read, svg
from fontTools.ttLib import TTFont

try:
    import brotli
except ImportError:
    brotli = None


@pytest.fixture(scope="module")
def font(tmp_path_factory):
    return make_font(tmp_path_factory.mktemp("fonts") / "boxes.ttf")


@pytest.fixture
def boxes(font):
    """Returns the boxes of a drawing's shapes: left, top, right, bottom, y downwards."""

    def found(body, fonts=None):
        drawing = read(body, fonts=[font] if fonts is None else fonts)
        assert drawing.warnings == ()
        result = []
        for shape in drawing.shapes_for(SIZE, SIZE):
            (left, low), (right, high) = shape.bounds
            result.append((left, SIZE - high, right, SIZE - low))
        return result

    return found


def text(content, more="", size=10):
    return f'<text font-family="Boxes" font-size="{size}" x="20" y="50" {more}>{content}</text>'


def near(found, expected):
    np.testing.assert_allclose(found, expected, atol=1e-4)


def advance(letters, size=10, kerning=True):
    total = sum(WIDTHS[letter] for letter in letters)
    pairs = sum(KERNING.get(pair, 0) for pair in itertools.pairwise(letters)) if kerning else 0
    return (total + pairs) * size / UNITS


@pytest.mark.parametrize("is_cff", [False, True])
def test_letters_follow_advances(tmp_path, boxes, is_cff):
    path = make_font(tmp_path / "font.otf", is_cff=is_cff)
    (one,) = boxes(text("AiV A"), [path])
    near(one, (20, 45, 20 + advance("AiV A"), 50))


def test_pairs_are_kerned(boxes):
    near(boxes(text("AV"))[0][2], 20 + 9.0)
    near(boxes(text("AV", 'style="font-kerning: none"'))[0][2], 20 + 10.0)


def test_without_harfbuzz_pairs_are_kerned_too(boxes, monkeypatch):
    from prefilter.shapes._fonts import shaping

    monkeypatch.setattr(shaping, "uharfbuzz", None)
    near(boxes(text("AV"))[0][2], 20 + 9.0)
    near(boxes(text("AiA"))[0][2], 20 + 14.0)


@pytest.mark.parametrize(("anchor", "share"), [("start", 0.0), ("middle", 0.5), ("end", 1.0)])
def test_anchors(boxes, anchor, share):
    ((left, _, right, _),) = boxes(text("AiA", f'text-anchor="{anchor}"'))
    near((left, right), (20 - 14 * share, 34 - 14 * share))


def test_positions_start_chunks_with_their_own_anchor(boxes):
    (one,) = boxes('<text font-family="Boxes" font-size="10" y="50 60" x="20 70">AA</text>')
    near(one, (20, 45, 76, 60))
    (one,) = boxes(
        '<text font-family="Boxes" font-size="10" x="20 70" y="50" text-anchor="middle">AA</text>'
    )
    near(one, (17, 45, 73, 50))


def test_offsets_add_up(boxes):
    (one,) = boxes(text("AA", 'dx="5 10" dy="1 2"'))
    near(one, (25, 46, 47, 53))


def test_positions_of_nested_elements(boxes):
    first, second = boxes(text('A<tspan fill="red" x="60">A</tspan>', 'dx="0 3"'))
    near(first, (20, 45, 26, 50))
    near(second, (63, 45, 69, 50))


def test_the_last_rotation_applies_to_the_rest(boxes):
    (one,) = boxes(text("iii", 'rotate="0 90"'))
    # Rotated to the right: the top of the letter is now on its right.
    near(one, (20, 45, 29, 52))


def test_letter_and_word_spacing(boxes):
    near(boxes(text("AiA", 'letter-spacing="4"'))[0][2], 20 + 14 + 8)
    near(boxes(text("A A", 'word-spacing="1em"'))[0][2], 20 + 14.5 + 10)
    # Centered without spacing after the last letter.
    ((left, _, right, _),) = boxes(text("AA", 'letter-spacing="4" text-anchor="middle"'))
    near(left + right, 40)


@pytest.mark.parametrize(("adjust", "width"), [("spacing", 6), ("spacingAndGlyphs", 6 * 30 / 14)])
def test_text_length(boxes, adjust, width):
    drawn = boxes(text('A<tspan fill="red">iA</tspan>', f'textLength="30" lengthAdjust="{adjust}"'))
    near((drawn[0][0], drawn[0][2], drawn[1][2]), (20, 20 + width, 50))


@pytest.mark.parametrize(
    ("baseline", "down"),
    [
        *(("alphabetic", 0.0), ("middle", 2.0), ("central", 3.0), ("hanging", 6.4)),
        *(("text-before-edge", 8.0), ("text-after-edge", -2.0), ("mathematical", 4.0)),
    ],
)
def test_baselines(boxes, baseline, down):
    near(boxes(text("A", f'dominant-baseline="{baseline}"'))[0], (20, 45 + down, 26, 50 + down))


@pytest.mark.parametrize(
    ("shift", "up"), [("super", 5.0), ("sub", -5.0), ("4", 4.0), ("-50%", -5.0), ("baseline", 0.0)]
)
def test_baseline_shift(boxes, shift, up):
    outer, inner = boxes(text(f'A<tspan fill="red" baseline-shift="{shift}">A</tspan>'))
    near((outer[3], inner[3]), (50, 50 - up))


def test_shifts_of_nested_elements_add_up(boxes):
    inner = '<tspan baseline-shift="2"><tspan baseline-shift="3">A</tspan></tspan>'
    near(boxes(text(inner))[0][3], 45)
    # Shifts of ancestors add up, as in browsers.
    near(boxes(text(inner, 'baseline-shift="1"'))[0][3], 44)


@pytest.mark.parametrize(
    ("line", "top", "bottom"),
    [("underline", 50.5, 51.5), ("overline", 41, 42), ("line-through", 46.8333, 47.8333)],
)
def test_decorations(boxes, line, top, bottom):
    drawn = boxes(text("A A", f'text-decoration="{line}"'))
    letters, drawn_line = drawn if line == "line-through" else drawn[::-1]
    near(letters, (20, 45, 34.5, 50))
    near(drawn_line, (20, top, 34.5, bottom))


def test_decorations_have_the_paint_of_their_element(font):
    body = text('<tspan fill="lime">A</tspan>', 'text-decoration="underline" fill="red"')
    line, letters = read(body, fonts=[font]).shapes
    assert line.color == (1.0, 0.0, 0.0, 1.0)
    assert letters.color == (0.0, 1.0, 0.0, 1.0)


def test_text_runs_along_a_path(boxes):
    path = '<path id="p" fill="none" d="M 10 20 V 90"/>'
    (one,) = boxes(
        path + '<text font-family="Boxes" font-size="10">'
        '<textPath href="#p" startOffset="50%">Ai</textPath></text>'
    )
    # Downwards from the middle of the path, with letters on its right.
    near(one, (10, 55, 15, 63))


def test_text_around_a_circle(boxes):
    body = '<path id="p" fill="none" d="M 20 50 A 30 30 0 0 1 80 50"/>'
    (one,) = boxes(
        body + '<text font-family="Boxes" font-size="10" text-anchor="middle">'
        '<textPath href="#p" startOffset="50%">A</textPath></text>'
    )
    # At the top of the circle, horizontal, outside.
    near(one, (47, 15, 53, 20))


def test_letters_beyond_the_path_are_not_drawn(boxes):
    body = '<path id="p" fill="none" d="M 0 50 H 8"/><text font-family="Boxes" font-size="10">'
    (one,) = boxes(body + '<textPath href="#p">iiAAAAAAAA</textPath></text>')
    # The centers of both letters are at 7 and 13.
    near(one, (0, 45, 10, 50))


@pytest.mark.parametrize(
    ("content", "more", "letters"),
    [
        ("  A \n\t A  ", "", "A A"),
        (" A  A ", 'xml:space="preserve"', "  A  A"),
        ("A\nA", 'style="white-space: pre"', "A A"),
    ],
)
def test_spaces(boxes, content, more, letters):
    lead = advance(letters[: len(letters) - len(letters.lstrip())])
    if more.startswith("xml"):
        lead = advance(" ")
        letters = " A  A"
    ((left, _, right, _),) = boxes(text(content, more))
    near((left, right), (20 + lead, 20 + advance(letters)))


def test_hebrew_is_right_to_left(font):
    # aleph (300), bet (500): aleph is on the right. Colors tell them apart.
    body = text('<tspan fill="red">\u05d0</tspan><tspan fill="lime">\u05d1</tspan>')
    first, second = (shape.bounds for shape in read(body, fonts=[font]).shapes)
    near((second[0][0], second[1][0], first[0][0], first[1][0]), (20, 25, 25, 28))


def test_text_from_right_to_left_begins_on_the_right(boxes):
    ((left, _, right, _),) = boxes(text("\u05d0\u05d1", 'direction="rtl"'))
    near((left, right), (12, 20))


def test_font_matching(tmp_path):
    high = {}
    fonts = []
    for number, (weight, italic, stretch) in enumerate(
        [(300, False, 5), (400, False, 5), (700, False, 5), (400, True, 5), (400, False, 3)]
    ):
        high[weight, italic, stretch] = 100 * (number + 1)
        path = tmp_path / f"{number}.ttf"
        fonts.append(
            make_font(path, weight=weight, italic=italic, stretch=stretch, high=100 * (number + 1))
        )

    def chosen(**style):
        more = " ".join(f'{name.replace("_", "-")}="{value}"' for name, value in style.items())
        (shape,) = read(text("A", more), fonts=fonts).shapes_for(SIZE, SIZE)
        return round((shape.bounds[1][1] - shape.bounds[0][1]) * 100)

    assert chosen() == high[400, False, 5]
    assert chosen(font_weight="500") == high[400, False, 5]
    assert chosen(font_weight="600") == high[700, False, 5]
    assert chosen(font_weight="100") == high[300, False, 5]
    assert chosen(font_style="oblique") == high[400, True, 5]
    assert chosen(font_style="italic", font_weight="bold") == high[400, True, 5]
    assert chosen(font_stretch="condensed") == high[400, False, 3]
    assert chosen(font_stretch="expanded") == high[400, False, 5]
    bolder = text('<tspan font-weight="bolder">A</tspan>')
    (shape,) = read(bolder, fonts=fonts).shapes_for(SIZE, SIZE)
    assert round((shape.bounds[1][1] - shape.bounds[0][1]) * 100) == high[700, False, 5]


def test_missing_fonts_are_replaced_with_a_warning(font):
    drawing = read('<text font-family="Nowhere, \'Not There\'" y="50">A</text>', fonts=[font])
    assert len(drawing.shapes) == 1
    assert [warning.name for warning in drawing.warnings] == ["font 'Nowhere'", "font 'Not There'"]
    assert drawing.warnings[0].effect == "drawn in Boxes"


def test_fallback_fonts_and_missing_characters(tmp_path, font):
    other = make_font(tmp_path / "other.ttf", family="Other", widths={"Q": 700})
    drawing = read(text("AQ\u4e00"), fonts=[font, other])
    assert [(one.name, one.effect) for one in drawing.warnings] == [
        ("character U+4E00", "left out, as no font has it")
    ]
    (left, _), (right, _) = drawing.shapes_for(SIZE, SIZE)[0].bounds
    near((left, right), (20, 33))


def test_gradients_of_text_use_glyph_cells(font):
    gradient = '<linearGradient id="g" x2="0" y2="1"><stop stop-color="#000"/>'
    gradient += '<stop offset="1" stop-color="#fff"/></linearGradient>'
    drawing = read(gradient + text("A", 'fill="url(#g)"', size=20), fonts=[font])
    image = prefilter.rasterize(drawing.shapes_for(SIZE, SIZE), SIZE, SIZE)[::-1]
    # The cell is 20 high, from 34 to 54; the letter in it goes from 40 to 50.
    rows = np.arange(41, 49)
    near(image[rows, 25, 0], (rows + 0.5 - 34.0) / 20.0)


def test_text_clips_and_is_clipped(font):
    body = f'<clipPath id="c">{text("AA", size=40)}</clipPath>'
    body += '<rect width="100" height="100" fill="red" clip-path="url(#c)"/>'
    image, warnings = prefilter.rasterize_svg(svg(body), SIZE, SIZE, fonts=[font])
    assert warnings == ()
    near(image[..., 3].sum(), 48 * 20)
    body = '<clipPath id="c"><rect x="20" y="40" width="3" height="20"/></clipPath>'
    body += text("A", 'clip-path="url(#c)"')
    image, warnings = prefilter.rasterize_svg(svg(body), SIZE, SIZE, fonts=[font])
    near(image[..., 3].sum(), 3 * 5)


def test_weights_of_variable_fonts(tmp_path):
    path = make_variable(tmp_path / "variable.ttf")
    for weight, width in ((100, 200), (400, 400), (900, 900), (650, 650), (1000, 900)):
        (shape,) = read(text("A", f'font-weight="{weight}"'), fonts=[path]).shapes_for(SIZE, SIZE)
        near(shape.bounds[1][0] - shape.bounds[0][0], width / 100.0)
    more = "style=\"font-variation-settings: 'wght' 900\""
    (shape,) = read(text("A", more), fonts=[path]).shapes_for(SIZE, SIZE)
    near(shape.bounds[1][0] - shape.bounds[0][0], 9.0)


def test_too_much_text_is_refused(font):
    body = f'<defs><text id="t">{"A" * 1000}</text></defs>' + '<use href="#t"/>' * 300
    with pytest.raises(ValueError, match="more than 100000 characters"):
        read(body, fonts=[font])


@pytest.mark.parametrize(
    "body",
    [
        "<text/>",
        "<text>   </text>",
        '<text font-size="0">A</text>',
        '<text x="nan" y="1e999" dx="q">A</text>',
        '<text rotate="x">A</text>',
        '<text textLength="-5">A</text>',
        '<text textLength="0" lengthAdjust="spacingAndGlyphs">A</text>',
        '<text><textPath href="#nowhere">A</textPath></text>',
        '<text><textPath path="M 0 0">A</textPath></text>',
        '<path id="p" d="M 5 5 H 5"/><text><textPath href="#p">A</textPath></text>',
        "<text>" + "<tspan>" * 240 + "A" + "</tspan>" * 240 + "</text>",
        '<text font-family=", ,">A</text>',
        '<text font-size="1e30">A</text>',
        "<text>\ud83d\ude00\u200d\u0301</text>",
        '<text letter-spacing="-1000">AAA</text>',
    ],
)
def test_nasty_text_is_drawn_or_left_out(font, body):
    drawing = read(body, fonts=[font])
    prefilter.rasterize(drawing.shapes_for(SIZE, SIZE), SIZE, SIZE)


@pytest.mark.parametrize("fonts", ["no list", 5, [5], ["/not/there.ttf"]])
def test_invalid_fonts_are_refused(fonts):
    with pytest.raises(ValueError, match="fonts: "):
        read("<g/>", fonts=fonts)


def test_files_that_are_no_fonts_are_refused_except_in_folders(tmp_path, font):
    bad = tmp_path / "bad.ttf"
    bad.write_bytes(b"\0\1\0\0" + b"\xff" * 100)
    with pytest.raises(ValueError, match=r"fonts: '.*bad\.ttf' is no font that can be read"):
        read("<g/>", fonts=[bad])
    (tmp_path / "good.ttf").write_bytes(font.read_bytes())
    assert len(read(text("A"), fonts=[tmp_path]).shapes) == 1


def test_without_fonts_text_is_left_out_with_a_warning():
    (warning,) = read(text("AA"), fonts=[]).warnings
    assert str(warning) == "<text>: left out, as there are no fonts (in line 1)"


@pytest.mark.parametrize(
    ("letters", "base", "shown"),
    [
        # Rules of UAX #9: capitals are Hebrew letters, A aleph and B bet.
        ("ab AB cd", 0, "ab BA cd"),
        ("ab AB cd", 1, "cd BA ab"),
        ("AB 12 AB", 0, "BA 12 BA"),
        ("AB 1,2 a", 1, "a 1,2 BA"),
        ("a (AB) b", 0, "a (BA) b"),
        ("AB (a) AB", 0, "BA (a) BA"),
        ("AB+12%", 1, "12%+BA"),
        ("a.", 1, ".a"),
        ("A\u0301\u0302", 0, "\u0302\u0301A"),
    ],
)
def test_bidirectional_algorithm(letters, base, shown):
    from prefilter.shapes._fonts.bidi import embedding_levels, visual_order

    hebrew = letters.translate(str.maketrans("AB", "\u05d0\u05d1"))
    assert "".join(letters[k] for k in visual_order(embedding_levels(hebrew, base))) == shown


def test_directions_equal_another_implementation():
    bidi = pytest.importorskip("bidi")
    from prefilter.shapes._fonts.bidi import embedding_levels, visual_order

    rng = np.random.default_rng(31)
    letters = "aB \u05d0\u0627\u0661\u06f11,.+%$-()[]!\u0300"
    for _ in range(3000):
        sample = "".join(rng.choice(list(letters), rng.integers(1, 12))).strip()
        for base, name in ((0, "L"), (1, "R")):
            levels = embedding_levels(sample, base)
            order = visual_order(levels)
            actual = "".join(sample[k] for k in order)
            assert actual == bidi.get_display(sample, base_dir=name), (sample, base)


def test_marks_are_placed_without_harfbuzz(tmp_path, monkeypatch):
    from prefilter.shapes._fonts import shaping

    monkeypatch.setattr(shaping, "uharfbuzz", None)
    path = make_font(tmp_path / "marks.ttf", widths={"A": 600, "\u0301": 200})
    assert unicodedata.combining("\u0301")
    (shape,) = read(text("A\u0301"), fonts=[path]).shapes_for(SIZE, SIZE)
    near((shape.bounds[0][0], shape.bounds[1][0]), (20, 26))


def font_face(data, kind="font/ttf", more="", family="Own"):
    address = f"data:{kind};base64,{base64.b64encode(data).decode()}"
    return (
        f"<style>@font-face {{ font-family: '{family}'; src: local(x), url('{address}'); {more} }}"
        "</style>"
    )


def as_woff(path):
    font, file = TTFont(path), io.BytesIO()
    font.flavor = "woff"
    font.save(file)
    return file.getvalue()


@pytest.mark.parametrize("is_woff", [False, True])
def test_embedded_fonts_take_precedence(tmp_path, boxes, is_woff):
    wide = make_font(tmp_path / "wide.ttf", widths={"A": 900, "V": 500})
    data = as_woff(wide) if is_woff else wide.read_bytes()
    style = font_face(data, family="Boxes")
    # Letters missing in the embedded font come from the other one.
    (one,) = boxes(style + text("AV"))
    near(one, (20, 45, 20 + 9 + 5 - 1, 50))
    narrow = make_font(tmp_path / "narrow.ttf", widths={"A": 100})
    both = font_face(wide.read_bytes()) + font_face(narrow.read_bytes(), more="font-weight: 700")
    for weight, width in ((400, 9), (700, 1)):
        (one,) = boxes(both + text("A", f'style="font: {weight} 10px own"'))
        near(one[2] - one[0], width)


def test_embedded_fonts_may_share_a_family(tmp_path, boxes):
    parts = [
        make_font(tmp_path / f"{letter}.ttf", widths={letter: width})
        for letter, width in (("A", 900), ("V", 300))
    ]
    style = "".join(font_face(part.read_bytes()) for part in parts)
    (one,) = boxes(style + text("AV", 'style="font-family: Own"'))
    near(one[2] - one[0], 12)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "neither"),
        (b"wOF2" + bytes(60), "brotli"),
        (b"wOF2" + bytes(8) + b"\xff\xff" + bytes(10), "early" if brotli else "brotli"),
        (b"wOFF", "neither"),
        (b"wOFF" + bytes(8) + b"\xff\xff" + bytes(60), "early"),
        (b"\x00\x01\x00\x00" + bytes(60), ""),
    ],
)
def test_invalid_embedded_fonts(font, data, words):
    drawing = read(font_face(data) + text("A", 'style="font-family: Own, Boxes"'), fonts=[font])
    warning = drawing.warnings[0]
    assert warning.name == "@font-face 'Own'"
    assert words in warning.effect
    assert len(drawing.shapes) == 1


def test_decompression_of_woff_is_limited(tmp_path, font):
    data = bytearray(as_woff(make_font(tmp_path / "font.ttf")))
    # The first table claims the largest size, or a little less than its own.
    for size, words in ((0xFFFFFFFF, "larger than"), (41, "other sizes")):
        data[44 + 12 : 44 + 16] = size.to_bytes(4, "big")
        # Drawings without text do not read fonts.
        assert read(font_face(bytes(data)), fonts=[font]).warnings == ()
        own = text("A", 'style="font-family: Own, Boxes"')
        warning, *_ = read(font_face(bytes(data)) + own, fonts=[font]).warnings
        assert words in warning.effect


@pytest.mark.skipif(brotli is None, reason="needs brotli")
def test_woff_2_fonts(tmp_path, font):
    file = io.BytesIO()
    actual = TTFont(font)
    actual.flavor = "woff2"
    actual.save(file)
    own = text("AiV", 'style="font-family: Own, Boxes"')
    drawing = read(font_face(file.getvalue()) + own, fonts=[make_font(tmp_path / "a.ttf", high=9)])
    expected = read(text("AiV"), fonts=[font])
    assert drawing.warnings == ()
    for one, other in zip(drawing.shapes, expected.shapes, strict=True):
        near(one.bounds, other.bounds)


@pytest.mark.skipif(brotli is None, reason="needs brotli")
def test_decompression_of_woff_2_is_limited(tmp_path, font):
    bomb = brotli.compress(bytes(1 << 27))
    # A table with an explicit tag, not transformed.
    table = b"\x3fabcd" + b"\x80\x80\x80\x40"
    head = b"wOF2\0\1\0\0" + bytes(4) + b"\0\1" + bytes(6) + len(bomb).to_bytes(4, "big")
    data = head + bytes(48 - len(head)) + table + bomb
    tracemalloc.start()
    own = text("A", 'style="font-family: Own, Boxes"')
    warning, *_ = read(font_face(data) + own, fonts=[font]).warnings
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert "larger than 64 MiB" in warning.effect
    assert peak < 1 << 26


def test_fonts_in_the_folder_are_read(tmp_path, font):
    (tmp_path / "in").mkdir()
    make_font(tmp_path / "in" / "own.ttf", widths={"A": 900})
    sheet = "@font-face { font-family: Own; src: url(%s) }"
    own = text("A", 'style="font-family: Own, Boxes"')
    for where, address in (("a.svg", "in/own.ttf"), ("in/a.svg", "own.ttf")):
        path = tmp_path / where
        path.write_text(svg(f"<style>{sheet % address}</style>{own}"))
        actual, warnings = prefilter.rasterize_svg(path, SIZE, SIZE, fonts=[font])
        assert warnings == ()
        columns = np.flatnonzero(actual[..., 3].max(0) > 0.5)
        assert (columns[0], columns[-1]) == (20, 28)
    (tmp_path / "in/b.css").write_text(sheet % "own.ttf")
    (tmp_path / "b.svg").write_text(svg(f"<style>@import 'in/b.css';</style>{own}"))
    assert (
        prefilter.rasterize_svg(tmp_path / "b.svg", SIZE, SIZE, fonts=[font])[0] == actual
    ).all()
    path.write_text(svg(f"<style>{sheet % '../../own.ttf'}</style>{own}"))
    make_font(tmp_path.parent / "own.ttf")
    _, (first, _) = prefilter.rasterize_svg(path, SIZE, SIZE, fonts=[font])
    assert first.effect == "ignored, as it is neither in the file nor in its folder"


def test_fonts_outside_the_folder_cause_warnings(font):
    style = "<style>@font-face { font-family: Own; src: url(https://x.org/a.woff) }</style>"
    own = text("A", 'style="font-family: Own, Boxes"')
    first, second = read(style + own, fonts=[font]).warnings
    assert first.name == "@font-face 'Own'"
    assert first.effect == "ignored, as it is neither in the file nor in its folder"
    assert second.name == "font 'Own'"


def test_vertical_text(tmp_path, boxes):
    """The middle of the font's height, from -2 to 8, is on the line; letters are rotated."""
    for mode in ("tb", "vertical-rl"):
        (one,) = boxes(f'<g writing-mode="{mode}">{text("AiV")}</g>')
        near(one, (20 - 3, 50, 20 + 2, 50 + 12))
    (one,) = boxes(text("AiV", 'writing-mode="tb" text-anchor="middle"'))
    near((one[1], one[3]), (50 - 6, 50 + 6))
    # Only `text` elements have a writing mode.
    (one,) = boxes(text('<tspan writing-mode="tb">A</tspan>'))
    near(one, (20, 45, 26, 50))
    wide = make_font(tmp_path / "wide.ttf", widths={"\u65e5": 1000, "A": 600})
    moved = text("\u65e5<tspan dy='3'>\u65e5</tspan>", 'writing-mode="tb"')
    first, second = boxes(moved.replace("<tspan", '<tspan fill="red"'), [wide])
    # Upright: the advance is the line height, and the letter is centered.
    near(first, (20 - 5, 50 + 5 + 3 - 5, 20 + 5, 50 + 5 + 3))
    near(np.subtract(second, first), (0, 13, 0, 13))


def test_tref_and_system_language(boxes):
    tree = '<defs><text id="t">A<tspan>V</tspan></text></defs>'
    (one,) = boxes(tree + text('<tref href="#t"/>'))
    near(one[2], 20 + advance("AV"))
    (one,) = boxes(text('A<tspan systemLanguage="ru">V</tspan>'))
    near(one[2], 26)
    (warning,) = read(text('<tref href="#x"/>')).warnings
    assert warning.kind == "broken"
