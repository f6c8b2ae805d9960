# SPDX-License-Identifier: GPL-3.0-or-later

"""Adjust Last Operation: how long a redo is expected to take, and what its panel says."""

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
"""Work up to this long is redone at once when a user changes a setting; longer work waits for
Apply, as it would freeze Blender."""
_LINE_LENGTH = 44
"""What fits into a redo panel."""
_pasts: dict[str, "Past"] = {}
"""The last runs of operators, by their identifiers."""


@dataclass(frozen=True)
class Past:
    """How long the last run of an operator took, to tell how long a redo will."""

    seconds: float
    load: Any
    duration: float


def past(key: str) -> Past | None:
    """Returns the last run of an operator, by its identifier."""
    return _pasts.get(key)


def note(key: str, run: Past) -> None:
    """Keeps the last run of an operator."""
    _pasts[key] = run


def expected_seconds(key: str, duration: Callable[[Any], float]) -> float:
    """Returns how long an operator is expected to take; 0 where nothing tells.

    Args:
        key: Its identifier.
        duration: What `Doing.duration` says of the present settings.
    """
    run = past(key)
    if run is None:
        return 0.0
    try:
        return run.seconds * duration(run.load) / run.duration
    except ValueError:  # Settings that are refused: the work says why, at once.
        return 0.0


class Deadline:
    """Progress that says to stop after some time."""

    def __init__(self, seconds: float) -> None:
        self._began = time.monotonic()
        self._seconds = seconds
        self._fraction = 0.0

    def __call__(self, fraction: float) -> bool:
        self._fraction = fraction
        return time.monotonic() - self._began < self._seconds

    def expected_seconds(self) -> float:
        """Returns how long all of the work would take, as far as that can be told."""
        passed = time.monotonic() - self._began
        return max(passed / max(self._fraction, 0.1), 2.0 * self._seconds)


def draw_problem(layout: bpy.types.UILayout, problem: str) -> None:
    """Draws why settings cannot be applied."""
    for i, line in enumerate(wrapped(problem, _LINE_LENGTH)):
        layout.label(text=line, icon="BLANK1" if i else "ERROR")


def apply_text(seconds: float) -> str:
    """Returns what the button says: how many seconds it takes; 0 if there is nothing to apply."""
    return tr("Apply (about {})").format(_spoken(seconds)) if seconds else tr("Applied")


@contextmanager
def in_place_of(replaced: int, context: bpy.types.Context, *, is_undoable: bool) -> Iterator[None]:
    """Undoes an operator that is replaced; brings that back where nothing replaces it.

    Args:
        replaced: The last operator as a pointer; 0 for none.
        context: The context.
        is_undoable: Whether there is something to undo.
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


def _spoken(seconds: float) -> str:
    return f"{max(seconds, 1.0):.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
