# SPDX-License-Identifier: GPL-3.0-or-later

"""Shaping of characters into glyphs, by HarfBuzz if uharfbuzz is installed."""

import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from fontTools.unicodedata import script as script_of

from .font import Font

try:
    import uharfbuzz
except ImportError:
    uharfbuzz = None

HAS_HARFBUZZ = uharfbuzz is not None
_UNSPECIFIC_SCRIPTS = ("Zyyy", "Zinh", "Zzzz")
# Scripts with cursive joining.
JOINING = frozenset(("Arab", "Syrc", "Mong", "Nkoo", "Mand", "Mani", "Adlm", "Rohg"))
COMPLEX = JOINING | frozenset(
    (
        *("Deva", "Beng", "Guru", "Gujr", "Orya", "Taml", "Telu", "Knda", "Mlym", "Sinh", "Thai"),
        *("Laoo", "Tibt", "Mymr", "Khmr", "Java", "Bali", "Cham", "Lana", "Newa"),
    )
)


@dataclass(frozen=True, slots=True)
class ShapedGlyph:
    """A glyph with its position.

    Attributes:
        glyph: Glyph index in the font.
        cluster: Index of its first character.
        advance: In font units.
        x: Offset, in font units.
        y: Offset upwards, in font units.
    """

    glyph: int
    cluster: int
    advance: float
    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, slots=True)
class Features:
    """Font features to apply.

    Attributes:
        has_ligatures: Whether optional ligatures are formed.
        has_small_capitals: Whether lower-case letters become small capitals.
    """

    has_kerning: bool = True
    has_ligatures: bool = True
    has_small_capitals: bool = False


def detect_scripts(text: str) -> list[str]:
    """Returns the script of each character; common characters take that of a neighbor."""
    scripts = [script_of(each) for each in text]
    for order in (range(1, len(scripts)), range(len(scripts) - 2, -1, -1)):
        for index in order:
            if scripts[index] in _UNSPECIFIC_SCRIPTS:
                scripts[index] = scripts[index - 1 if order.step > 0 else index + 1]
    return scripts


def shape(
    font: Font, text: str, script: str, language: str, features: Features, is_leftward: bool
) -> list[ShapedGlyph]:
    """Shapes a run of text; returns glyphs from left to right."""
    if uharfbuzz is None:
        return _shape_without_harfbuzz(font, text, features, is_leftward)
    buffer = uharfbuzz.Buffer()
    buffer.add_codepoints([ord(each) for each in text])
    buffer.direction = "rtl" if is_leftward else "ltr"
    if script not in _UNSPECIFIC_SCRIPTS:
        buffer.script = script
    if language:
        buffer.language = language
    buffer.guess_segment_properties()
    feature_settings: dict[str, bool] = {}
    if not features.has_kerning:
        feature_settings["kern"] = False
    if not features.has_ligatures:
        feature_settings.update(dict.fromkeys(("liga", "clig", "dlig", "hlig"), False))
    if features.has_small_capitals:
        feature_settings["smcp"] = True
    uharfbuzz.shape(_harfbuzz_font(font), buffer, feature_settings)
    return [
        ShapedGlyph(
            info.codepoint, info.cluster, position.x_advance, position.x_offset, position.y_offset
        )
        for info, position in zip(buffer.glyph_infos, buffer.glyph_positions, strict=True)
    ]


@lru_cache(maxsize=64)
def _harfbuzz_font(font: Font) -> Any:
    blob = uharfbuzz.Blob(font.face.contents())
    font_at_location = uharfbuzz.Font(uharfbuzz.Face(blob, font.face.index))
    if font.location:
        font_at_location.set_variations(font.location)
    return font_at_location


