# SPDX-License-Identifier: GPL-3.0-or-later

"""Text properties: fonts, spacing, direction."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import tinycss2

from ..model.values import UnknownUnitError, parse_length, parse_number
from .external_resources import BaseFolder

_STRETCHES = {
    "ultra-condensed": 50.0,
    "extra-condensed": 62.5,
    "condensed": 75.0,
    "semi-condensed": 87.5,
    "normal": 100.0,
    "semi-expanded": 112.5,
    "expanded": 125.0,
    "extra-expanded": 150.0,
    "ultra-expanded": 200.0,
}
_GENERIC_SIZES = frozenset(
    ("xx-small", "x-small", "small", "medium", "large", "x-large", "xx-large")
)
_SIZE = re.compile(r"[+-]?(?:\d|\.\d)|(?:larger|smaller)\b", re.ASCII)
_SPACES = {"normal": "collapse", "nowrap": "collapse", "pre-line": "collapse"}
_SPACES |= {"pre": "preserve", "pre-wrap": "preserve", "break-spaces": "preserve"}
_HEAVIER = ((350.0, 400.0), (550.0, 700.0), (900.0, 900.0), (math.inf, 0.0))
_LIGHTER = ((100.0, 0.0), (550.0, 100.0), (750.0, 400.0), (math.inf, 700.0))


@dataclass(frozen=True, slots=True)
class TextStyle:
    """Inherited text properties of an element.

    Attributes:
        families: Font families in order of preference; empty if the file names none.
        weight: 1 to 1000.
        stretch: Percentage of the normal width.
        slant: "normal", "italic" or "oblique".
        variations: Axis values of variable fonts.
        has_small_capitals: Whether lower-case letters become small capitals.
        has_kerning: Whether kerning is on.
        letter_spacing: After each letter, in pixels.
        word_spacing: At each space, in pixels.
        anchor: The part of a line at its position: "start", "middle" or "end".
        direction: "ltr" or "rtl".
        baseline: The height within a letter that is at the position: `dominant-baseline`.
        spaces: "collapse", "preserve", or "" to follow `xml:space`.
        is_vertical: Whether lines go downwards: `writing-mode` of the text element.
    """

    families: tuple[str, ...] = ()
    weight: float = 400.0
    stretch: float = 100.0
    slant: str = "normal"
    variations: tuple[tuple[str, float], ...] = ()
    has_small_capitals: bool = False
    has_kerning: bool = True
    letter_spacing: float = 0.0
    word_spacing: float = 0.0
    anchor: str = "start"
    direction: str = "ltr"
    baseline: str = "auto"
    spaces: str = ""
    is_vertical: bool = False


DEFAULT_TEXT_STYLE = TextStyle()
"""Initial values."""


@dataclass(frozen=True, slots=True)
class FontRule:
    """An `@font-face` rule, with its descriptors, its line, and folders to resolve addresses."""

    line: int
    descriptors: Mapping[str, str]
    base: BaseFolder | None = None


def inherit_text_style(
    declared: Mapping[str, str], parent: TextStyle, font_size: float
) -> TextStyle:
    """Returns the text properties of an element whose parent has the given ones."""
    changed: dict[str, Any] = {}
    for name in declared.keys() & PROPERTIES.keys():
        text = declared[name].strip()
        field, parse = PROPERTIES[name]
        if text.lower() == "inherit":
            continue
        if text.lower() in ("initial", "unset"):
            value = getattr(DEFAULT_TEXT_STYLE, field)
        elif name == "font-weight":
            value = _parse_weight(text.lower(), parent.weight)
        elif name in ("letter-spacing", "word-spacing"):
            value = _parse_spacing(text, font_size)
        else:
            value = parse(text)
        if value is not None:
            changed[field] = value
    return replace(parent, **changed) if changed else parent


def expand_font_shorthand(text: str) -> dict[str, str]:
    """Expands the shorthand `font`; returns nothing if it is invalid."""
    words = text.split()
    longhands = dict.fromkeys(_SHORTHAND, "normal")
    for index, word in enumerate(words):
        word_lower = word.lower()
        size = word_lower.partition("/")[0]
        if size in _GENERIC_SIZES or (_SIZE.match(word_lower) and not _is_weight(word_lower)):
            following = words[index + 1 :]
            if following[:1] and following[0].startswith("/"):
                following = following[2:] if following[0] == "/" else following[1:]
            elif word_lower.endswith("/"):
                following = following[1:]
            if not following:
                return {}
            return {
                **longhands,
                "font-kerning": "auto",
                "font-size": size,
                "font-family": " ".join(following),
            }
        if word_lower in ("italic", "oblique"):
            longhands["font-style"] = word_lower
        elif word_lower == "small-caps":
            longhands["font-variant"] = word_lower
        elif word_lower in _STRETCHES and word_lower != "normal":
            longhands["font-stretch"] = word_lower
        elif word_lower in ("bold", "bolder", "lighter") or _is_weight(word_lower):
            longhands["font-weight"] = word_lower
        elif word_lower != "normal":
            return {}
    return {}


_SHORTHAND = ("font-style", "font-variant", "font-stretch", "font-weight")


def _is_weight(text: str) -> bool:
    value = parse_number(text)
    return value is not None and value >= 1.0 and text.isdigit()


def _parse_families(text: str) -> tuple[str, ...] | None:
    """Parses a list of families; quoted names may contain anything."""
    families: list[str] = []
    words: list[str] = []
    for token in [*tinycss2.parse_component_value_list(text, skip_comments=True), ","]:
        if token == ",":
            if not words:
                return None
            families.append(" ".join(words))
            words = []
        elif token.type in ("string", "ident"):
            words.append(token.value)
        elif token.type != "whitespace":
            words.append(tinycss2.serialize([token]))
    return tuple(families)


def _parse_weight(text: str, parent: float) -> float | None:
    for name, table in (("bolder", _HEAVIER), ("lighter", _LIGHTER)):
        if text == name:
            return next(to or parent for below, to in table if parent < below)
    if text in ("normal", "bold"):
        return 700.0 if text == "bold" else 400.0
    value = parse_number(text)
    return value if value is not None and 1.0 <= value <= 1000.0 else None


def _parse_stretch(text: str) -> float | None:
    small = text.lower()
    if small in _STRETCHES:
        return _STRETCHES[small]
    value = parse_number(small[:-1]) if small.endswith("%") else None
    return value if value is not None and value >= 0.0 else None


def _parse_slant(text: str) -> str | None:
    small = text.lower().split()[:1]
    return small[0] if small and small[0] in ("normal", "italic", "oblique") else None


def _parse_spacing(text: str, font_size: float) -> float | None:
    if text.lower() == "normal":
        return 0.0
    try:
        length = parse_length(text)
    except UnknownUnitError:
        return None
    return None if length is None else length.pixels(font_size, font_size)


def _parse_variations(text: str) -> tuple[tuple[str, float], ...] | None:
    if text.lower() == "normal":
        return ()
    settings = []
    for part in text.split(","):
        match = re.fullmatch(r"""\s*["']([ -~]{4})["']\s+(\S+)\s*""", part)
        value = parse_number(match[2]) if match else None
        if match is None or value is None:
            return None
        settings.append((match[1], value))
    return tuple(settings)


def keyword_parser(*names: str) -> Callable[[str], str | None]:
    return lambda text: text.lower() if text.lower() in names else None


_VERTICAL_MODES = ("tb", "tb-rl", "vertical-rl", "vertical-lr")
_HORIZONTAL_MODES = ("lr", "lr-tb", "rl", "rl-tb", "horizontal-tb")


def _parse_writing_mode(text: str) -> bool | None:
    small = text.lower()
    return small in _VERTICAL_MODES if small in (*_VERTICAL_MODES, *_HORIZONTAL_MODES) else None


_IGNORED_BASELINES = ("no-change", "reset-size", "use-script")
_ANCHORS = keyword_parser("start", "middle", "end")
# Field and parser of each property.
PROPERTIES: Mapping[str, tuple[str, Callable[[str], Any]]] = {
    "font-family": ("families", _parse_families),
    "font-weight": ("weight", lambda text: None),
    "font-stretch": ("stretch", _parse_stretch),
    "font-width": ("stretch", _parse_stretch),
    "font-style": ("slant", _parse_slant),
    "font-variation-settings": ("variations", _parse_variations),
    "font-variant": ("has_small_capitals", lambda text: "small-caps" in text.lower().split()),
    "font-variant-caps": ("has_small_capitals", lambda text: text.lower() == "small-caps"),
    "font-kerning": ("has_kerning", lambda text: text.lower() != "none"),
    "letter-spacing": ("letter_spacing", lambda text: None),
    "word-spacing": ("word_spacing", lambda text: None),
    "text-anchor": ("anchor", _ANCHORS),
    "direction": ("direction", keyword_parser("ltr", "rtl")),
    "dominant-baseline": (
        "baseline",
        lambda text: None if text.lower() in _IGNORED_BASELINES else text.lower(),
    ),
    "writing-mode": ("is_vertical", _parse_writing_mode),
    "white-space": ("spaces", lambda text: _SPACES.get(text.lower())),
    "white-space-collapse": ("spaces", lambda text: _SPACES.get(text.lower(), text.lower())),
}
OWN_PROPERTIES = (
    *("alignment-baseline", "baseline-shift", "text-decoration", "text-decoration-line"),
    "unicode-bidi",
)
"""Properties that are not inherited."""
NO_ATTRIBUTES = (
    *("font", "font-kerning", "font-variation-settings", "font-variant-caps", "font-width"),
    *("text-decoration-line", "white-space-collapse"),
)
"""Properties that are not presentation attributes."""
