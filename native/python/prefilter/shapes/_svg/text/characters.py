# SPDX-License-Identifier: GPL-3.0-or-later

"""Characters of a text element, with their styles and positioning attributes."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from ...affine import IDENTITY
from ..model.outline import read_path
from ..model.values import Length, UnknownUnitError, parse_length, parse_transform
from ..read.basic_shapes import BASIC_SHAPES, read_shape
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.lengths import Units, read_length
from ..read.nesting import passes_conditions
from ..read.styles import Style
from ..read.text_style import TextStyle
from .tracks import Track

INNER = ("tspan", "textPath", "a", "tref", "altGlyph")
"""Elements within text whose text belongs to it."""
_XML_SPACE = "{http://www.w3.org/XML/1998/namespace}space"
_XML_LANG = "{http://www.w3.org/XML/1998/namespace}lang"
_LINES = ("underline", "overline", "line-through")
_ZERO = Length(0.0)


@dataclass(frozen=True, slots=True, eq=False)
class TextPath:
    """The path of a `textPath`.

    Attributes:
        offset: `startOffset` along it.
    """

    track: Track
    offset: float


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """`textLength` and `lengthAdjust` of an element.

    Attributes:
        length: In the element's units.
    """

    length: float
    is_stretched: bool


@dataclass(frozen=True, slots=True, eq=False)
class Span:
    """The text of one element, without nested elements.

    Attributes:
        around: Spans of its ancestors within the text, outermost first.
        lines: Its own text decorations.
        baseline: The baseline to align with its position.
        shift: `baseline-shift` as text.
        path: The path of the text; None for a straight line.
        forced: "L" or "R" if a direction overrides that of the letters.
        language: Language code; empty if unknown.
    """

    element: SvgElement
    style: Style
    around: tuple["Span", ...] = ()
    lines: tuple[str, ...] = ()
    baseline: str = "auto"
    shift: str = "baseline"
    path: TextPath | None = None
    fitted: Fitted | None = None
    forced: str = ""
    language: str = ""

    @property
    def text(self) -> TextStyle:
        """The text properties."""
        return self.style.text

    def ancestry(self) -> Iterator["Span"]:
        """Yields the spans of its ancestors, outermost first, and itself."""
        yield from self.around
        yield self


@dataclass(slots=True)
class Character:
    """A character with its positioning attributes: pixels, and degrees for `rotate`."""

    letter: str
    span: Span
    x: float | None = None
    y: float | None = None
    dx: float = 0.0
    dy: float = 0.0
    rotate: float = 0.0


@dataclass(slots=True)
class _RawText:
    """Characters read so far.

    Attributes:
        letters: Characters with their span, and whether whitespace is preserved.
        ranges: Spans with begin and end in `letters`, outer ones first.
    """

    letters: list[tuple[str, Span, bool]] = field(default_factory=list)
    ranges: list[tuple[Span, int, int]] = field(default_factory=list)


class TextReader:
    """Reads the characters of text elements.

    Args:
        context: The context within the text element.
    """

    def __init__(self, sources: Sources, context: Context) -> None:
        self._sources = sources
        self._context = context

    def read(self, element: SvgElement) -> list[Character]:
        """Returns the characters of a text element in document order."""
        raw = _RawText()
        self._walk(element, self._context.style, (), raw, self._keeps_spaces(element))
        remaining_indices = _collapse_spaces(raw.letters)
        characters = [Character(*raw.letters[index][:2]) for index in remaining_indices]
        # Number of remaining characters before each raw one.
        count, counts = 0, [0]
        remaining = set(remaining_indices)
        for index in range(len(raw.letters)):
            count += index in remaining
            counts.append(count)
        for span, begin, end in raw.ranges:
            self._position(span, characters[counts[begin] : counts[end]])
        return characters

    def _walk(
        self,
        element: SvgElement,
        style: Style,
        around: tuple[Span, ...],
        raw: _RawText,
        keeps: bool,
    ) -> None:
        span = self._span(element, style, around)
        if span is None:
            return
        begin = len(raw.letters)
        at = len(raw.ranges)
        if element.tag == "tref":
            self._add_referred(element, span, keeps, raw)
            raw.ranges.insert(at, (span, begin, len(raw.letters)))
            return
        self._add(element.text, span, keeps, raw)
        for child in element:
            assert isinstance(child, SvgElement)
            declared = self._sources.sheets.declared(child)
            is_shown = declared.get("display", "") != "none" and passes_conditions(child)
            if child.tag in INNER and is_shown:
                below = self._sources.sheets.inherit_style(child, style)
                inner_keeps = self._keeps_spaces(child, below, keeps)
                self._walk(child, below, (*around, span), raw, inner_keeps)
            self._add(child.tail, span, keeps, raw)
        raw.ranges.insert(at, (span, begin, len(raw.letters)))

    def _add_referred(self, element: SvgElement, span: Span, keeps: bool, raw: _RawText) -> None:
        """Adds all text of a `tref`'s target."""
        target = self._sources.document.ids.get(element.href)
        if target is None:
            self._sources.warnings.broken("<tref>", "left out", element.line)
            return
        for text in target.itertext():
            self._add(text, span, keeps, raw)

    def _add(self, text: str | None, span: Span, keeps: bool, raw: _RawText) -> None:
        if not text:
            return
        self._sources.budget.take_characters(len(text))
        if span.style.text.spaces == "preserve" or keeps:
            text = text.replace("\r\n", "\n")
        raw.letters.extend((letter, span, keeps) for letter in text)

    def _keeps_spaces(
        self, element: SvgElement, style: Style | None = None, inherited: bool = False
    ) -> bool:
        style = style or self._context.style
        if style.text.spaces:
            return style.text.spaces == "preserve"
        ancestor: SvgElement | None = element
        while ancestor is not None:
            if _XML_SPACE in ancestor.attrib:
                return ancestor.attrib[_XML_SPACE].strip() == "preserve"
            ancestor = ancestor.parent
        return inherited

    def _span(self, element: SvgElement, style: Style, around: tuple[Span, ...]) -> Span | None:
        sources = self._sources
        declared = sources.sheets.declared(element)
        path = around[-1].path if around else None
        if element.tag == "textPath":
            if path is not None or not around:
                return None
            path = self._read_path(element, style)
            if path is None:
                return None
        text_style = style.text
        override = declared.get("unicode-bidi", "").lower() in ("bidi-override", "isolate-override")
        forced = around[-1].forced if around else ""
        if override:
            forced = "R" if text_style.direction == "rtl" else "L"
        alignment = declared.get("alignment-baseline", "auto").lower()
        lines = _lines(declared)
        if not around:
            ancestor = element.parent
            while ancestor is not None:
                lines += tuple(
                    line for line in _lines(sources.sheets.declared(ancestor)) if line not in lines
                )
                ancestor = ancestor.parent
        return Span(
            element,
            style,
            around,
            lines,
            alignment if alignment not in ("auto", "baseline", "inherit") else text_style.baseline,
            declared.get("baseline-shift", "baseline").strip().lower(),
            path,
            self._read_fitted(element, style),
            forced,
            _language(element),
        )

    def _units(self, style: Style) -> Units:
        return replace(self._context, style=style).units

    def _read_path(self, element: SvgElement, style: Style) -> TextPath | None:
        """Reads the path of a `textPath`; returns None if it is missing."""
        sources, units = self._sources, self._units(style)
        declared = sources.sheets.declared(element)
        outline, matrix, shape = None, IDENTITY, None
        if element.get("path"):
            outline, _ = read_path(element.get("path", ""))
        else:
            shape = sources.document.ids.get(element.href)
            if shape is not None and shape.tag in BASIC_SHAPES:
                values = sources.sheets.declared(shape)
                outline = read_shape(shape, values, units, sources.warnings)
                matrix = parse_transform(values.get("transform", "")) or IDENTITY
        if outline is None or len(outline) < 2:
            sources.warnings.broken("<textPath>", "left out, as its path is missing", element.line)
            return None
        for name, default in (("method", "align"), ("side", "left")):
            if declared.get(name, default) != default:
                sources.warnings.unsupported(
                    f"{name} '{declared[name][:40]}'", "ignored", element.line
                )
        track = Track(outline, matrix)
        length = read_length(element, declared, "startOffset", sources.warnings) or _ZERO
        offset = length.pixels(track.length, style.font_size)
        declared_length = (
            _number(sources.sheets.declared(shape).get("pathLength")) if shape is not None else 0
        )
        if declared_length > 0.0 and length.unit != "%":
            offset *= track.length / declared_length
        return TextPath(track, offset)

    def _read_fitted(self, element: SvgElement, style: Style) -> Fitted | None:
        declared = self._sources.sheets.declared(element)
        if "textLength" not in declared:
            return None
        length = read_length(element, declared, "textLength", self._sources.warnings)
        if length is None or length.value < 0.0:
            return None
        pixels = self._units(style).pixels(length, "width")
        return Fitted(pixels, declared.get("lengthAdjust", "") == "spacingAndGlyphs")

    def _position(self, span: Span, characters: list[Character]) -> None:
        """Applies the positioning attributes of an element to its characters."""
        if span.element.tag not in ("text", "tspan", "tref"):
            return
        declared, units = self._sources.sheets.declared(span.element), self._units(span.style)
        for name in ("x", "y", "dx", "dy"):
            for character, length in zip(characters, self._lengths(span, name), strict=False):
                along = "x" if name.endswith("x") else "y"
                value = units.pixels(length, along)
                if math.isfinite(value):
                    setattr(character, name, value)
        turns = [_number(text) for text in _split_list(declared.get("rotate", ""))]
        if turns:
            for index, character in enumerate(characters):
                character.rotate = turns[min(index, len(turns) - 1)]

    def _lengths(self, span: Span, name: str) -> list[Length]:
        """Reads a list of lengths up to the first invalid one."""
        lengths = []
        for text in _split_list(self._sources.sheets.declared(span.element).get(name, "")):
            try:
                length = parse_length(text)
            except UnknownUnitError as error:
                warnings = self._sources.warnings
                warnings.unsupported(f"unit '{error}'", "ignored", span.element.line)
                break
            if length is None:
                self._sources.warnings.broken(f"{name} '{text[:40]}'", "ignored", span.element.line)
                break
            lengths.append(length)
        return lengths


