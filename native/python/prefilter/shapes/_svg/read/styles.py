# SPDX-License-Identifier: GPL-3.0-or-later

"""Which properties an element has: by attributes, style sheets, its style, and its parent."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import cssselect2

from ..model.blending import BLEND_MODES
from ..model.colors import Color
from ..model.limits import TooLargeError
from ..model.values import (
    BLACK,
    Length,
    Paint,
    UnknownUnitError,
    as_color,
    as_length,
    as_lengths,
    as_number,
    as_paint,
    as_path,
    remembered,
)
from ..model.warnings import Warnings
from .document import Document, SvgElement
from .style_rules import StyleRules, declarations_in
from .text_style import (
    NO_ATTRIBUTES,
    OWN_PROPERTIES,
    PROPERTIES,
    USUAL_TEXT,
    FontRule,
    TextStyle,
    expanded_font,
    text_style_below,
)
from .variables import uses_variables, variables, with_variables

MOST_ANCESTORS = 20_000_000
"""That selectors may look at: those of several parts look at them again and again."""
_DEFAULT_FONT_SIZE = 16.0
_BLACK, _NOTHING = Paint(BLACK), Paint(None)
_ZERO, _ONE = Length(0.0), Length(1.0)
_FONT_SIZES = {
    "xx-small": 9.6,
    "x-small": 12.0,
    "small": 13.333,
    "medium": 16.0,
    "large": 19.2,
    "x-large": 24.0,
    "xx-large": 32.0,
}


@dataclass(frozen=True, slots=True)
class Style:
    """The properties of an element that count here."""

    # Those of the parent, where an element says nothing.
    color: Color = BLACK
    fill: Paint = _BLACK
    fill_opacity: float = 1.0
    fill_rule: str = "nonzero"
    font_size: float = _DEFAULT_FONT_SIZE
    paint_order: str = "normal"
    stroke: Paint = _NOTHING
    stroke_opacity: float = 1.0
    stroke_width: Length = _ONE
    stroke_linecap: str = "butt"
    stroke_linejoin: str = "miter"
    stroke_miterlimit: float = 4.0
    stroke_dasharray: tuple[Length, ...] = ()
    stroke_dashoffset: Length = _ZERO
    visibility: str = "visible"
    clip_rule: str = "nonzero"
    color_interpolation: str = "srgb"
    color_interpolation_filters: str = "linearrgb"
    image_rendering: str = "auto"
    shape_rendering: str = "auto"
    marker_start: str = "none"
    marker_mid: str = "none"
    marker_end: str = "none"
    text: TextStyle = USUAL_TEXT
    custom: tuple[tuple[str, str], ...] = ()  # properties whose names begin with --
    # Those of the element itself.
    opacity: float = 1.0
    mix_blend_mode: str = "normal"
    isolation: str = "auto"
    mask_type: str = "luminance"
    stop_color: Color | str = BLACK
    stop_opacity: float = 1.0

    def __post_init__(self) -> None:
        if not math.isfinite(self.font_size):
            object.__setattr__(self, "font_size", _DEFAULT_FONT_SIZE)


_OWN = ("opacity", "mix_blend_mode", "isolation", "mask_type", "stop_color", "stop_opacity")


def _one_of(*names: str) -> Callable[[str], str | None]:
    return lambda text: text.lower() if text.lower() in names else None


def _share(text: str) -> float | None:
    value = as_number(text)
    return None if value is None else min(max(value, 0.0), 1.0)


def _positive_length(text: str) -> Length | None:
    length = as_length(text)
    return length if length and length.value >= 0.0 else None


def _dashes(text: str) -> tuple[Length, ...] | None:
    if text.lower() == "none":
        return ()
    found = as_lengths(text)
    return None if found is None or any(length.value < 0.0 for length in found) else found


def _miter_limit(text: str) -> float | None:
    value = as_number(text)
    return value if value is not None and value >= 1.0 else None


_PARSERS: dict[str, Callable[[str], Any]] = {
    "color": as_color,
    "fill": as_paint,
    "fill-opacity": _share,
    "fill-rule": _one_of("nonzero", "evenodd"),
    "paint-order": lambda text: text.lower(),
    "stroke": as_paint,
    "stroke-opacity": _share,
    "stroke-width": _positive_length,
    "stroke-linecap": _one_of("butt", "round", "square"),
    "stroke-linejoin": _one_of("miter", "round", "bevel", "miter-clip", "arcs"),
    "stroke-miterlimit": _miter_limit,
    "stroke-dasharray": _dashes,
    "stroke-dashoffset": as_length,
    "visibility": _one_of("visible", "hidden", "collapse"),
    "clip-rule": _one_of("nonzero", "evenodd"),
    "color-interpolation": _one_of("auto", "srgb", "linearrgb"),
    "color-interpolation-filters": _one_of("auto", "srgb", "linearrgb"),
    "image-rendering": lambda text: text.lower(),
    "shape-rendering": _one_of(
        "auto", "optimizespeed", "crispedges", "geometricprecision", "inherit"
    ),
    "marker-start": lambda text: text,
    "marker-mid": lambda text: text,
    "marker-end": lambda text: text,
    "opacity": _share,
    "mix-blend-mode": _one_of(*BLEND_MODES),
    "isolation": _one_of("auto", "isolate"),
    "mask-type": _one_of("luminance", "alpha"),
    "stop-color": as_color,
    "stop-opacity": _share,
}
_STYLED = frozenset((*_PARSERS, *PROPERTIES))
_FIELDS = {name: name.replace("-", "_") for name in (*_PARSERS, "font-size")}

# What draws in another way than it would here, with the values that do nothing.
UNSUPPORTED = {
    "vector-effect": ("none", "non-scaling-stroke"),
}
# Attributes that are properties too, so that style sheets may set them.
_PLACES = ("x", "y", "cx", "cy", "r", "rx", "ry", "width", "height", "transform", "d")
INDIVIDUAL = {"translate": "--translate", "rotate": "--rotate", "scale": "--scale"}
"""Transforms that are properties and not attributes, and what they are called among both."""
_OTHER: tuple[str, ...] = ("background", "background-color", "clip-path", "display", "filter")
_OTHER += ("mask", "overflow", "flood-color", "flood-opacity", "lighting-color")
_OTHER += ("transform-origin", "transform-box")
# Those that are no attributes.
_IN_SHEETS_ONLY = frozenset(
    (
        "background",
        "background-color",
        "mix-blend-mode",
        "isolation",
        "transform-box",
        *NO_ATTRIBUTES,
    )
)
_MARKERS = ("marker-start", "marker-mid", "marker-end")
_PROPERTIES = frozenset(
    (
        *_PARSERS,
        *UNSUPPORTED,
        *_PLACES,
        *_OTHER,
        *PROPERTIES,
        *OWN_PROPERTIES,
        *INDIVIDUAL,
        "font-size",
    )
)
_SHORTHANDS = ("font", "marker")


_HELD = frozenset(INDIVIDUAL.values())
_KEYWORDS = ("initial", "unset", "revert", "revert-layer")
# What pictures that stand still do not show, or what says again how it is drawn anyway.
_WITHOUT_EFFECT = frozenset(
    (
        *("cursor", "pointer-events", "user-select", "touch-action", "will-change", "src"),
        *("text-rendering", "color-rendering", "enable-background", "solid-color", "speak"),
        *("solid-opacity", "line-height", "text-align", "text-indent", "block-progression"),
        *("font-variant-ligatures", "font-feature-settings", "outline", "outline-offset"),
        *("transition", "transition-property", "transition-duration", "transition-delay"),
        *("transition-timing-function", "marker", "margin", "padding", "box-sizing", "float"),
        *("color-profile", "shape-padding", "shape-margin", "position", "z-index", "zoom"),
        *("font-synthesis", "page-break-inside", "orphans", "widows", "backface-visibility"),
        *("text-orientation", "glyph-orientation-vertical", "glyph-orientation-horizontal"),
        *("content", "appearance", "contain", "color-scheme", "all", "fill-color"),
    )
)


def _style_below(declared: Mapping[str, str], parent: Style, font_size: float) -> Style:
    changed: dict[str, Any] = {}
    own = tuple((name, text) for name, text in declared.items() if name.startswith("--"))
    if own:
        changed["custom"] = tuple({**dict(parent.custom), **dict(own)}.items())
    if font_size != parent.font_size:
        changed["font_size"] = font_size
    if declared.keys() & PROPERTIES.keys():
        changed["text"] = text_style_below(declared, parent.text, font_size)
    for name in declared.keys() & _PARSERS.keys():
        field, text = _FIELDS[name], declared[name]
        if text in ("inherit", "initial"):
            value = getattr(parent, field) if text == "inherit" else _INITIAL[field]
        else:
            value = _parsed(name, text)
        if value is not None and not (name == "color" and value == "current"):
            changed[field] = value
    for name in _OWN:
        if name not in changed and getattr(parent, name) != _INITIAL[name]:
            changed[name] = _INITIAL[name]
    return replace(parent, **changed) if changed else parent


class _Matched(cssselect2.ElementWrapper):  # type: ignore[misc]
    """An element as selectors see it, where the root counts what they look at."""

    def __init__(self, element: SvgElement, parent: "_Matched | None", *rest: Any, **more: Any):
        super().__init__(element, parent, *rest, **more)
        self._root: _Matched = self if parent is None else parent._root
        self._ancestors_left = MOST_ANCESTORS

    @property
    def ancestors(self) -> Any:
        found = super().ancestors
        self._root._ancestors_left -= len(found)
        if self._root._ancestors_left < 0:
            raise TooLargeError(f"selectors look at more than {MOST_ANCESTORS} elements")
        return found


class StyleSheets:
    """The style sheets of a document, and what its elements declare.

    Attributes:
        font_rules: The rules `@font-face`.
    """

    def __init__(
        self, document: Document, warnings: Warnings, tell: Callable[[float], None]
    ) -> None:
        self._warnings = warnings
        self._styles: dict[SvgElement, Style] = {}
        self._declared: dict[SvgElement, dict[str, str]] = {}
        self._written: dict[SvgElement, dict[str, str]] = {}
        """What is declared, of elements that have or use variables."""
        self._custom: dict[SvgElement, dict[str, str]] = {}
        # By the parent, which is kept so that its number stays its own, and what is declared.
        self._below: dict[tuple[Any, ...], tuple[Style, Style]] = {}
        found = StyleRules(document, warnings)
        self.font_rules: list[FontRule] = found.font_rules
        matcher = None if found.is_empty else found.matcher
        wrapper = _Matched.from_xml_root(document.root)
        elements = document.root.iter() if matcher is None else wrapper.iter_subtree()
        for index, each in enumerate(elements):
            if index % 50 == 0:
                tell(index / document.count)
            if matcher is None:
                self._declared[each] = self._declarations(each, ())
            else:
                rules = [match[3] for match in matcher.match(each) if match[2] is None]
                self._declared[each.etree_element] = self._declarations(each.etree_element, rules)

    def declared(self, element: SvgElement) -> Mapping[str, str]:
        """The values of properties and attributes, as they stand in the file."""
        return self._declared[element]

    def style(self, element: SvgElement) -> Style:
        """The properties of an element where it stands."""
        line: list[SvgElement] = []
        at: SvgElement | None = element
        while at is not None and at not in self._styles:
            line.append(at)
            at = at.parent
        style = self._styles[at] if at is not None else Style()
        for each in reversed(line):
            style = self._styles[each] = self.style_below(each, style)
        return style

    def style_below(self, element: SvgElement, parent: Style) -> Style:
        """The properties of an element in a place where its parent has those given."""
        declared = self._declared[element]
        if element in self._written:
            # Variables have the values that they have where the element is brought.
            declared = substituted(self._written[element], parent.custom)
        size = parent.font_size
        if "font-size" in declared:
            size = self._font_size(declared["font-size"], parent, element)
        # Words of a text, and parts of a diagram, mostly say the same again and again.
        said = tuple(
            (name, text)
            for name, text in declared.items()
            if name in _STYLED or (name.startswith("--") and name not in _HELD)
        )
        key = (id(parent), size, said)
        found = self._below.get(key)
        if found is None:
            found = self._below[key] = (parent, _style_below(dict(said), parent, size))
        return found[1]

    def _font_size(self, text: str, parent: Style, element: SvgElement) -> float:
        if text.lower() in _FONT_SIZES:
            return _FONT_SIZES[text.lower()]
        if text.lower() in ("larger", "smaller"):
            return parent.font_size * (1.2 if text.lower() == "larger" else 1.0 / 1.2)
        try:
            length = as_length(text)
        except UnknownUnitError as error:
            self._warnings.unsupported(f"unit '{error}'", "ignored", element.line)
            length = None
        if length is None or length.value < 0.0:
            return parent.font_size
        return length.pixels(parent.font_size, parent.font_size)

    def _declarations(self, element: SvgElement, rules: Any) -> dict[str, str]:
        """By attributes, then by rules, then by the style; then those that are important."""
        found = {
            name: value.strip()
            for name, value in element.attrib.items()
            if name not in _IN_SHEETS_ONLY
        }
        own = _parsed_declarations(found.pop("style")) if "style" in found else ()
        if not rules and not own:
            return self._inherited(element, self._with_variables(element, found))
        for important in (False, True):
            for declarations in (*rules, own):
                for name, value, is_important in declarations:
                    if is_important != important:
                        continue
                    self._declare(name, value, found, element)
        return self._inherited(element, self._with_variables(element, found))

    def _declare(self, name: str, value: str, found: dict[str, str], element: SvgElement) -> None:
        """Adds what a rule says of a property."""
        if name.startswith("--"):
            found[name] = value
        elif uses_variables(value):
            if name in _SHORTHANDS or name in _PROPERTIES:
                found[INDIVIDUAL.get(name, name)] = value
            else:
                self._report_unknown(name, element)
        elif name in _SHORTHANDS:
            found.update(expanded(name, value))
        elif name not in _PROPERTIES:
            self._report_unknown(name, element)
        elif value.lower() in _KEYWORDS and name in (*_PARSERS, *_OTHER, *_PLACES, *INDIVIDUAL):
            is_initial = value.lower() == "initial" or _FIELDS.get(name) in _OWN
            if is_initial and name in _PARSERS:
                found[name] = "initial"
            else:
                found.pop(INDIVIDUAL.get(name, name), None)
        elif self._is_valid(name, value, element):
            found[INDIVIDUAL.get(name, name)] = as_path(value) or "" if name == "d" else value
        else:
            self._report_value(name, value, element)

    def _with_variables(self, element: SvgElement, found: dict[str, str]) -> dict[str, str]:
        """The same, with the values of variables."""
        around = {} if element.parent is None else self._custom.get(element.parent, {})
        has_own = any(name.startswith("--") and name not in _HELD for name in found)
        if not has_own and not any(uses_variables(text) for text in found.values()):
            if around:
                self._custom[element] = around
            return found
        self._written[element] = found
        resolved = substituted(found, tuple(around.items()))
        self._custom[element] = around | {
            name: text for name, text in resolved.items() if name.startswith("--")
        }
        for name in found.keys() - resolved.keys():
            if not name.startswith("--") and name not in _SHORTHANDS:
                self._warnings.broken(f"{name} '{found[name][:40]}'", "ignored", element.line)
        return resolved

    def _report_unknown(self, name: str, element: SvgElement) -> None:
        if name not in _WITHOUT_EFFECT and not name.startswith("-"):
            self._warnings.unsupported(name, "ignored", element.line)

    def _report_value(self, name: str, value: str, element: SvgElement) -> None:
        unit = _unknown_unit(name, value) if name in _PARSERS else ""
        if unit:
            self._warnings.unsupported(f"unit '{unit}'", "ignored", element.line)
        else:
            self._warnings.broken(f"{name} '{value[:40]}'", "ignored", element.line)

    def _inherited(self, element: SvgElement, found: dict[str, str]) -> dict[str, str]:
        """The same, where properties that are not inherited by themselves have parents' values."""
        if "inherit" in found.values():
            parent = self._declared[element.parent] if element.parent is not None else {}
            for name in [name for name in _OTHER if found.get(name) == "inherit"]:
                del found[name]
                if name == "overflow":
                    # What elements of other kinds begin with.
                    found[name] = "visible"
                if name in parent:
                    found[name] = parent[name]
        self._report(element, found)
        return found

    def _is_valid(self, name: str, value: str, element: SvgElement) -> bool:
        if name == "d":
            return as_path(value) is not None
        if name not in _PARSERS or value == "inherit":
            return True
        return _parsed(name, value) is not None

    def _report(self, element: SvgElement, found: Mapping[str, str]) -> None:
        for name in found.keys() & _PARSERS.keys():
            if found[name] in ("inherit", "initial") or _parsed(name, found[name]) is not None:
                continue
            unit = _unknown_unit(name, found[name])
            if unit:
                self._warnings.unsupported(f"unit '{unit}'", "ignored", element.line)
            else:
                self._warnings.broken(f"{name} '{found[name][:40]}'", "ignored", element.line)


