# SPDX-License-Identifier: GPL-3.0-or-later

"""The properties of letters: which font they have, and how they follow each other."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import tinycss2

from ..model.values import UnknownUnitError, as_length, as_number
from .external_resources import Place

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
    """What an element's text takes from those around it.

    Attributes:
        families: The best first; none where the file names none.
        weight: From 1 to 1000.
        stretch: In percent of the normal width.
        slant: "normal", "italic" or "oblique".
        variations: Values of axes of the font.
        has_small_capitals: Whether small letters are small capitals.
        has_kerning: Whether pairs are moved together.
        letter_spacing: Behind each letter, in pixels.
        word_spacing: At each space, likewise.
        anchor: What of it is at its position: "start", "middle" or "end".
        direction: "ltr" or "rtl".
        baseline: What of a letter is at its position: as `dominant-baseline`.
        spaces: "collapse", "preserve", or "" for what `xml:space` says.
        is_vertical: Whether lines go downwards: as `writing-mode` of the text element says.
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


USUAL_TEXT = TextStyle()
"""That of text of which a file says nothing."""


@dataclass(frozen=True, slots=True)
class FontRule:
    """A rule `@font-face` of a style sheet.

    Attributes:
        line: Where it is.
        said: What it declares.
        place: Where addresses in it lead from.
    """

    line: int
    said: Mapping[str, str]
    place: Place | None = None


def text_style_below(declared: Mapping[str, str], parent: TextStyle, font_size: float) -> TextStyle:
    """The style of an element's text in a place where its parent has that given.

    Args:
        declared: What the element declares.
        parent: The style of its parent.
        font_size: Of the element.
    """
    changed: dict[str, Any] = {}
    for name in declared.keys() & PROPERTIES.keys():
        text = declared[name].strip()
        field, parse = PROPERTIES[name]
        if text.lower() == "inherit":
            continue
        if text.lower() in ("initial", "unset"):
            found = getattr(USUAL_TEXT, field)
        elif name == "font-weight":
            found = _weight(text.lower(), parent.weight)
        elif name in ("letter-spacing", "word-spacing"):
            found = _spacing(text, font_size)
        else:
            found = parse(text)
        if found is not None:
            changed[field] = found
    return replace(parent, **changed) if changed else parent


def expanded_font(text: str) -> dict[str, str]:
    """What the shorthand `font` declares; nothing where it is not valid."""
    words = text.split()
    found = dict.fromkeys(_SHORTHAND, "normal")
    for index, word in enumerate(words):
        small = word.lower()
        size = small.partition("/")[0]
        if size in _GENERIC_SIZES or (_SIZE.match(small) and not _is_weight(small)):
            rest = words[index + 1 :]
            if rest[:1] and rest[0].startswith("/"):
                rest = rest[2:] if rest[0] == "/" else rest[1:]
            elif small.endswith("/"):
                rest = rest[1:]
            if not rest:
                return {}
            return {
                **found,
                "font-kerning": "auto",
                "font-size": size,
                "font-family": " ".join(rest),
            }
        if small in ("italic", "oblique"):
            found["font-style"] = small
        elif small == "small-caps":
            found["font-variant"] = small
        elif small in _STRETCHES and small != "normal":
            found["font-stretch"] = small
        elif small in ("bold", "bolder", "lighter") or _is_weight(small):
            found["font-weight"] = small
        elif small != "normal":
            return {}
    return {}


_SHORTHAND = ("font-style", "font-variant", "font-stretch", "font-weight")


def _is_weight(text: str) -> bool:
    value = as_number(text)
    return value is not None and value >= 1.0 and text.isdigit()


def _families(text: str) -> tuple[str, ...] | None:
    """Names in their order; those in quotes may hold anything."""
    found: list[str] = []
    words: list[str] = []
    for token in [*tinycss2.parse_component_value_list(text, skip_comments=True), ","]:
        if token == ",":
            if not words:
                return None
            found.append(" ".join(words))
            words = []
        elif token.type in ("string", "ident"):
            words.append(token.value)
        elif token.type != "whitespace":
            words.append(tinycss2.serialize([token]))
    return tuple(found)