def _split_list(text: str) -> list[str]:
    return text.replace(",", " ").split()


def _number(text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        return 0.0
    return value if math.isfinite(value) else 0.0


def _lines(declared: Mapping[str, str]) -> tuple[str, ...]:
    text = declared.get("text-decoration-line", declared.get("text-decoration", "")).lower()
    words = text.split()
    return tuple(line for line in _LINES if line in words)


def _language(element: SvgElement) -> str:
    ancestor: SvgElement | None = element
    while ancestor is not None:
        language = ancestor.get(_XML_LANG) or ancestor.get("lang")
        if language:
            return language.strip()[:40]
        ancestor = ancestor.parent
    return ""


def _collapse_spaces(raw: list[tuple[str, Span, bool]]) -> list[int]:
    """Collapses whitespace; returns the indices of the remaining characters."""
    remaining: list[int] = []
    # Whether a space would follow another one, or start the text.
    after_space = True
    for index, (letter, span, keeps) in enumerate(raw):
        if letter in "\t\n\r":
            letter = " "
            raw[index] = (letter, span, keeps)
        if letter == " " and not keeps:
            if after_space:
                continue
            after_space = True
        else:
            after_space = letter == " "
        remaining.append(index)
    if remaining and raw[remaining[-1]][0] == " " and not raw[remaining[-1]][2]:
        remaining.pop()
    return remaining