def substituted(declared: Mapping[str, str], custom: tuple[tuple[str, str], ...]) -> dict[str, str]:
    """What is declared with the values of variables; what has none that is valid is left out.

    Args:
        declared: With the element's own variables.
        custom: The variables of its parent.
    """
    own = {
        name: text for name, text in declared.items() if name.startswith("--") and name not in _HELD
    }
    values = variables(own, dict(custom))
    found: dict[str, str] = {}
    for name, written in declared.items():
        if name in own:
            found[name] = values.get(name, "initial")
            continue
        text: str | None = written
        if uses_variables(written):
            text = with_variables(written, values)
        if text is None:
            continue
        if name in _SHORTHANDS:
            found.update(expanded(name, text))
        elif text is not written and name == "d":
            found[name] = as_path(text) or ""
        elif text is written or name not in _PARSERS or _parsed(name, text) is not None:
            found[name] = text
        elif text.lower() in ("inherit", "initial"):
            found[name] = text.lower()
    return found


def expanded(name: str, value: str) -> dict[str, str]:
    """The properties that a shorthand sets."""
    return dict.fromkeys(_MARKERS, value) if name == "marker" else expanded_font(value)


_INITIAL = {field.name: field.default for field in fields(Style)}


@remembered
def _parsed(name: str, text: str) -> Any:
    """The value of a property; None where the text is none."""
    try:
        return _PARSERS[name](text)
    except UnknownUnitError:
        return None


def _unknown_unit(name: str, text: str) -> str:
    try:
        _PARSERS[name](text)
    except UnknownUnitError as error:
        return str(error)
    return ""


@remembered
def _parsed_declarations(text: str) -> tuple[tuple[str, str, bool], ...]:
    return tuple(declarations_in(text))