def _weight(text: str, parent: float) -> float | None:
    for name, table in (("bolder", _HEAVIER), ("lighter", _LIGHTER)):
        if text == name:
            return next(to or parent for below, to in table if parent < below)
    if text in ("normal", "bold"):
        return 700.0 if text == "bold" else 400.0
    value = as_number(text)
    return value if value is not None and 1.0 <= value <= 1000.0 else None


def _stretch(text: str) -> float | None:
    small = text.lower()
    if small in _STRETCHES:
        return _STRETCHES[small]
    value = as_number(small[:-1]) if small.endswith("%") else None
    return value if value is not None and value >= 0.0 else None


def _slant(text: str) -> str | None:
    small = text.lower().split()[:1]
    return small[0] if small and small[0] in ("normal", "italic", "oblique") else None


def _spacing(text: str, font_size: float) -> float | None:
    if text.lower() == "normal":
        return 0.0
    try:
        length = as_length(text)
    except UnknownUnitError:
        return None
    return None if length is None else length.pixels(font_size, font_size)


def _variations(text: str) -> tuple[tuple[str, float], ...] | None:
    if text.lower() == "normal":
        return ()
    found = []
    for part in text.split(","):
        match = re.fullmatch(r"""\s*["']([ -~]{4})["']\s+(\S+)\s*""", part)
        value = as_number(match[2]) if match else None
        if match is None or value is None:
            return None
        found.append((match[1], value))
    return tuple(found)


def _one_of(*names: str) -> Callable[[str], str | None]:
    return lambda text: text.lower() if text.lower() in names else None


_DOWNWARDS = ("tb", "tb-rl", "vertical-rl", "vertical-lr")
_ONWARDS = ("lr", "lr-tb", "rl", "rl-tb", "horizontal-tb")


def _is_vertical(text: str) -> bool | None:
    small = text.lower()
    return small in _DOWNWARDS if small in (*_DOWNWARDS, *_ONWARDS) else None


_KEPT_BASELINES = ("no-change", "reset-size", "use-script")
_ANCHORS = _one_of("start", "middle", "end")
# The field of each property, and what reads it.
PROPERTIES: Mapping[str, tuple[str, Callable[[str], Any]]] = {
    "font-family": ("families", _families),
    "font-weight": ("weight", lambda text: None),
    "font-stretch": ("stretch", _stretch),
    "font-width": ("stretch", _stretch),
    "font-style": ("slant", _slant),
    "font-variation-settings": ("variations", _variations),
    "font-variant": ("has_small_capitals", lambda text: "small-caps" in text.lower().split()),
    "font-variant-caps": ("has_small_capitals", lambda text: text.lower() == "small-caps"),
    "font-kerning": ("has_kerning", lambda text: text.lower() != "none"),
    "letter-spacing": ("letter_spacing", lambda text: None),
    "word-spacing": ("word_spacing", lambda text: None),
    "text-anchor": ("anchor", _ANCHORS),
    "direction": ("direction", _one_of("ltr", "rtl")),
    "dominant-baseline": (
        "baseline",
        lambda text: None if text.lower() in _KEPT_BASELINES else text.lower(),
    ),
    "writing-mode": ("is_vertical", _is_vertical),
    "white-space": ("spaces", lambda text: _SPACES.get(text.lower())),
    "white-space-collapse": ("spaces", lambda text: _SPACES.get(text.lower(), text.lower())),
}
OWN_PROPERTIES = (
    *("alignment-baseline", "baseline-shift", "text-decoration", "text-decoration-line"),
    "unicode-bidi",
)
"""Those that only count for the element itself."""
NO_ATTRIBUTES = (
    *("font", "font-kerning", "font-variation-settings", "font-variant-caps", "font-width"),
    *("text-decoration-line", "white-space-collapse"),
)
"""Those that are no attributes."""
