# SPDX-License-Identifier: GPL-3.0-or-later

"""Colors of CSS Color 4 and 5, converted to sRGB and clamped to its gamut.

Each color function becomes a color space, three components and an alpha; `None` is the keyword
`none`. Matrices and transfer functions are from section 10 of the specification.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import tinycss2.color4

from .calculations import DEGREES, Quantity, evaluate_quantity
from .color_spaces import POLAR, RGB_SPACES, convert_color

Color: TypeAlias = tuple[float, float, float, float]
"""Red, green, blue and alpha in [0, 1]; sRGB, straight alpha."""
_MAX_NESTED = 8
_ANGLES = {unit: ("", factor) for unit, factor in DEGREES.items()}
# Value of 100 % for each component, None for hues; and the names of components.
_RANGES = {
    "rgb": (255.0, 255.0, 255.0),
    "hsl": (None, 100.0, 100.0),
    "hwb": (None, 100.0, 100.0),
    "lab": (100.0, 125.0, 125.0),
    "lch": (100.0, 150.0, None),
    "oklab": (1.0, 0.4, 0.4),
    "oklch": (1.0, 0.4, None),
}
_ALIASES = {"rgba": "rgb", "hsla": "hsl"}
_LETTERS = {"rgb": "rgb", "hsl": "hsl", "hwb": "hwb", "lab": "lab", "lch": "lch"}
_LETTERS |= {"oklab": "lab", "oklch": "lch"}
_LEGACY = ("rgb", "hsl")
_HUE_METHODS = ("shorter", "longer", "increasing", "decreasing")


@dataclass(frozen=True, slots=True)
class SpaceColor:
    """A color in a color space. `None` is a missing component."""

    space: str
    values: tuple[float | None, float | None, float | None]
    alpha: float | None = 1.0


def color_from_token(token: Any) -> Color | str | None:
    """Converts a token to a color, or to "current" for currentcolor; returns None if it is no
    color.
    """
    color = _parse_token(token, 0)
    return color if color is None or isinstance(color, str) else _to_srgb(color)


def _to_srgb(color: SpaceColor) -> Color | None:
    values = convert_color([value or 0.0 for value in color.values], color.space, "srgb")
    limited = [min(max(float(value), 0.0), 1.0) for value in (*values, color.alpha or 0.0)]
    if not np.isfinite(limited).all():
        return None
    return (limited[0], limited[1], limited[2], limited[3])


def _parse_token(token: Any, depth: int) -> SpaceColor | str | None:
    if depth > _MAX_NESTED or token is None:
        return None
    if token.type in ("ident", "hash"):
        parsed = tinycss2.color4.parse_color(token)
        if parsed is None or isinstance(parsed, str):
            return "current" if parsed else None
        red, green, blue = parsed.coordinates
        return SpaceColor("srgb", (red, green, blue), parsed.alpha)
    if token.type != "function":
        return None
    name = _ALIASES.get(token.lower_name, token.lower_name)
    tokens = [each for each in token.arguments if each.type not in ("whitespace", "comment")]
    if name == "color-mix":
        return _parse_color_mix(tokens, depth)
    if name == "light-dark":
        parts = _split_at_commas(tokens)
        parsed = [_parse_token(part[0], depth + 1) if len(part) == 1 else None for part in parts]
        return parsed[0] if len(parsed) == 2 and None not in parsed else None
    if name in _RANGES or name == "color":
        return _parse_function(name, tokens, depth)
    return None


def _split_at_commas(tokens: Sequence[Any]) -> list[list[Any]]:
    parts: list[list[Any]] = [[]]
    for token in tokens:
        if token == ",":
            parts.append([])
        else:
            parts[-1].append(token)
    return parts


def _parse_function(name: str, tokens: list[Any], depth: int) -> SpaceColor | None:
    origin = None
    if len(tokens) > 1 and tokens[0].type == "ident" and tokens[0].lower_value == "from":
        origin_color = _parse_token(tokens[1], depth + 1)
        if not isinstance(origin_color, SpaceColor):
            return None
        origin, tokens = origin_color, tokens[2:]
    space, ranges = name, _RANGES.get(name, (1.0, 1.0, 1.0))
    if name == "color":
        space = tokens[0].lower_value if tokens and tokens[0].type == "ident" else ""
        space = "xyz-d65" if space == "xyz" else space
        if space not in RGB_SPACES and space not in ("xyz-d65", "xyz-d50"):
            return None
        tokens = tokens[1:]
    names = _component_names(name, space, origin) if origin is not None else {}
    if any(token == "," for token in tokens):
        return _parse_legacy(name, tokens) if origin is None else None
    alpha_tokens: list[Any] | None = None
    for index, token in enumerate(tokens):
        if token == "/":
            tokens, alpha_tokens = tokens[:index], tokens[index + 1 :]
            break
    if len(tokens) != 3 or (alpha_tokens is not None and len(alpha_tokens) != 1):
        return None
    values = [_component(token, whole, names) for token, whole in zip(tokens, ranges, strict=True)]
    alpha: Any = 1.0 if origin is None else origin.alpha
    if alpha_tokens is not None:
        alpha = _component(alpha_tokens[0], 1.0, names)
    if any(value == "" for value in (*values, alpha)):
        return None
    return _limit_components(name, space, values, alpha)


def _parse_legacy(name: str, tokens: list[Any]) -> SpaceColor | None:
    """Parses the comma syntax, which has no `none` and the same unit for red, green and blue."""
    parts = _split_at_commas(tokens)
    if name not in _LEGACY or len(parts) not in (3, 4) or any(len(part) != 1 for part in parts):
        return None
    tokens = [part[0] for part in parts]
    kinds = {token.type for token in tokens[:3]}
    if name == "rgb" and "percentage" in kinds and "number" in kinds:
        return None
    if name == "hsl" and any(token.type == "number" for token in tokens[1:3]):
        return None
    values = [
        _component(token, whole, {}) for token, whole in zip(tokens, _RANGES[name], strict=False)
    ]
    alpha = _component(tokens[3], 1.0, {}) if len(tokens) == 4 else 1.0
    if any(value in ("", None) for value in (*values, alpha)):
        return None
    return _limit_components(name, name, values, alpha)


def _component(token: Any, whole: float | None, names: Mapping[str, float]) -> Any:
    """Parses a component: a number, None for `none`, or "" if invalid. Without `whole` it is an
    angle.
    """
    if token.type == "ident" and token.lower_value == "none":
        return None
    quantity: Quantity | None = evaluate_quantity(token, _ANGLES if whole is None else {}, names)
    if (
        quantity is None
        or len(quantity) > 1
        or (quantity and next(iter(quantity)) not in ("", "%"))
    ):
        return ""
    if "%" in quantity:
        return "" if whole is None else quantity["%"] * whole / 100.0
    return quantity.get("", 0.0)


def _limit_components(name: str, space: str, values: Sequence[Any], alpha: Any) -> SpaceColor:
    a, b, c = values
    if name == "rgb":
        space = "srgb"
        a, b, c = (None if value is None else value / 255.0 for value in values)
    elif name in ("hsl", "hwb"):
        b, c = (None if value is None else min(max(value, 0.0), 100.0) for value in (b, c))
    elif name in ("lab", "lch", "oklab", "oklch"):
        a = None if a is None else min(max(a, 0.0), _RANGES[name][0] or 0.0)
        if name in ("lch", "oklch"):
            b = None if b is None else max(b, 0.0)
    return SpaceColor(space, (a, b, c), None if alpha is None else min(max(alpha, 0.0), 1.0))


def _component_names(name: str, space: str, origin: SpaceColor) -> dict[str, float]:
    """Returns the components of the origin color, by their names in a relative color."""
    target = "srgb" if name == "rgb" else space
    values = convert_color([value or 0.0 for value in origin.values], origin.space, target)
    scale = 255.0 if name == "rgb" else 1.0
    letters = _LETTERS.get(name, "xyz" if space.startswith("xyz") else "rgb")
    names = {letter: float(value) * scale for letter, value in zip(letters, values, strict=True)}
    return names | {"alpha": origin.alpha or 0.0}


def _parse_color_mix(tokens: list[Any], depth: int) -> SpaceColor | None:
    """Evaluates `color-mix()`: CSS Color 5, section 3."""
    parts = _split_at_commas(tokens)
    how = [token.lower_value for token in parts[0] if token.type == "ident"]
    if len(parts) == 2:
        parts, how = [[], *parts], ["in", "oklab"]
    if len(parts) != 3 or len(how) < 2 or how[0] != "in" or len(how) < len(parts[0]):
        return None
    space = {"xyz": "xyz-d65"}.get(how[1], how[1])
    hue = how[2] if len(how) > 2 else "shorter"
    is_known = space in _RANGES or space in RGB_SPACES or space in ("xyz-d65", "xyz-d50")
    if not is_known or space == "rgb" or hue not in _HUE_METHODS:
        return None
    colors: list[SpaceColor] = []
    shares: list[float | None] = []
    for part in parts[1:]:
        share = None
        color_tokens = []
        for token in part:
            quantity = evaluate_quantity(token, {})
            if quantity is not None and quantity.keys() == {"%"}:
                share = quantity["%"]
            else:
                color_tokens.append(token)
        color = _parse_token(color_tokens[0], depth + 1) if len(color_tokens) == 1 else None
        if not isinstance(color, SpaceColor) or (share is not None and not 0.0 <= share <= 100.0):
            return None
        colors.append(color)
        shares.append(share)
    first, second = shares
    if first is None:
        first = 50.0 if second is None else 100.0 - second
    second = 100.0 - first if second is None else second
    if first + second == 0.0:
        return None
    return _mix(colors, space, hue, second / (first + second), min((first + second) / 100.0, 1.0))


def _mix(
    colors: Sequence[SpaceColor], space: str, hue: str, share: float, opacity: float
) -> SpaceColor:
    """Interpolates between two colors; `share` is the weight of the second one."""
    both = [_to_space(color, space) for color in colors]
    values: list[list[float | None]] = [list(each.values) for each in both]
    alphas = [each.alpha for each in both]
    for one, other in ((0, 1), (1, 0)):
        for index in range(3):
            if values[one][index] is None:
                values[one][index] = values[other][index]
        if alphas[one] is None:
            alphas[one] = alphas[other]
    whole = [1.0 if alpha is None else alpha for alpha in alphas]
    alpha = whole[0] + share * (whole[1] - whole[0])
    mixed: list[float | None] = []
    for index in range(3):
        low, high = values[0][index], values[1][index]
        if low is None or high is None:
            mixed.append(None)
        elif index == POLAR.get(space):
            mixed.append(low + share * _hue_difference(low % 360.0, high % 360.0, hue))
        else:
            # Premultiplied by alpha.
            sum_ = (1.0 - share) * low * whole[0] + share * high * whole[1]
            mixed.append(sum_ / alpha if alpha > 0.0 else (1.0 - share) * low + share * high)
    return SpaceColor(space, (mixed[0], mixed[1], mixed[2]), alpha * opacity)


def _hue_difference(low: float, high: float, hue: str) -> float:
    """Returns the signed hue difference to interpolate over, in degrees."""
    difference = high - low
    if hue == "shorter":
        return (
            difference - 360.0
            if difference > 180.0
            else difference + 360.0
            if difference < -180.0
            else difference
        )
    if hue == "longer":
        return (
            difference - 360.0
            if 0.0 < difference < 180.0
            else difference + 360.0
            if -180.0 < difference <= 0.0
            else difference
        )
    if hue == "increasing":
        return difference + 360.0 if difference < 0.0 else difference
    return difference - 360.0 if difference > 0.0 else difference


def _to_space(color: SpaceColor, space: str) -> SpaceColor:
    """Converts a color to another space; powerless hues become missing."""
    if color.space == space:
        return color
    values: list[float | None] = [
        float(value)
        for value in convert_color([value or 0.0 for value in color.values], color.space, space)
    ]
    hue = POLAR.get(space)
    if hue is not None:
        chroma = values[1] or 0.0
        is_gray = chroma <= {"lch": 0.0015, "oklch": 0.000004}.get(space, 0.001)
        if space == "hwb":
            is_gray = (values[1] or 0.0) + (values[2] or 0.0) >= 99.999
        if is_gray:
            values[hue] = None
        # A missing hue stays missing between polar spaces.
        before = POLAR.get(color.space)
        if before is not None and color.values[before] is None:
            values[hue] = None
    return SpaceColor(space, (values[0], values[1], values[2]), color.alpha)
