# SPDX-License-Identifier: GPL-3.0-or-later

"""Font selection and baselines of characters."""

import unicodedata
from collections.abc import Sequence

from ..._fonts.bitmaps import Bitmap
from ..._fonts.collection import FontQuery, Fonts
from ..._fonts.color_layers import ColorGroup
from ..._fonts.font import Font, Glyph
from ..model.values import UnknownUnitError, parse_length
from ..model.warnings import Warnings
from .characters import Character, Span

_DEFAULT_FAMILIES = ("serif",)
# Invisible characters, which take the font of the preceding one.
_INVISIBLE = frozenset("\u200b\u200c\u200d\u2060\ufeff\u00ad\ufe0e\ufe0f")


class FontSelector:
    """Selects fonts.

    Args:
        fonts: Available fonts.
        warnings: Receives missing and damaged fonts and characters.
    """

    def __init__(self, fonts: Fonts, warnings: Warnings) -> None:
        self.warnings = warnings
        self._fonts = fonts
        self._fonts_by_span: dict[Span, list[Font]] = {}
        self._shifts: dict[Span, float] = {}

    def fonts_of(self, characters: Sequence[Character]) -> list[Font | None]:
        """Returns the font of each character; None if no font has it."""
        fonts: list[Font | None] = []
        for character in characters:
            letter = character.letter
            follows_previous = letter in _INVISIBLE or unicodedata.combining(letter) != 0
            previous = fonts[-1] if fonts else None
            if (
                follows_previous
                and previous is not None
                and (letter in _INVISIBLE or ord(letter) in previous.characters)
            ):
                fonts.append(previous)
            else:
                fonts.append(self._font_of(letter, character.span))
        return fonts

    def font_of_span(self, span: Span) -> Font | None:
        """Returns the font for line metrics; None if there are no fonts."""
        fonts = self._fonts_for(span)
        return fonts[0] if fonts else None

    def shift_of(self, span: Span) -> float:
        """Returns the offset of a span's baseline below its line, in pixels."""
        if span not in self._shifts:
            self._shifts[span] = self._shift_of(span)
        return self._shifts[span]

    def _shift_of(self, span: Span) -> float:
        font = self.font_of_span(span)
        if font is None:
            return 0.0
        metrics, size = font.metrics, span.style.font_size
        middle = 0.5 * (metrics.ascent + metrics.descent)
        share = {
            "middle": 0.5 * metrics.x_height,
            "central": middle,
            "hanging": 0.8 * metrics.ascent,
            "mathematical": 0.5 * metrics.ascent,
            "text-before-edge": metrics.ascent,
            "before-edge": metrics.ascent,
            "text-top": metrics.ascent,
            "text-after-edge": metrics.descent,
            "after-edge": metrics.descent,
            "ideographic": metrics.descent,
            "text-bottom": metrics.descent,
        }.get(span.baseline, 0.0)
        return share * size + self.baseline_shift(span)

    def baseline_shift(self, span: Span) -> float:
        """Returns the total `baseline-shift` of a span and its ancestors, in pixels, positive
        downwards.
        """
        return -sum(self._raise_of(each) for each in span.ancestry())

    def _raise_of(self, span: Span) -> float:
        size = span.style.font_size
        if span.shift in ("baseline", "inherit", ""):
            return 0.0
        if span.shift in ("sub", "super"):
            font = self.font_of_span(span)
            if font is None:
                return 0.0
            metrics = font.metrics
            half = 0.5 * (metrics.ascent - metrics.descent) * size
            return half if span.shift == "super" else -half
        try:
            length = parse_length(span.shift)
        except UnknownUnitError:
            length = None
        return length.pixels(size, size) if length is not None else 0.0

    def _fonts_for(self, span: Span) -> list[Font]:
        """Returns the fonts of a span's families; warns of missing ones."""
        if span not in self._fonts_by_span:
            fonts, missing = self._fonts.match(font_query(span))
            self._fonts_by_span[span] = fonts
            line = span.element.line
            if not fonts:
                self.warnings.unsupported("<text>", "left out, as there are no fonts", line)
                missing = []
            self._warn_of_damaged_files(line)
            for name in missing:
                effect = f"drawn in {fonts[0].face.family}"
                self.warnings.unsupported(f"font '{name[:60]}'", effect, line)
        return self._fonts_by_span[span]

    def color_glyph_of(self, font: Font, glyph: int, span: Span) -> ColorGroup | Bitmap | None:
        """Returns the colored form of a glyph; None if it has none that can be drawn."""
        color_glyph = font.color_glyph(glyph) if font.is_colored else None
        if not isinstance(color_glyph, str):
            return color_glyph
        self.warnings.unsupported(
            f"font '{font.face.family[:60]}'",
            f"drawn without its colors: it has {color_glyph}",
            span.element.line,
        )
        return None

    def _font_of(self, letter: str, span: Span) -> Font | None:
        fonts = self._fonts_for(span)
        code = ord(letter)
        for font in fonts:
            if self._shows(font, code, span):
                return font
        if not fonts or letter.isspace() or letter in _INVISIBLE:
            return fonts[0] if fonts else None
        substitute = self._fonts.with_character(code, font_query(span))
        self._warn_of_damaged_files(span.element.line)
        if substitute is None:
            self.warnings.unsupported(
                f"character U+{code:04X}", "left out, as no font has it", span.element.line
            )
        return substitute

    def outline_of(self, font: Font, glyph: int, span: Span) -> Glyph:
        """Returns the outline of a glyph; warns if it is damaged."""
        if not font.is_readable(glyph):
            name = f"font '{font.face.family[:60]}'"
            self.warnings.broken(name, "letters left out, as it is damaged", span.element.line)
        return font.glyph(glyph)

    def _shows(self, font: Font, code: int, span: Span) -> bool:
        """Returns whether a font can draw a character; warns if its glyph is damaged."""
        is_shown = font.shows(code)
        if not is_shown and code in font.characters:
            name = f"font '{font.face.family[:60]}'"
            effect = "damaged: some letters are drawn in other fonts"
            self.warnings.broken(name, effect, span.element.line)
        return is_shown

    def _warn_of_damaged_files(self, line: int) -> None:
        """Warns of font files that turned out to be unreadable."""
        for path, reason in self._fonts.take_damaged().items():
            self.warnings.broken(f"font file '{path}'", f"left out: {reason}", line)


def font_query(span: Span) -> FontQuery:
    """Returns the font query of a span."""
    style = span.text
    return FontQuery(
        style.families or _DEFAULT_FAMILIES,
        style.weight,
        style.stretch,
        style.slant,
        style.variations,
        span.style.font_size,
    )
