# SPDX-License-Identifier: GPL-3.0-or-later

"""CSS numbers with units, and the results of calc() and other math functions."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

Quantity: TypeAlias = dict[str, float]
"""A sum of terms by their unit in lower case: "" for numbers, "%", "px", "em", "deg", ..."""

DEGREES = {"deg": 1.0, "grad": 0.9, "rad": 180.0 / math.pi, "turn": 360.0}
_MAX_NESTED = 32
_FUNCTIONS = frozenset(("calc", "min", "max", "clamp", "abs", "sign", "round", "mod", "rem"))
_CONSTANTS = {"pi": math.pi, "e": math.e}


def is_calculation(token: Any) -> bool:
    return token.type == "function" and token.lower_name in _FUNCTIONS


def evaluate_quantity(
    token: Any, units: Mapping[str, tuple[str, float]], names: Mapping[str, float] | None = None
) -> Quantity | None:
    """Evaluates a number, dimension, percentage or calculation; returns None if the token is none.

    Args:
        units: Conversions: from a unit's name to another unit and a factor.
        names: Identifiers with numeric values.
    """
    try:
        quantity = _evaluate_value(token, units, names or {}, 0)
    except (ZeroDivisionError, OverflowError):
        return None
    if quantity is None or not all(map(math.isfinite, quantity.values())):
        return None
    return quantity


def _evaluate_value(
    token: Any, units: Mapping[str, tuple[str, float]], names: Mapping[str, float], depth: int
) -> Quantity | None:
    if depth > _MAX_NESTED:
        return None
    match token.type:
        case "number":
            return {"": float(token.value)}
        case "percentage":
            return {"%": float(token.value)}
        case "dimension":
            unit, factor = units.get(token.lower_unit, (token.lower_unit, 1.0))
            return {unit: token.value * factor}
        case "ident":
            word = token.lower_value
            value = names.get(word, _CONSTANTS.get(word) if depth else None)
            return None if value is None else {"": value}
        case "() block":
            return _evaluate_sum(token.content, units, names, depth + 1) if depth else None
        case "function" if token.lower_name in _FUNCTIONS:
            return _evaluate_function(token, units, names, depth + 1)
    return None


def _evaluate_function(token: Any, units: Any, names: Any, depth: int) -> Quantity | None:
    parts: list[list[Any]] = [[]]
    for each in token.arguments:
        if each == ",":
            parts.append([])
        else:
            parts[-1].append(each)
    values = [_evaluate_sum(part, units, names, depth) for part in parts]
    operands = [each for each in values if each is not None]
    if len(operands) < len(values):
        return None
    name = token.lower_name
    if name == "calc":
        return operands[0] if len(operands) == 1 else None
    if name == "abs" and len(operands) == 1 and len(operands[0]) == 1:
        return {unit: abs(value) for unit, value in operands[0].items()}
    # Comparisons need a common unit.
    kinds = {unit for each in operands for unit in each}
    if len(kinds) != 1:
        return None
    unit = next(iter(kinds))
    numbers = [each[unit] for each in operands]
    result = _apply_function(name, numbers)
    if result is None:
        return None
    return {"" if name == "sign" else unit: result}


def _apply_function(name: str, numbers: Sequence[float]) -> float | None:
    match name, numbers:
        case "min", [_, *_]:
            return min(numbers)
        case "max", [_, *_]:
            return max(numbers)
        case "clamp", [low, value, high]:
            return max(low, min(value, high))
        case "sign", [value]:
            return float((value > 0.0) - (value < 0.0))
        case "round", [value]:
            return float(math.floor(value + 0.5))
        case "round", [value, step]:
            return math.floor(value / step + 0.5) * step
        case "mod", [value, step]:
            return value - math.floor(value / step) * step
        case "rem", [value, step]:
            return math.fmod(value, step)
    return None


def _evaluate_sum(tokens: Sequence[Any], units: Any, names: Any, depth: int) -> Quantity | None:
    """Evaluates products separated by + and -, which must have whitespace on both sides."""
    tokens = [token for token in tokens if token.type != "comment"]
    total: Quantity = {}
    sign, product = 1.0, list[Any]()
    for index, token in enumerate([*tokens, None]):
        is_sign = token is not None and token in ("+", "-")
        if is_sign and 0 < index < len(tokens) - 1:
            around = tokens[index - 1], tokens[index + 1]
            if any(each.type != "whitespace" for each in around):
                return None
        if token is not None and not is_sign:
            product.append(token)
            continue
        value = _evaluate_product(
            [each for each in product if each.type != "whitespace"], units, names, depth
        )
        if value is None:
            return None
        for unit, number in value.items():
            total[unit] = total.get(unit, 0.0) + sign * number
        # A number cannot be added to a length.
        if "" in total and len(total) > 1:
            return None
        sign, product = (-1.0 if token == "-" else 1.0), []
    return total


def _evaluate_product(tokens: Sequence[Any], units: Any, names: Any, depth: int) -> Quantity | None:
    if len(tokens) % 2 == 0:
        return None
    total: Quantity | None = _evaluate_value(tokens[0], units, names, depth)
    for operator, token in zip(tokens[1::2], tokens[2::2], strict=True):
        value = _evaluate_value(token, units, names, depth)
        if total is None or value is None:
            return None
        if operator == "*" and value.keys() == {""}:
            total = {unit: number * value[""] for unit, number in total.items()}
        elif operator == "*" and total.keys() == {""}:
            total = {unit: number * total[""] for unit, number in value.items()}
        elif operator == "/" and value.keys() == {""}:
            total = {unit: number / value[""] for unit, number in total.items()}
        else:
            return None
    return total
