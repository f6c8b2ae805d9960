# SPDX-License-Identifier: GPL-3.0-or-later

"""The fonts of a drawing: which one each character has, and how lines of text lie."""

import unicodedata
from collections.abc import Sequence

from ..._fonts.bitmaps import Bitmap
from ..._fonts.collection import Fonts, Wanted
from ..._fonts.color_layers import ColorGroup
from ..._fonts.font import Font, Glyph
from ..model.values import UnknownUnitError, parse_length
from ..model.warnings import Warnings
from .characters import Character, Span

_USUAL = ("serif",)
# Characters that are not seen, and belong to what they follow.
_INVISIBLE = frozenset("\u200b\u200c\u200d\u2060\ufeff\u00ad\ufe0e\ufe0f")


class Lettering:
    """Chooses fonts.

    Args:
        fonts: Those that there are.
        warnings: Gets the names of what is missing.
    """

    def __init__(self, fonts: Fonts, warnings: Warnings) -> None:
        self.warnings = warnings
        self._fonts = fonts
        self._found: dict[Span, list[Font]] = {}
        self._shifts: dict[Span, float] = {}

    def fonts_of(self, characters: Sequence[Character]) -> list[Font | None]:
        """The font of each character; None where none shows it."""
        found: list[Font | None] = []
        for character in characters:
            letter = character.letter
            is_joined = letter in _INVISIBLE or unicodedata.combining(letter) != 0
            before = found[-1] if found else None
            if (
                is_joined
                and before is not None
                and (letter in _INVISIBLE or ord(letter) in before.characters)
            ):
                found.append(before)
            else:
                found.append(self._font_of(letter, character.span))
        return found

    def font_of_span(self, span: Span) -> Font | None:
        """The font that lines are measured by; None where there are no fonts."""
        fonts = self._fonts_for(span)
        return fonts[0] if fonts else None

    def shift_of(self, span: Span) -> float:
        """How far the letters of a span are below their line, in pixels."""
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
        return share * size + self.raised(span)

    def raised(self, span: Span) -> float:
        """How far `baseline-shift` moves a span and those around it down, in pixels."""
        return -sum(self._raise_of(each) for each in span.line())

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
        """The fonts of a span's families; warns of those that are missing."""
        if span not in self._found:
            found, missing = self._fonts.first(wanted_by(span))
            self._found[span] = found
            line = span.element.line
            if not found:
                self.warnings.unsupported("<text>", "left out, as there are no fonts", line)
                missing = []
            self._warn_of_damage(line)
            for name in missing:
                effect = f"drawn in {found[0].face.family}"
                self.warnings.unsupported(f"font '{name[:60]}'", effect, line)
        return self._found[span]

    def look_of(self, font: Font, glyph: int, span: Span) -> ColorGroup | Bitmap | None:
        """What a glyph looks like in colors; None where it has none that can be drawn."""
        look = font.look(glyph) if font.is_colored else None
        if not isinstance(look, str):
            return look
        self.warnings.unsupported(
            f"font '{font.face.family[:60]}'",
            f"drawn without its colors: it has {look}",
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
        found = self._fonts.with_character(code, wanted_by(span))
        self._warn_of_damage(span.element.line)
        if found is None:
            self.warnings.unsupported(
                f"character U+{code:04X}", "left out, as no font has it", span.element.line
            )
        return found

    def outline_of(self, font: Font, glyph: int, span: Span) -> Glyph:
        """The outline of a glyph; warns where it is damaged."""
        if not font.is_whole(glyph):
            name = f"font '{font.face.family[:60]}'"
            self.warnings.broken(name, "letters left out, as it is damaged", span.element.line)
        return font.glyph(glyph)

    def _shows(self, font: Font, code: int, span: Span) -> bool:
        """Tells whether a font has a character; warns where it is damaged in it."""
        is_shown = font.shows(code)
        if not is_shown and code in font.characters:
            name = f"font '{font.face.family[:60]}'"
            effect = "damaged: some letters are drawn in other fonts"
            self.warnings.broken(name, effect, span.element.line)
        return is_shown

    def _warn_of_damage(self, line: int) -> None:
        """Warns of files that were left out while fonts were looked for."""
        for path, reason in self._fonts.take_damaged().items():
            self.warnings.broken(f"font file '{path}'", f"left out: {reason}", line)


def wanted_by(span: Span) -> Wanted:
    """What a span asks for."""
    style = span.text
    return Wanted(
        style.families or _USUAL,
        style.weight,
        style.stretch,
        style.slant,
        style.variations,
        span.style.font_size,
    )
