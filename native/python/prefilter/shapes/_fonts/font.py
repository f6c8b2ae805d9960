# SPDX-License-Identifier: GPL-3.0-or-later

"""Glyphs of a font, as fontTools reads them."""

import os
from array import array
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from fontTools.pens.basePen import BasePen

from .bitmaps import Bitmap, BitmapTable, has_bitmaps
from .color_layers import ColorGroup, ColorTable, UnknownPaintError
from .faces import OUTLINES, Face

# Of a glyph: components of components may be many.
_MAX_SEGMENTS = 200_000
# What the table "head" says of itself, and may say of the units of an em.
_MAGIC = 0x5F0F3CF5
_UNITS = range(16, 16385)
# Bytes of a glyph before its contours.
_GLYPH_HEAD = 10


@dataclass(frozen=True, slots=True)
class Glyph:
    """What a glyph fills, in units of its font, y upwards.

    Attributes:
        letters: M, L, Q, C and Z, a byte for each segment.
        numbers: Coordinates of the points of all segments.
    """

    letters: bytes
    numbers: "array[float]"


@dataclass(frozen=True, slots=True)
class Metrics:
    """Of a font, in shares of its size, upwards from the baseline."""

    ascent: float
    descent: float
    x_height: float


class Font:
    """A face, with the values of what varies in it.

    Attributes:
        face: Where it is.
        location: Values by the tags of axes.
        skew: How far it is to be slanted, where its family has no slanted face.
    """

    def __init__(self, face: Face, location: Mapping[str, float], skew: float = 0.0) -> None:
        self.face = face
        self.location = dict(location)
        self.skew = skew
        # Not lazy: a file stays closed, and may change.
        self._file = face.opened()
        self.units_per_em = float(max(self._file["head"].unitsPerEm, 1))
        self._order = self._file.getGlyphOrder()
        self._glyphs = None
        if any(tag in self._file for tag in OUTLINES):
            self._glyphs = self._file.getGlyphSet(location=self.location or None)
        self._check()
        self._drawn: dict[int, Glyph] = {}
        self._damaged: set[int] = set()
        self._looks: dict[int, ColorGroup | Bitmap | str | None] = {}

    def _check(self) -> None:
        """Reads all that is read later but for single glyphs; raises what goes wrong in that.

        What is cut off would be read as glyphs without outlines.
        """
        _ = self.characters, self.metrics, self._file["hmtx"].metrics
        head = self._file["head"]
        if head.magicNumber != _MAGIC or not self._file["cmap"].tables:
            raise ValueError("its tables are overwritten")
        if head.unitsPerEm not in _UNITS:
            raise ValueError(f"found {head.unitsPerEm} units")
        reader = self._file.reader
        if reader.flavor == "woff2":
            return  # Its tables are made as it is unpacked, which fails if it is cut off.
        size = reader.file.seek(0, os.SEEK_END)
        if any(entry.offset + entry.length > size for entry in reader.tables.values()):
            raise ValueError("a table is cut off")
        if "glyf" in self._file:
            entry = reader.tables["glyf"]
            outlines = getattr(entry, "origLength", entry.length)
            last = max(self._file["loca"], default=0)
            if last > outlines or (last == 0 and self.characters):
                raise ValueError("the outlines are cut off")

    def is_whole(self, number: int) -> bool:
        """Whether the outline of a glyph can be read."""
        self.glyph(number)
        return number not in self._damaged

    def shows(self, code: int) -> bool:
        """Whether there is a glyph for a character, and its outline can be read."""
        number = self.characters.get(code)
        return number is not None and (chr(code).isspace() or self.is_whole(number))

    @cached_property
    def characters(self) -> Mapping[int, int]:
        """Glyphs by what they show: a character's code."""
        names = self._file.getBestCmap() or {}
        numbers = self._file.getReverseGlyphMap()
        return {code: numbers[name] for code, name in names.items() if name in numbers}

    @cached_property
    def is_colored(self) -> bool:
        """Whether its letters have colors."""
        return any(tag in self._file for tag in ("COLR", "SVG ", "sbix", "CBDT"))

    def look(self, number: int) -> ColorGroup | Bitmap | str | None:
        """What a glyph looks like in colors, read once; None where it has none.

        A text says why its colors cannot be had.
        """
        if number not in self._looks:
            try:
                self._looks[number] = self._look(self._order[number])
            except UnknownPaintError as error:
                self._looks[number] = str(error)
            except Exception:
                self._looks[number] = "damaged tables"
        return self._looks[number]

    def _look(self, name: str) -> ColorGroup | Bitmap | str | None:
        found: ColorGroup | Bitmap | None = None
        if self._colors is not None:
            found = self._colors.layers(name)
        if found is None and self._bitmaps is not None:
            found = self._bitmaps.bitmap(name)
        if found is None and "SVG " in self._file and "COLR" not in self._file:
            return "drawings of letters"
        return found

    @cached_property
    def _colors(self) -> ColorTable | None:
        return ColorTable(self._file) if "COLR" in self._file else None

    @cached_property
    def _bitmaps(self) -> BitmapTable | None:
        return BitmapTable(self._file, self.units_per_em) if has_bitmaps(self._file) else None

    @cached_property
    def tables(self) -> Any:
        """The tables of the file."""
        return self._file

    @cached_property
    def metrics(self) -> Metrics:
        """How high letters are."""
        em = self.units_per_em
        file = self._file
        hhea, os2 = file.get("hhea"), file.get("OS/2")
        ascent = hhea.ascent if hhea else 0.8 * em
        descent = hhea.descent if hhea else -0.2 * em
        if os2 and (os2.fsSelection & (1 << 7) or (ascent == 0 and descent == 0)):
            ascent, descent = os2.sTypoAscender, os2.sTypoDescender
        x_height = getattr(os2, "sxHeight", 0) if os2 else 0
        x_height = x_height if x_height > 0 else 0.45 * (ascent - descent)
        return Metrics(
            ascent=ascent / em,
            descent=descent / em,
            x_height=x_height / em,
        )

    def advance(self, number: int) -> float:
        """How far a glyph leads, in units of the font."""
        name = self._order[number]
        if self._glyphs is None:
            return float(self._file["hmtx"].metrics[name][0])
        try:
            return float(self._glyphs[name].width)
        except Exception:
            self._damaged.add(number)
            return 0.0

    def glyph(self, number: int) -> Glyph:
        """The outline of a glyph, read once; an empty one where it is damaged: see `is_whole`."""
        if number not in self._drawn:
            pen = _Pen(self._glyphs)
            try:
                if self._glyphs is not None:
                    self._glyphs[self._order[number]].draw(pen)
                    if not pen.letters and self._is_overwritten(number):
                        self._damaged.add(number)
            except Exception:
                pen = _Pen(self._glyphs)
                self._damaged.add(number)
            self._drawn[number] = Glyph(bytes(pen.letters), pen.numbers)
        return self._drawn[number]

    def _is_overwritten(self, number: int) -> bool:
        """Whether a glyph without an outline has more than the head of one in the file."""
        if "glyf" not in self._file:
            return False
        places = self._file["loca"]
        return bool(places[number + 1] - places[number] > _GLYPH_HEAD + 2)


