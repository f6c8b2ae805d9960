# SPDX-License-Identifier: GPL-3.0-or-later

"""From characters to glyphs: by HarfBuzz where uharfbuzz is installed, otherwise by hand."""

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
_COMMON = ("Zyyy", "Zinh", "Zzzz")
# Scripts whose letters change with their neighbors.
JOINING = frozenset(("Arab", "Syrc", "Mong", "Nkoo", "Mand", "Mani", "Adlm", "Rohg"))
COMPLEX = JOINING | frozenset(
    (
        *("Deva", "Beng", "Guru", "Gujr", "Orya", "Taml", "Telu", "Knda", "Mlym", "Sinh", "Thai"),
        *("Laoo", "Tibt", "Mymr", "Khmr", "Java", "Bali", "Cham", "Lana", "Newa"),
    )
)


@dataclass(frozen=True, slots=True)
class Shaped:
    """A glyph in its place.

    Attributes:
        glyph: Its number in the font.
        cluster: The index of the first character that it stands for.
        advance: How far it leads, in units of the font.
        x: How far it is moved, likewise.
        y: Upwards.
    """

    glyph: int
    cluster: int
    advance: float
    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, slots=True)
class Features:
    """What a font may do to letters.

    Attributes:
        has_kerning: Whether pairs are moved together.
        has_ligatures: Whether letters are joined where they need not be.
        has_small_capitals: Whether small letters are capitals of their size.
    """

    has_kerning: bool = True
    has_ligatures: bool = True
    has_small_capitals: bool = False


def scripts_in(text: str) -> list[str]:
    """The script of each character; what all share is of the script before it."""
    found = [script_of(each) for each in text]
    for order in (range(1, len(found)), range(len(found) - 2, -1, -1)):
        for index in order:
            if found[index] in _COMMON:
                found[index] = found[index - 1 if order.step > 0 else index + 1]
    return found


def shape(
    font: Font, text: str, script: str, language: str, features: Features, is_leftward: bool
) -> list[Shaped]:
    """The glyphs of a run of text, from left to right."""
    if uharfbuzz is None:
        return _simple(font, text, features, is_leftward)
    buffer = uharfbuzz.Buffer()
    buffer.add_codepoints([ord(each) for each in text])
    buffer.direction = "rtl" if is_leftward else "ltr"
    if script not in _COMMON:
        buffer.script = script
    if language:
        buffer.language = language
    buffer.guess_segment_properties()
    asked: dict[str, bool] = {}
    if not features.has_kerning:
        asked["kern"] = False
    if not features.has_ligatures:
        asked.update(dict.fromkeys(("liga", "clig", "dlig", "hlig"), False))
    if features.has_small_capitals:
        asked["smcp"] = True
    uharfbuzz.shape(_harfbuzz_font(font), buffer, asked)
    return [
        Shaped(info.codepoint, info.cluster, place.x_advance, place.x_offset, place.y_offset)
        for info, place in zip(buffer.glyph_infos, buffer.glyph_positions, strict=True)
    ]


@lru_cache(maxsize=64)
def _harfbuzz_font(font: Font) -> Any:
    blob = uharfbuzz.Blob(font.face.contents())
    made = uharfbuzz.Font(uharfbuzz.Face(blob, font.face.index))
    if font.location:
        made.set_variations(font.location)
    return made


def _simple(font: Font, text: str, features: Features, is_leftward: bool) -> list[Shaped]:
    """A glyph a character, pairs moved as the font's tables say; marks on what they follow."""
    glyphs = [
        font.characters.get(ord(_mirrored(each) if is_leftward else each), 0) for each in text
    ]
    found: list[Shaped] = []
    for index, (each, glyph) in enumerate(zip(text, glyphs, strict=True)):
        if unicodedata.category(each) in ("Cf", "Cc"):
            continue
        advance = font.advance(glyph)
        is_mark = unicodedata.category(each) == "Mn" and bool(found)
        if is_mark and advance > 0.0:
            # In the middle above what it belongs to.
            base = found[-1]
            shift = -0.5 * (base.advance + advance)
            found.append(Shaped(glyph, base.cluster, 0.0, shift))
            continue
        found.append(Shaped(glyph, found[-1].cluster if is_mark else index, advance))
    if features.has_kerning:
        pairs = _kerning(font)
        for index in range(len(found) - 1):
            one = found[index]
            moved = pairs.between(one.glyph, found[index + 1].glyph)
            if moved:
                found[index] = Shaped(one.glyph, one.cluster, one.advance + moved, one.x, one.y)
    return found[::-1] if is_leftward else found


def _mirrored(each: str) -> str:
    """A bracket as it looks to the left."""
    pairs = "()[]{}<>\u00ab\u00bb\u2039\u203a"
    at = pairs.find(each)
    return each if at < 0 else pairs[at ^ 1]


class _Kerning:
    """How far pairs of glyphs are moved together: the feature `kern` of GPOS, or the table `kern`.

    Args:
        font: The font.
    """

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
        """How much nearer the second of two glyphs is: a negative number of units."""
        key = (first, second)
        if key not in self._known:
            try:
                self._known[key] = self._between(self._names[first], self._names[second])
            except Exception:  # Tables are read as they are needed, and may be damaged.
                self._known[key] = 0.0
        return self._known[key]

    def _between(self, left: str, right: str) -> float:
        found = [
            value
            for lookup in self._subtables
            if (value := _first_of(lookup, left, right)) is not None
        ]
        return float(sum(found) if found else self._pairs.get((left, right), 0.0))

    def _read(self, tables: Any) -> None:
        if "GPOS" in tables and tables["GPOS"].table.LookupList:
            table = tables["GPOS"].table
            records = table.FeatureList.FeatureRecord if table.FeatureList else []
            wanted = sorted(
                {
                    index
                    for record in records
                    if record.FeatureTag == "kern"
                    for index in record.Feature.LookupListIndex
                }
            )
            for index in wanted:
                lookup = table.LookupList.Lookup[index]
                inner = [getattr(each, "ExtSubTable", each) for each in lookup.SubTable]
                self._subtables.append([each for each in inner if each.LookupType == 2])
        if not self._subtables and "kern" in tables:
            pairs: dict[tuple[str, str], float] = {}
            for subtable in tables["kern"].kernTables:
                pairs.update(getattr(subtable, "kernTable", {}))
            self._pairs = pairs


def _first_of(subtables: Sequence[Any], left: str, right: str) -> float | None:
    """What the first subtable that knows a pair says of it."""
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
