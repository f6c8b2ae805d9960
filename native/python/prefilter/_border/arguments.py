# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks and conversions of arguments that several public functions take."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from .names import WrapMode

ProgressCallback = Callable[[float], bool | None]
Wrap = WrapMode | tuple[WrapMode, WrapMode]
Bounds = tuple[float | None, float | None]
Check = Callable[[Any], object]
Options = TypeVar("Options")
Item = TypeVar("Item")
# A tuple, because isinstance with a union would build that union at each call.
WHOLE = (int, np.integer)
_OTHER = object()


def as_name(argument: str, name: object) -> str:
    if not isinstance(name, str):
        raise ValueError(f"{argument}: {name!r}; a name is needed")
    return name.encode(errors="replace").decode()


def as_one_of(argument: str, name: str, allowed: Collection[str]) -> str:
    if not isinstance(name, str) or name not in allowed:
        raise ValueError(f"{argument}: {name!r} is not one of {', '.join(allowed)}")
    return name


def set_options(
    options: Options,
    checks: Mapping[str, Check],
    arguments: Mapping[str, object],
    defaults: Mapping[str, object] | None = None,
) -> Options:
    """Sets options of the native module from a function's arguments of the same names.

    A check raises ValueError, or returns the value for the native module. Functions and native
    options have equal defaults: arguments identical to those in `defaults` are not set again, which
    saves time in calls that draw little.
    """
    known = {} if defaults is None else defaults
    for name, check in checks.items():
        value = arguments[name]
        if known.get(name, _OTHER) is not value:
            setattr(options, name, check(value))
    return options


def as_wrap(wrap: Wrap) -> tuple[str, str]:
    pair = (wrap, wrap) if isinstance(wrap, str) else wrap
    if not _is_pair(pair) or not all(isinstance(mode, str) for mode in pair):
        raise ValueError(f"wrap: {wrap!r}; one name, or a pair of names for u and v, is needed")
    return as_name("wrap", pair[0]), as_name("wrap", pair[1])


def as_bounds(bounds: Bounds | None) -> Bounds:
    pair = (None, None) if bounds is None else bounds
    if not _is_pair(pair) or not all(
        limit is None or isinstance(limit, int | float | np.number) for limit in pair
    ):
        raise ValueError(f"bounds: {bounds!r}; a pair (low, high) of numbers or None is needed")
    low, high = pair
    return (None if low is None else float(low), None if high is None else float(high))


def _is_pair(value: object) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim > 0 and len(value) == 2  # Others have no length.
    return isinstance(value, Sequence) and len(value) == 2


def as_items(argument: str, items: Iterable[Item], needed: str) -> list[Item]:
    """Returns the items of a sequence as a list; `needed` names the type in the error message."""
    try:
        return list(items)
    except TypeError:
        raise ValueError(f"{argument}: {items!r}; {needed} is needed") from None


def as_progress(progress: ProgressCallback | None) -> ProgressCallback | None:
    if progress is not None and not callable(progress):
        raise ValueError(f"progress: {progress!r}; a callable of one number is needed, or None")
    return progress


def progress_part(
    progress: ProgressCallback | None, low: float, high: float
) -> ProgressCallback | None:
    """Returns a callback for the share from `low` to `high` of the work."""
    checked = as_progress(progress)
    if checked is None:
        return None
    return lambda fraction: checked(low + (high - low) * fraction)


def as_level_count(levels: int | None) -> int:
    if levels is None:
        return 0
    if isinstance(levels, bool) or not isinstance(levels, WHOLE) or levels < 1:
        raise ValueError(f"levels: {levels!r}; a whole number of at least 1 is needed, or None")
    # More levels than any image has, but still an int: the native module reports the error.
    return min(int(levels), 2**30)


def as_size(argument: str, size: int) -> int:
    if isinstance(size, bool) or not isinstance(size, WHOLE) or not 1 <= size <= 2**20:
        raise ValueError(f"{argument}: {size!r}; a whole number from 1 to {2**20} is needed")
    return int(size)


def as_int(argument: str, value: int, allowed: str) -> int:
    """Returns an int that fits the native module, which checks its range."""
    is_int = isinstance(value, WHOLE) and not isinstance(value, bool)
    if not is_int or not -(2**31) <= value < 2**31:
        raise ValueError(f"{argument}: {value!r}; {allowed}")
    return int(value)


def as_number(argument: str, number: float) -> float:
    if isinstance(number, bool) or not isinstance(number, int | float | np.number):
        raise ValueError(f"{argument}: {number!r}; a number is needed")
    return float(number)


def is_srgb(encoding: str) -> bool:
    return as_one_of("encoding", encoding, ("linear", "srgb")) == "srgb"
