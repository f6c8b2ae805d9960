# SPDX-License-Identifier: GPL-3.0-or-later

"""Computed styles of elements: attributes, style sheets, the attribute `style`, and inheritance."""

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
    as_path,
    cache_short_texts,
    parse_color,
    parse_length,
    parse_lengths,
    parse_number,
    parse_paint,
)
from ..model.warnings import Warnings
from .document import Document, SvgElement
from .style_rules import StyleRules, read_declarations
from .text_style import (
    DEFAULT_TEXT_STYLE,
    NO_ATTRIBUTES,
    OWN_PROPERTIES,
    PROPERTIES,
    FontRule,
    TextStyle,
    expand_font_shorthand,
    inherit_text_style,
    keyword_parser,
)
from .variables import resolve_variables, substitute, uses_variables

MAX_ANCESTORS = 20_000_000
"""Ancestors visited when matching selectors; those of several compounds visit them repeatedly."""
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
    """Properties of an element."""

    # Inherited properties.
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
    text: TextStyle = DEFAULT_TEXT_STYLE
    custom: tuple[tuple[str, str], ...] = ()  # custom properties
    # Properties that are not inherited.
    opacity: float = 1.0
    mix_blend_mode: str = "normal"
    isolation: str = "auto"
    mask_type: str = "luminance"
    stop_color: Color | str = BLACK
    stop_opacity: float = 1.0

    def __post_init__(self) -> None:
        if not math.isfinite(self.font_size):
            object.__setattr__(self, "font_size", _DEFAULT_FONT_SIZE)


_NOT_INHERITED = (
    "opacity",
    "mix_blend_mode",
    "isolation",
    "mask_type",
    "stop_color",
    "stop_opacity",
)


def _parse_fraction(text: str) -> float | None:
    value = parse_number(text)
    return None if value is None else min(max(value, 0.0), 1.0)


def _parse_positive_length(text: str) -> Length | None:
    length = parse_length(text)
    return length if length and length.value >= 0.0 else None


def _parse_dashes(text: str) -> tuple[Length, ...] | None:
    if text.lower() == "none":
        return ()
    lengths = parse_lengths(text)
    return None if lengths is None or any(length.value < 0.0 for length in lengths) else lengths


def _parse_miter_limit(text: str) -> float | None:
    value = parse_number(text)
    return value if value is not None and value >= 1.0 else None


_PARSERS: dict[str, Callable[[str], Any]] = {
    "color": parse_color,
    "fill": parse_paint,
    "fill-opacity": _parse_fraction,
    "fill-rule": keyword_parser("nonzero", "evenodd"),
    "paint-order": lambda text: text.lower(),
    "stroke": parse_paint,
    "stroke-opacity": _parse_fraction,
    "stroke-width": _parse_positive_length,
    "stroke-linecap": keyword_parser("butt", "round", "square"),
    "stroke-linejoin": keyword_parser("miter", "round", "bevel", "miter-clip", "arcs"),
    "stroke-miterlimit": _parse_miter_limit,
    "stroke-dasharray": _parse_dashes,
    "stroke-dashoffset": parse_length,
    "visibility": keyword_parser("visible", "hidden", "collapse"),
    "clip-rule": keyword_parser("nonzero", "evenodd"),
    "color-interpolation": keyword_parser("auto", "srgb", "linearrgb"),
    "color-interpolation-filters": keyword_parser("auto", "srgb", "linearrgb"),
    "image-rendering": lambda text: text.lower(),
    "shape-rendering": keyword_parser(
        "auto", "optimizespeed", "crispedges", "geometricprecision", "inherit"
    ),
    "marker-start": lambda text: text,
    "marker-mid": lambda text: text,
    "marker-end": lambda text: text,
    "opacity": _parse_fraction,
    "mix-blend-mode": keyword_parser(*BLEND_MODES),
    "isolation": keyword_parser("auto", "isolate"),
    "mask-type": keyword_parser("luminance", "alpha"),
    "stop-color": parse_color,
    "stop-opacity": _parse_fraction,
}
_STYLE_PROPERTIES = frozenset((*_PARSERS, *PROPERTIES))
_FIELDS = {name: name.replace("-", "_") for name in (*_PARSERS, "font-size")}

