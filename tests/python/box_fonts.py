# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts for tests: glyphs are boxes, so that all positions are known."""

from fontTools.fontBuilder import FontBuilder
from fontTools.pens.t2CharStringPen import T2CharStringPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont
from fontTools.ttLib.tables.TupleVariation import TupleVariation

UNITS = 1000
# Advance widths in units; each letter except the space is a box as wide as its advance and 500
# high.
WIDTHS = {"A": 600, "V": 400, "i": 200, " ": 250, "\u05d0": 300, "\u05d1": 500}
KERNING = {("A", "V"): -100}
HIGH, ASCENT, DESCENT = 500, 800, -200


def box(pen, width, high=HIGH):
    pen.moveTo((0, 0))
    pen.lineTo((0, high))
    pen.lineTo((width, high))
    pen.lineTo((width, 0))
    pen.closePath()


def name_of(letter):
    return {" ": "space"}.get(letter, f"uni{ord(letter):04X}")


def make_font(
    path,
    family="Boxes",
    weight=400,
    widths=WIDTHS,
    italic=False,
    stretch=5,
    high=HIGH,
    is_cff=False,
    kerning=True,
):
    builder = FontBuilder(UNITS, isTTF=not is_cff)
    builder.setupGlyphOrder([".notdef", *map(name_of, widths)])
    builder.setupCharacterMap({ord(letter): name_of(letter) for letter in widths})
    glyphs = {}
    for letter, width in {".notdef": 500, **widths}.items():
        name = letter if letter == ".notdef" else name_of(letter)
        pen = T2CharStringPen(width, None) if is_cff else TTGlyphPen(None)
        if letter != " ":
            box(pen, width, high)
        glyphs[name] = pen.getCharString() if is_cff else pen.glyph()
    if is_cff:
        builder.setupCFF(family, {}, glyphs, {})
    else:
        builder.setupGlyf(glyphs)
    advances = {name_of(letter): (width, 0) for letter, width in widths.items()}
    builder.setupHorizontalMetrics({".notdef": (500, 0), **advances})
    builder.setupHorizontalHeader(ascent=ASCENT, descent=DESCENT)
    builder.setupNameTable({"familyName": family, "styleName": f"W{weight}"})
    builder.setupOS2(
        sTypoAscender=ASCENT,
        sTypoDescender=DESCENT,
        usWeightClass=weight,
        sxHeight=400,
        usWidthClass=stretch,
        fsSelection=1 if italic else 64,
        yStrikeoutPosition=250,
        yStrikeoutSize=50,
        ySubscriptYOffset=100,
        ySuperscriptYOffset=300,
    )
    builder.setupPost(underlinePosition=-100, underlineThickness=50)
    if kerning:
        pairs = "".join(
            f"pos {name_of(one)} {name_of(other)} {by};"
            for (one, other), by in KERNING.items()
            if one in widths and other in widths
        )
        if pairs:
            builder.addOpenTypeFeatures(f"feature kern {{ {pairs} }} kern;")
    builder.save(path)
    return path


def make_variable(path):
    """Makes a font of one letter: as wide as its weight from 400 to 900, and 200 wide at 100."""
    make_font(path, widths={"A": 400}, kerning=False)
    font = TTFont(path)
    builder = FontBuilder(font=font)
    builder.setupFvar([("wght", 100, 400, 900, "Weight")], [])
    name = name_of("A")
    wider = [(0, 0), (0, 0), (500, 0), (500, 0), (0, 0), (500, 0), (0, 0), (0, 0)]
    narrower = [(-x * 200 // 500, y) for x, y in wider]
    builder.setupGvar(
        {
            name: [
                TupleVariation({"wght": (0.0, 1.0, 1.0)}, wider),
                TupleVariation({"wght": (-1.0, -1.0, 0.0)}, narrower),
            ]
        }
    )
    font.save(path)
    return path
