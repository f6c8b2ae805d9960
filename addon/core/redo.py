# SPDX-License-Identifier: GPL-3.0-or-later

"""Adjust Last Operation: the expected duration of a redo, and the texts of its panel."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bpy

from .sidebar import wrapped
from .translations import tr
from .wording import Sentence

QUICK_SECONDS = 1.0
"""Shorter work is redone at once when a setting changes; longer work would freeze Blender, so it
waits for Apply."""
_LINE_LENGTH = 44
"""Letters in a line of a redo panel."""
_pasts: dict[str, "Past"] = {}
"""The last runs of operators, by their identifiers."""


@dataclass(frozen=True)
class Past:
    """The duration of an operator's last run, from which that of a redo is estimated."""

    seconds: float
    load: Any
    duration: float


def past(key: str) -> Past | None:
    """Returns the last run of an operator, by its identifier."""
    return _pasts.get(key)


def note(key: str, run: Past) -> None:
    """Stores the last run of an operator."""
    _pasts[key] = run


def expected_seconds(key: str, duration: Callable[[Any], float]) -> float:
    """Returns how long an operator is expected to take; 0 if unknown.

    Args:
        key: Its identifier.
        duration: `OperatorHooks.duration` with the present settings.
    """
    run = past(key)
    if run is None:
        return 0.0
    try:
        return run.seconds * duration(run.load) / run.duration
    except ValueError:  # Invalid settings, which the work reports at once.
        return 0.0


class Deadline:
    """A progress callback that stops the work after some time."""

    def __init__(self, seconds: float) -> None:
        self._began = time.monotonic()
        self._seconds = seconds
        self._fraction = 0.0

    def __call__(self, fraction: float) -> bool:
        self._fraction = fraction
        return time.monotonic() - self._began < self._seconds

    def expected_seconds(self) -> float:
        """Estimates the duration of the whole work."""
        passed = time.monotonic() - self._began
        return max(passed / max(self._fraction, 0.1), 2.0 * self._seconds)


def draw_problem(layout: bpy.types.UILayout, problem: str) -> None:
    """Draws why settings cannot be applied."""
    for i, line in enumerate(wrapped(problem, _LINE_LENGTH)):
        layout.label(text=line, icon="BLANK1" if i else "ERROR")


def apply_text(seconds: float) -> str:
    """Returns the label of Apply with the expected seconds, or "Applied" if these are 0."""
    return tr("Apply (about {})").format(_rounded(seconds)) if seconds else tr("Applied")


@contextmanager
def in_place_of(replaced: int, context: bpy.types.Context, *, is_undoable: bool) -> Iterator[None]:
    """Undoes the operator to replace; redoes it if the context raises.

    Args:
        replaced: The pointer of the last operator; 0 for none.
        context: The context.
        is_undoable: Whether the operator supports undo.
    """
    is_undone = False
    if replaced:
        last = context.active_operator
        if last is None or last.as_pointer() != replaced:
            raise ValueError(Sentence("Not applied: something else has changed in the meantime"))
        if is_undoable:
            bpy.ops.ed.undo()
            is_undone = True
    try:
        yield
    except BaseException:
        if is_undone:
            bpy.ops.ed.redo()
        raise


def _rounded(seconds: float) -> str:
    return f"{max(seconds, 1.0):.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