def _shape_without_harfbuzz(
    font: Font, text: str, features: Features, is_leftward: bool
) -> list[ShapedGlyph]:
    """Maps characters to glyphs one by one, with kerning and centered marks."""
    glyphs = [
        font.characters.get(ord(_mirrored(each) if is_leftward else each), 0) for each in text
    ]
    glyphs_placed: list[ShapedGlyph] = []
    for index, (each, glyph) in enumerate(zip(text, glyphs, strict=True)):
        if unicodedata.category(each) in ("Cf", "Cc"):
            continue
        advance = font.advance(glyph)
        is_mark = unicodedata.category(each) == "Mn" and bool(glyphs_placed)
        if is_mark and advance > 0.0:
            # Centered above its base.
            base = glyphs_placed[-1]
            shift = -0.5 * (base.advance + advance)
            glyphs_placed.append(ShapedGlyph(glyph, base.cluster, 0.0, shift))
            continue
        glyphs_placed.append(
            ShapedGlyph(glyph, glyphs_placed[-1].cluster if is_mark else index, advance)
        )
    if features.has_kerning:
        pairs = _kerning(font)
        for index in range(len(glyphs_placed) - 1):
            left_glyph = glyphs_placed[index]
            adjustment = pairs.between(left_glyph.glyph, glyphs_placed[index + 1].glyph)
            if adjustment:
                glyphs_placed[index] = ShapedGlyph(
                    left_glyph.glyph,
                    left_glyph.cluster,
                    left_glyph.advance + adjustment,
                    left_glyph.x,
                    left_glyph.y,
                )
    return glyphs_placed[::-1] if is_leftward else glyphs_placed


def _mirrored(each: str) -> str:
    """Returns the mirrored form of a bracket."""
    pairs = "()[]{}<>\u00ab\u00bb\u2039\u203a"
    position = pairs.find(each)
    return each if position < 0 else pairs[position ^ 1]


class _Kerning:
    """Kerning of glyph pairs: the feature `kern` of GPOS, or the table `kern`."""

    def __init__(self, font: Font) -> None:
        self._names = font.tables.getGlyphOrder()
        self._subtables: list[Any] = []
        self._pairs: Mapping[tuple[str, str], float] = {}
        self._known: dict[tuple[int, int], float] = {}
        try:
            self._read(font.tables)
        except Exception:
            self._subtables, self._pairs = [], {}

    def between(self, first: int, second: int) -> float:
        """Returns the change of the distance between two glyphs, in font units."""
        key = (first, second)
        if key not in self._known:
            try:
                self._known[key] = self._between(self._names[first], self._names[second])
            except Exception:  # Tables are parsed when needed, and may be damaged.
                self._known[key] = 0.0
        return self._known[key]

    def _between(self, left: str, right: str) -> float:
        values = [
            value
            for lookup in self._subtables
            if (value := _pair_adjustment(lookup, left, right)) is not None
        ]
        return float(sum(values) if values else self._pairs.get((left, right), 0.0))

    def _read(self, tables: Any) -> None:
        if "GPOS" in tables and tables["GPOS"].table.LookupList:
            table = tables["GPOS"].table
            records = table.FeatureList.FeatureRecord if table.FeatureList else []
            lookup_indices = sorted(
                {
                    index
                    for record in records
                    if record.FeatureTag == "kern"
                    for index in record.Feature.LookupListIndex
                }
            )
            for index in lookup_indices:
                lookup = table.LookupList.Lookup[index]
                inner = [getattr(each, "ExtSubTable", each) for each in lookup.SubTable]
                self._subtables.append([each for each in inner if each.LookupType == 2])
        if not self._subtables and "kern" in tables:
            pairs: dict[tuple[str, str], float] = {}
            for subtable in tables["kern"].kernTables:
                pairs.update(getattr(subtable, "kernTable", {}))
            self._pairs = pairs


def _pair_adjustment(subtables: Sequence[Any], left: str, right: str) -> float | None:
    """Returns the adjustment in the first subtable that has the pair; None if there is none."""
    for table in subtables:
        if left not in table.Coverage.glyphs:
            continue
        if table.Format == 1:
            pairs = table.PairSet[table.Coverage.glyphs.index(left)].PairValueRecord
            value = next((each.Value1 for each in pairs if each.SecondGlyph == right), None)
            if value is None:
                continue
        else:
            first = table.ClassDef1.classDefs.get(left, 0)
            second = table.ClassDef2.classDefs.get(right, 0)
            value = table.Class1Record[first].Class2Record[second].Value1
        return float(getattr(value, "XAdvance", 0) or 0) if value is not None else 0.0
    return None


@lru_cache(maxsize=64)
def _kerning(font: Font) -> _Kerning:
    return _Kerning(font)