# Properties that change rendering, with the values that are supported.
UNSUPPORTED = {
    "vector-effect": ("none", "non-scaling-stroke"),
}
# Geometry attributes that are also properties, so that style sheets may set them.
_GEOMETRY = ("x", "y", "cx", "cy", "r", "rx", "ry", "width", "height", "transform", "d")
INDIVIDUAL = {"translate": "--translate", "rotate": "--rotate", "scale": "--scale"}
"""Transform properties that are not attributes, and their names in `StyleSheets.declared`."""
_UNPARSED: tuple[str, ...] = ("background", "background-color", "clip-path", "display", "filter")
_UNPARSED += ("mask", "overflow", "flood-color", "flood-opacity", "lighting-color")
_UNPARSED += ("transform-origin", "transform-box")
# Properties that are not presentation attributes.
_NO_ATTRIBUTES = frozenset(
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
        *_GEOMETRY,
        *_UNPARSED,
        *PROPERTIES,
        *OWN_PROPERTIES,
        *INDIVIDUAL,
        "font-size",
    )
)
_SHORTHANDS = ("font", "marker")


_TRANSFORM_KEYS = frozenset(INDIVIDUAL.values())
_KEYWORDS = ("initial", "unset", "revert", "revert-layer")
# Properties without effect on a static image, or on its rendering here.
_IGNORED = frozenset(
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


def _inherit_style(declared: Mapping[str, str], parent: Style, font_size: float) -> Style:
    changed: dict[str, Any] = {}
    own = tuple((name, text) for name, text in declared.items() if name.startswith("--"))
    if own:
        changed["custom"] = tuple({**dict(parent.custom), **dict(own)}.items())
    if font_size != parent.font_size:
        changed["font_size"] = font_size
    if declared.keys() & PROPERTIES.keys():
        changed["text"] = inherit_text_style(declared, parent.text, font_size)
    for name in declared.keys() & _PARSERS.keys():
        field, text = _FIELDS[name], declared[name]
        if text in ("inherit", "initial"):
            value = getattr(parent, field) if text == "inherit" else _INITIAL[field]
        else:
            value = _parse_property(name, text)
        if value is not None and not (name == "color" and value == "current"):
            changed[field] = value
    for name in _NOT_INHERITED:
        if name not in changed and getattr(parent, name) != _INITIAL[name]:
            changed[name] = _INITIAL[name]
    return replace(parent, **changed) if changed else parent


class _CountingWrapper(cssselect2.ElementWrapper):  # type: ignore[misc]
    """An element as selectors see it; the root counts visited ancestors."""

    def __init__(
        self, element: SvgElement, parent: "_CountingWrapper | None", *rest: Any, **more: Any
    ):
        super().__init__(element, parent, *rest, **more)
        self._root: _CountingWrapper = self if parent is None else parent._root
        self._ancestors_left = MAX_ANCESTORS

    @property
    def ancestors(self) -> Any:
        ancestors_found = super().ancestors
        self._root._ancestors_left -= len(ancestors_found)
        if self._root._ancestors_left < 0:
            raise TooLargeError(f"selectors look at more than {MAX_ANCESTORS} elements")
        return ancestors_found


class StyleSheets:
    """The style sheets and `@font-face` rules of a document, and declarations of elements."""

    def __init__(
        self, document: Document, warnings: Warnings, report: Callable[[float], None]
    ) -> None:
        self._warnings = warnings
        self._styles: dict[SvgElement, Style] = {}
        self._declared: dict[SvgElement, dict[str, str]] = {}
        self._unsubstituted: dict[SvgElement, dict[str, str]] = {}
        """Unsubstituted declarations of elements that declare or use variables."""
        self._custom: dict[SvgElement, dict[str, str]] = {}
        # Cached styles. The parent is kept, so that its id stays unique.
        self._cache: dict[tuple[Any, ...], tuple[Style, Style]] = {}
        rules = StyleRules(document, warnings)
        self.font_rules: list[FontRule] = rules.font_rules
        matcher = None if rules.is_empty else rules.matcher
        wrapper = _CountingWrapper.from_xml_root(document.root)
        elements = document.root.iter() if matcher is None else wrapper.iter_subtree()
        for index, each in enumerate(elements):
            if index % 50 == 0:
                report(index / document.count)
            if matcher is None:
                self._declared[each] = self._cascade(each, ())
            else:
                matched = [match[3] for match in matcher.match(each) if match[2] is None]
                self._declared[each.etree_element] = self._cascade(each.etree_element, matched)

    def declared(self, element: SvgElement) -> Mapping[str, str]:
        """Returns the properties and attributes of an element, as text."""
        return self._declared[element]

    def style(self, element: SvgElement) -> Style:
        """Returns the computed style of an element."""
        chain: list[SvgElement] = []
        ancestor: SvgElement | None = element
        while ancestor is not None and ancestor not in self._styles:
            chain.append(ancestor)
            ancestor = ancestor.parent
        style = self._styles[ancestor] if ancestor is not None else Style()
        for each in reversed(chain):
            style = self._styles[each] = self.inherit_style(each, style)
        return style

    def inherit_style(self, element: SvgElement, parent: Style) -> Style:
        """Returns the style of an element within a given parent style."""
        declared = self._declared[element]
        if element in self._unsubstituted:
            # Variables take their values from where `use` places the element.
            declared = substitute_variables(self._unsubstituted[element], parent.custom)
        size = parent.font_size
        if "font-size" in declared:
            size = self._font_size(declared["font-size"], parent, element)
        # Many elements, such as words of a text, have the same declarations.
        declarations = tuple(
            (name, text)
            for name, text in declared.items()
            if name in _STYLE_PROPERTIES or (name.startswith("--") and name not in _TRANSFORM_KEYS)
        )
        key = (id(parent), size, declarations)
        cached = self._cache.get(key)
        if cached is None:
            cached = self._cache[key] = (parent, _inherit_style(dict(declarations), parent, size))
        return cached[1]

    def _font_size(self, text: str, parent: Style, element: SvgElement) -> float:
        if text.lower() in _FONT_SIZES:
            return _FONT_SIZES[text.lower()]
        if text.lower() in ("larger", "smaller"):
            return parent.font_size * (1.2 if text.lower() == "larger" else 1.0 / 1.2)
        try:
            length = parse_length(text)
        except UnknownUnitError as error:
            self._warnings.unsupported(f"unit '{error}'", "ignored", element.line)
            length = None
        if length is None or length.value < 0.0:
            return parent.font_size
        return length.pixels(parent.font_size, parent.font_size)

    def _cascade(self, element: SvgElement, rules: Any) -> dict[str, str]:
        """Applies attributes, rules, the attribute `style`, then important declarations."""
        declared = {
            name: value.strip()
            for name, value in element.attrib.items()
            if name not in _NO_ATTRIBUTES
        }
        own = _parse_declarations(declared.pop("style")) if "style" in declared else ()
        if not rules and not own:
            return self._resolve_inherit(element, self._substitute(element, declared))
        for important in (False, True):
            for declarations in (*rules, own):
                for name, value, is_important in declarations:
                    if is_important != important:
                        continue
                    self._apply(name, value, declared, element)
        return self._resolve_inherit(element, self._substitute(element, declared))

    def _apply(self, name: str, value: str, declared: dict[str, str], element: SvgElement) -> None:
        """Applies a declaration."""
        if name.startswith("--"):
            declared[name] = value
        elif uses_variables(value):
            if name in _SHORTHANDS or name in _PROPERTIES:
                declared[INDIVIDUAL.get(name, name)] = value
            else:
                self._report_unknown(name, element)
        elif name in _SHORTHANDS:
            declared.update(expand_shorthand(name, value))
        elif name not in _PROPERTIES:
            self._report_unknown(name, element)
        elif value.lower() in _KEYWORDS and name in (
            *_PARSERS,
            *_UNPARSED,
            *_GEOMETRY,
            *INDIVIDUAL,
        ):
            is_initial = value.lower() == "initial" or _FIELDS.get(name) in _NOT_INHERITED
            if is_initial and name in _PARSERS:
                declared[name] = "initial"
            else:
                declared.pop(INDIVIDUAL.get(name, name), None)
        elif self._is_valid(name, value, element):
            declared[INDIVIDUAL.get(name, name)] = as_path(value) or "" if name == "d" else value
        else:
            self._report_value(name, value, element)

    def _substitute(self, element: SvgElement, declared: dict[str, str]) -> dict[str, str]:
        """Substitutes variables."""
        inherited = {} if element.parent is None else self._custom.get(element.parent, {})
        has_own = any(name.startswith("--") and name not in _TRANSFORM_KEYS for name in declared)
        if not has_own and not any(uses_variables(text) for text in declared.values()):
            if inherited:
                self._custom[element] = inherited
            return declared
        self._unsubstituted[element] = declared
        resolved = substitute_variables(declared, tuple(inherited.items()))
        self._custom[element] = inherited | {
            name: text for name, text in resolved.items() if name.startswith("--")
        }
        for name in declared.keys() - resolved.keys():
            if not name.startswith("--") and name not in _SHORTHANDS:
                self._warnings.broken(f"{name} '{declared[name][:40]}'", "ignored", element.line)
        return resolved

    def _report_unknown(self, name: str, element: SvgElement) -> None:
        if name not in _IGNORED and not name.startswith("-"):
            self._warnings.unsupported(name, "ignored", element.line)

    def _report_value(self, name: str, value: str, element: SvgElement) -> None:
        unit = _unknown_unit(name, value) if name in _PARSERS else ""
        if unit:
            self._warnings.unsupported(f"unit '{unit}'", "ignored", element.line)
        else:
            self._warnings.broken(f"{name} '{value[:40]}'", "ignored", element.line)

    def _resolve_inherit(self, element: SvgElement, declared: dict[str, str]) -> dict[str, str]:
        """Resolves `inherit` for properties that are not inherited by default."""
        if "inherit" in declared.values():
            parent = self._declared[element.parent] if element.parent is not None else {}
            for name in [name for name in _UNPARSED if declared.get(name) == "inherit"]:
                del declared[name]
                if name == "overflow":
                    # The initial value of other elements than `svg`.
                    declared[name] = "visible"
                if name in parent:
                    declared[name] = parent[name]
        for name in declared.keys() & _PARSERS.keys():
            value = declared[name]
            if value not in ("inherit", "initial") and _parse_property(name, value) is None:
                self._report_value(name, value, element)
        return declared

    def _is_valid(self, name: str, value: str, element: SvgElement) -> bool:
        if name == "d":
            return as_path(value) is not None
        if name not in _PARSERS or value == "inherit":
            return True
        return _parse_property(name, value) is not None


def substitute_variables(
    declared: Mapping[str, str], custom: tuple[tuple[str, str], ...]
) -> dict[str, str]:
    """Substitutes variables in declarations; those without a valid result are omitted.

    Args:
        declared: Declarations, including the element's custom properties.
        custom: Custom properties of the parent.
    """
    own = {
        name: text
        for name, text in declared.items()
        if name.startswith("--") and name not in _TRANSFORM_KEYS
    }
    values = resolve_variables(own, dict(custom))
    substituted: dict[str, str] = {}
    for name, written in declared.items():
        if name in own:
            substituted[name] = values.get(name, "initial")
            continue
        text: str | None = written
        if uses_variables(written):
            text = substitute(written, values)
        if text is None:
            continue
        if name in _SHORTHANDS:
            substituted.update(expand_shorthand(name, text))
        elif text is not written and name == "d":
            substituted[name] = as_path(text) or ""
        elif text is written or name not in _PARSERS or _parse_property(name, text) is not None:
            substituted[name] = text
        elif text.lower() in ("inherit", "initial"):
            substituted[name] = text.lower()
    return substituted


def expand_shorthand(name: str, value: str) -> dict[str, str]:
    """Expands a shorthand."""
    return dict.fromkeys(_MARKERS, value) if name == "marker" else expand_font_shorthand(value)


_INITIAL = {field.name: field.default for field in fields(Style)}


@cache_short_texts
def _parse_property(name: str, text: str) -> Any:
    """Parses a property; returns None if invalid."""
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


@cache_short_texts
def _parse_declarations(text: str) -> tuple[tuple[str, str, bool], ...]:
    return tuple(read_declarations(text))