class _Pen(BasePen):  # type: ignore[misc]
    """Keeps what a glyph draws, its components in place."""

    def __init__(self, glyphs: Any) -> None:
        super().__init__(glyphs)
        self.letters = bytearray()
        self.numbers = array("d")

    def _add(self, letter: bytes, *points: tuple[float, float]) -> None:
        if len(self.letters) >= _MAX_SEGMENTS:
            raise ValueError("too many segments")
        self.letters += letter
        for point in points:
            self.numbers.extend(point)

    def _moveTo(self, pt: tuple[float, float]) -> None:  # noqa: N802 - fontTools calls it so
        self._add(b"M", pt)

    def _lineTo(self, pt: tuple[float, float]) -> None:  # noqa: N802
        self._add(b"L", pt)

    def _qCurveToOne(  # noqa: N802
        self, pt1: tuple[float, float], pt2: tuple[float, float]
    ) -> None:
        self._add(b"Q", pt1, pt2)

    def _curveToOne(  # noqa: N802
        self, pt1: tuple[float, float], pt2: tuple[float, float], pt3: tuple[float, float]
    ) -> None:
        self._add(b"C", pt1, pt2, pt3)

    def _closePath(self) -> None:  # noqa: N802
        self._add(b"Z")

    def _endPath(self) -> None:  # noqa: N802
        self._add(b"Z")
