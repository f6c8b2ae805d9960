# SPDX-License-Identifier: GPL-3.0-or-later

"""The characters of a text element, each with its style and what is said of its place."""

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
"""Elements whose text is part of the text element around them."""
_XML_SPACE = "{http://www.w3.org/XML/1998/namespace}space"
_XML_LANG = "{http://www.w3.org/XML/1998/namespace}lang"
_LINES = ("underline", "overline", "line-through")
_ZERO = Length(0.0)


@dataclass(frozen=True, slots=True, eq=False)
class BaseFolder:
    """A path that text runs along.

    Attributes:
        offset: Where on it the text is, as `startOffset`.
    """

    track: Track
    offset: float


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """How long the text of an element is to be.

    Attributes:
        length: In its units.
        is_stretched: Whether letters become wider, too.
    """

    length: float
    is_stretched: bool


@dataclass(frozen=True, slots=True, eq=False)
class Span:
    """The text of one element, without that of those in it.

    Attributes:
        element: It.
        style: Its properties.
        around: The spans of the elements around it, the outermost first; itself the last.
        lines: What its text is decorated with itself.
        baseline: What of its letters is at their position.
        shift: `baseline-shift`, as it stands in the file.
        place: The path that it runs along.
        fitted: How long it is to be.
        forced: "L" or "R" where its letters go in one direction, whatever they are.
        language: Of its text; empty where the file does not say.
    """

    element: SvgElement
    style: Style
    around: tuple["Span", ...] = ()
    lines: tuple[str, ...] = ()
    baseline: str = "auto"
    shift: str = "baseline"
    place: BaseFolder | None = None
    fitted: Fitted | None = None
    forced: str = ""
    language: str = ""

    @property
    def text(self) -> TextStyle:
        """The style of its letters."""
        return self.style.text

    def line(self) -> Iterator["Span"]:
        """Yields the spans around it and itself, the outermost first."""
        yield from self.around
        yield self


@dataclass(slots=True)
class Character:
    """One of a text.

    Attributes:
        x: Where it is, where the file says so.
        y: Likewise.
        dx: How far it is moved.
        dy: Likewise.
        rotate: How far it is turned, in degrees.
    """

    letter: str
    span: Span
    x: float | None = None
    y: float | None = None
    dx: float = 0.0
    dy: float = 0.0
    rotate: float = 0.0


@dataclass(slots=True)
class _Found:
    """What was read so far.

    Attributes:
        raw: Letters, their span, and whether their spaces stay.
        ranges: Spans with where they begin and end in that, outer ones first.
    """

    raw: list[tuple[str, Span, bool]] = field(default_factory=list)
    ranges: list[tuple[Span, int, int]] = field(default_factory=list)


