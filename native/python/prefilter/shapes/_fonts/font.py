# SPDX-License-Identifier: GPL-3.0-or-later

"""Glyphs and metrics of a font."""

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

# Segments of a glyph, which nested components may multiply.
_MAX_SEGMENTS = 200_000
# Magic number of the table "head", and valid units per em.
_MAGIC = 0x5F0F3CF5
_VALID_UNITS_PER_EM = range(16, 16385)
# Size of a glyph's header, in bytes.
_GLYPH_HEADER_BYTES = 10


@dataclass(frozen=True, slots=True)
class Glyph:
    """The outline of a glyph, in font units, y upwards.

    Attributes:
        letters: M, L, Q, C and Z, a byte per segment; `numbers` are the coordinates of all points.
    """

    letters: bytes
    numbers: "array[float]"


@dataclass(frozen=True, slots=True)
class Metrics:
    """Vertical metrics, in em, upwards from the baseline."""

    ascent: float
    descent: float
    x_height: float


class Font:
    """A face at a location of its axes.

    Attributes:
        location: Axis values by tag.
        skew: Synthetic slant, for families without a slanted face.
    """

    def __init__(self, face: Face, location: Mapping[str, float], skew: float = 0.0) -> None:
        self.face = face
        self.location = dict(location)
        self.skew = skew
        # Not lazy: the file is closed, and may change.
        self._file = face.open()
        self.units_per_em = float(max(self._file["head"].unitsPerEm, 1))
        self._order = self._file.getGlyphOrder()
        self._glyphs = None
        if any(tag in self._file for tag in OUTLINES):
            self._glyphs = self._file.getGlyphSet(location=self.location or None)
        self._check()
        self._outlines: dict[int, Glyph] = {}
        self._damaged: set[int] = set()
        self._color_glyphs: dict[int, ColorGroup | Bitmap | str | None] = {}

    def _check(self) -> None:
        """Reads all tables except single glyphs, and raises an exception if they are damaged.

        fontTools reads truncated tables as empty glyphs.
        """
        _ = self.characters, self.metrics, self._file["hmtx"].metrics
        head = self._file["head"]
        if head.magicNumber != _MAGIC or not self._file["cmap"].tables:
            raise ValueError("its tables are overwritten")
        if head.unitsPerEm not in _VALID_UNITS_PER_EM:
            raise ValueError(f"found {head.unitsPerEm} units")
        reader = self._file.reader
        if reader.flavor == "woff2":
            return  # Decompression fails if it is truncated.
        size = reader.file.seek(0, os.SEEK_END)
        if any(entry.offset + entry.length > size for entry in reader.tables.values()):
            raise ValueError("a table is cut off")
        if "glyf" in self._file:
            entry = reader.tables["glyf"]
            outlines = getattr(entry, "origLength", entry.length)
            last = max(self._file["loca"], default=0)
            if last > outlines or (last == 0 and self.characters):
                raise ValueError("the outlines are cut off")

    def is_readable(self, number: int) -> bool:
        """Returns whether the outline of a glyph is readable."""
        self.glyph(number)
        return number not in self._damaged

    def shows(self, code: int) -> bool:
        """Returns whether a character has a glyph with a readable outline."""
        number = self.characters.get(code)
        return number is not None and (chr(code).isspace() or self.is_readable(number))

    @cached_property
    def characters(self) -> Mapping[int, int]:
        """Glyphs by character code."""
        names = self._file.getBestCmap() or {}
        numbers = self._file.getReverseGlyphMap()
        return {code: numbers[name] for code, name in names.items() if name in numbers}

    @cached_property
    def is_colored(self) -> bool:
        """Whether it has colored glyphs."""
        return any(tag in self._file for tag in ("COLR", "SVG ", "sbix", "CBDT"))

    def color_glyph(self, number: int) -> ColorGroup | Bitmap | str | None:
        """Returns the colored form of a glyph, cached; None if it has none.

        A str says why its colors cannot be drawn.
        """
        if number not in self._color_glyphs:
            try:
                self._color_glyphs[number] = self._read_color_glyph(self._order[number])
            except UnknownPaintError as error:
                self._color_glyphs[number] = str(error)
            except Exception:
                self._color_glyphs[number] = "damaged tables"
        return self._color_glyphs[number]

    def _read_color_glyph(self, name: str) -> ColorGroup | Bitmap | str | None:
        color_glyph: ColorGroup | Bitmap | None = None
        if self._colors is not None:
            color_glyph = self._colors.layers(name)
        if color_glyph is None and self._bitmaps is not None:
            color_glyph = self._bitmaps.bitmap(name)
        if color_glyph is None and "SVG " in self._file and "COLR" not in self._file:
            return "drawings of letters"
        return color_glyph

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
        """The vertical metrics."""
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
        """Returns the advance width of a glyph, in font units."""
        name = self._order[number]
        if self._glyphs is None:
            return float(self._file["hmtx"].metrics[name][0])
        try:
            return float(self._glyphs[name].width)
        except Exception:
            self._damaged.add(number)
            return 0.0

    def glyph(self, number: int) -> Glyph:
        """Returns the outline of a glyph, cached; empty if it is damaged: see `is_readable`."""
        if number not in self._outlines:
            pen = _Pen(self._glyphs)
            try:
                if self._glyphs is not None:
                    self._glyphs[self._order[number]].draw(pen)
                    if not pen.letters and self._is_overwritten(number):
                        self._damaged.add(number)
            except Exception:
                pen = _Pen(self._glyphs)
                self._damaged.add(number)
            self._outlines[number] = Glyph(bytes(pen.letters), pen.numbers)
        return self._outlines[number]

    def _is_overwritten(self, number: int) -> bool:
        """Returns whether a glyph without an outline has more than a header in the file."""
        if "glyf" not in self._file:
            return False
        places = self._file["loca"]
        return bool(places[number + 1] - places[number] > _GLYPH_HEADER_BYTES + 2)


class _Pen(BasePen):  # type: ignore[misc]
    """Records the segments of a glyph, with its components."""

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
