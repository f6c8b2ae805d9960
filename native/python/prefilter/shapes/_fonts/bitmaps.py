# SPDX-License-Identifier: GPL-3.0-or-later

"""Bitmap glyphs: the tables CBDT and sbix."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

_MAX_COPIES = 8
_BITMAPS = ("CBDT", "sbix")


@dataclass(frozen=True, slots=True)
class Bitmap:
    """A bitmap of a glyph.

    Attributes:
        data: An image file, usually PNG.
        unit: Side of a pixel, in font units.
        left: Left edge, in font units.
        edge: Height of the upper or lower edge above the baseline, in font units.
        is_top: Whether `edge` is the upper edge.
    """

    data: bytes
    unit: float
    left: float
    edge: float
    is_top: bool


def has_bitmaps(tables: Any) -> bool:
    """Returns whether a font has bitmap glyphs."""
    return any(tag in tables for tag in _BITMAPS)


class BitmapTable:
    """The largest bitmaps of a font's glyphs."""

    def __init__(self, tables: Any, units_per_em: float) -> None:
        self._tables = tables
        self._units_per_em = units_per_em

    def bitmap(self, name: str) -> Bitmap | None:
        """Returns the bitmap of a glyph; None if it has none."""
        if "sbix" in self._tables:
            return self._from_sbix(name)
        return self._from_cbdt(name)

    def _from_sbix(self, name: str) -> Bitmap | None:
        strike, glyph = self._sbix, None
        for _ in range(_MAX_COPIES):
            glyph = strike.glyphs.get(name) if strike is not None else None
            if glyph is None or glyph.graphicType != "dupe":
                break
            name = glyph.referenceGlyphName
        if glyph is None or not glyph.imageData:
            return None
        unit = self._units_per_em / max(strike.ppem, 1)
        left, low = glyph.originOffsetX or 0, glyph.originOffsetY or 0
        return Bitmap(bytes(glyph.imageData), unit, left * unit, low * unit, False)

    def _from_cbdt(self, name: str) -> Bitmap | None:
        entry = self._cbdt.get(name)
        if entry is None:
            return None
        glyph, ppem, shared = entry
        if not hasattr(glyph, "imageData"):
            return None
        metrics = getattr(glyph, "metrics", None) or shared
        if metrics is None:
            return None
        unit = self._units_per_em / max(ppem, 1)
        # Metrics for both directions prefix their names with "hori".
        left = getattr(metrics, "BearingX", getattr(metrics, "horiBearingX", 0))
        top = getattr(metrics, "BearingY", getattr(metrics, "horiBearingY", 0))
        return Bitmap(bytes(glyph.imageData), unit, left * unit, top * unit, True)

    @cached_property
    def _sbix(self) -> Any:
        strikes = self._tables["sbix"].strikes
        return strikes[max(strikes)] if strikes else None

    @cached_property
    def _cbdt(self) -> Mapping[str, tuple[Any, int, Any]]:
        """Glyphs of the largest strike, with its size and shared metrics."""
        strikes = self._tables["CBLC"].strikes
        if not strikes:
            return {}
        index = max(range(len(strikes)), key=lambda each: strikes[each].bitmapSizeTable.ppemY)
        strike = strikes[index]
        shared = {
            name: getattr(part, "metrics", None)
            for part in strike.indexSubTables
            for name in part.names
        }
        data = self._tables["CBDT"].strikeData[index]
        ppem = strike.bitmapSizeTable.ppemY
        return {name: (glyph, ppem, shared.get(name)) for name, glyph in data.items()}