class TextReader:
    """Reads the characters of text elements.

    Args:
        sources: What elements are read with.
        context: Within the text element.
    """

    def __init__(self, sources: Sources, context: Context) -> None:
        self._sources = sources
        self._context = context

    def read(self, element: SvgElement) -> list[Character]:
        """The characters of a text element, in the order of the file."""
        found = _Found()
        self._walk(element, self._context.style, (), found, self._keeps_spaces(element))
        kept = _collapsed(found.raw)
        characters = [Character(*found.raw[index][:2]) for index in kept]
        # How many characters are left before each of those that were read.
        count, counts = 0, [0]
        remaining = set(kept)
        for index in range(len(found.raw)):
            count += index in remaining
            counts.append(count)
        for span, begin, end in found.ranges:
            self._position(span, characters[counts[begin] : counts[end]])
        return characters

    def _walk(
        self,
        element: SvgElement,
        style: Style,
        around: tuple[Span, ...],
        found: _Found,
        keeps: bool,
    ) -> None:
        span = self._span(element, style, around)
        if span is None:
            return
        begin = len(found.raw)
        at = len(found.ranges)
        if element.tag == "tref":
            self._add_referred(element, span, keeps, found)
            found.ranges.insert(at, (span, begin, len(found.raw)))
            return
        self._add(element.text, span, keeps, found)
        for child in element:
            assert isinstance(child, SvgElement)
            declared = self._sources.sheets.declared(child)
            is_shown = declared.get("display", "") != "none" and passes_conditions(child)
            if child.tag in INNER and is_shown:
                below = self._sources.sheets.inherit_style(child, style)
                inner_keeps = self._keeps_spaces(child, below, keeps)
                self._walk(child, below, (*around, span), found, inner_keeps)
            self._add(child.tail, span, keeps, found)
        found.ranges.insert(at, (span, begin, len(found.raw)))

    def _add_referred(self, element: SvgElement, span: Span, keeps: bool, found: _Found) -> None:
        """Adds all text of the element that a `tref` refers to."""
        target = self._sources.document.ids.get(element.href)
        if target is None:
            self._sources.warnings.broken("<tref>", "left out", element.line)
            return
        for text in target.itertext():
            self._add(text, span, keeps, found)

    def _add(self, text: str | None, span: Span, keeps: bool, found: _Found) -> None:
        if not text:
            return
        self._sources.budget.take_characters(len(text))
        if span.style.text.spaces == "preserve" or keeps:
            text = text.replace("\r\n", "\n")
        found.raw.extend((letter, span, keeps) for letter in text)

    def _keeps_spaces(
        self, element: SvgElement, style: Style | None = None, inherited: bool = False
    ) -> bool:
        style = style or self._context.style
        if style.text.spaces:
            return style.text.spaces == "preserve"
        at: SvgElement | None = element
        while at is not None:
            if _XML_SPACE in at.attrib:
                return at.attrib[_XML_SPACE].strip() == "preserve"
            at = at.parent
        return inherited

    def _span(self, element: SvgElement, style: Style, around: tuple[Span, ...]) -> Span | None:
        sources = self._sources
        declared = sources.sheets.declared(element)
        place = around[-1].place if around else None
        if element.tag == "textPath":
            if place is not None or not around:
                return None
            place = self._place(element, style)
            if place is None:
                return None
        text_style = style.text
        override = declared.get("unicode-bidi", "").lower() in ("bidi-override", "isolate-override")
        forced = around[-1].forced if around else ""
        if override:
            forced = "R" if text_style.direction == "rtl" else "L"
        aligned = declared.get("alignment-baseline", "auto").lower()
        lines = _lines(declared)
        if not around:
            at = element.parent
            while at is not None:
                lines += tuple(
                    line for line in _lines(sources.sheets.declared(at)) if line not in lines
                )
                at = at.parent
        return Span(
            element,
            style,
            around,
            lines,
            aligned if aligned not in ("auto", "baseline", "inherit") else text_style.baseline,
            declared.get("baseline-shift", "baseline").strip().lower(),
            place,
            self._fitted(element, style),
            forced,
            _language(element),
        )

    def _units(self, style: Style) -> Units:
        return replace(self._context, style=style).units

    def _place(self, element: SvgElement, style: Style) -> BaseFolder | None:
        """The path of a `textPath`; None where there is none."""
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
            sources.warnings.broken(
                "<textPath>", "left out, as its path is not there", element.line
            )
            return None
        for name, usual in (("method", "align"), ("side", "left")):
            if declared.get(name, usual) != usual:
                sources.warnings.unsupported(
                    f"{name} '{declared[name][:40]}'", "ignored", element.line
                )
        track = Track(outline, matrix)
        length = read_length(element, declared, "startOffset", sources.warnings) or _ZERO
        offset = length.pixels(track.length, style.font_size)
        said = _number(sources.sheets.declared(shape).get("pathLength")) if shape is not None else 0
        if said > 0.0 and length.unit != "%":
            offset *= track.length / said
        return BaseFolder(track, offset)

    def _fitted(self, element: SvgElement, style: Style) -> Fitted | None:
        declared = self._sources.sheets.declared(element)
        if "textLength" not in declared:
            return None
        length = read_length(element, declared, "textLength", self._sources.warnings)
        if length is None or length.value < 0.0:
            return None
        pixels = self._units(style).pixels(length, "width")
        return Fitted(pixels, declared.get("lengthAdjust", "") == "spacingAndGlyphs")

    def _position(self, span: Span, characters: list[Character]) -> None:
        """Puts what an element says of places into its characters."""
        if span.element.tag not in ("text", "tspan", "tref"):
            return
        declared, units = self._sources.sheets.declared(span.element), self._units(span.style)
        for name in ("x", "y", "dx", "dy"):
            for character, length in zip(characters, self._lengths(span, name), strict=False):
                along = "x" if name.endswith("x") else "y"
                value = units.pixels(length, along)
                if math.isfinite(value):
                    setattr(character, name, value)
        turns = [_number(text) for text in _listed(declared.get("rotate", ""))]
        if turns:
            for index, character in enumerate(characters):
                character.rotate = turns[min(index, len(turns) - 1)]

    def _lengths(self, span: Span, name: str) -> list[Length]:
        """The lengths of a list, up to the first that is none."""
        found = []
        for text in _listed(self._sources.sheets.declared(span.element).get(name, "")):
            try:
                length = parse_length(text)
            except UnknownUnitError as error:
                warnings = self._sources.warnings
                warnings.unsupported(f"unit '{error}'", "ignored", span.element.line)
                break
            if length is None:
                self._sources.warnings.broken(f"{name} '{text[:40]}'", "ignored", span.element.line)
                break
            found.append(length)
        return found


def _listed(text: str) -> list[str]:
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
    at: SvgElement | None = element
    while at is not None:
        found = at.get(_XML_LANG) or at.get("lang")
        if found:
            return found.strip()[:40]
        at = at.parent
    return ""


def _collapsed(raw: list[tuple[str, Span, bool]]) -> list[int]:
    """Which characters stay; replaces line ends and tabs by spaces."""
    kept: list[int] = []
    # A space that was there before is one where spaces are collapsed.
    is_open = True
    for index, (letter, span, keeps) in enumerate(raw):
        if letter in "\t\n\r":
            letter = " "
            raw[index] = (letter, span, keeps)
        if letter == " " and not keeps:
            if is_open:
                continue
            is_open = True
        else:
            is_open = letter == " "
        kept.append(index)
    if kept and raw[kept[-1]][0] == " " and not raw[kept[-1]][2]:
        kept.pop()
    return kept
