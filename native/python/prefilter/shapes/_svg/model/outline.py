# SPDX-License-Identifier: GPL-3.0-or-later

"""Outlines in user units: lines, Bezier curves, and exact elliptical arcs."""

import math
import re
from array import array
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from .... import _native
from ...affine import Matrix
from ...shape import Shape
from .limits import MAX_SEGMENTS, TooLargeError

# Numbers per segment.
_SIZES = {"M": 2, "L": 2, "Q": 4, "C": 6, "W": 5, "Z": 0}


class Outline:
    """Contours made of segments.

    Segments are M and its point; L and its end; Q or C, its control points and end; W, a control
    point, its weight and the end, for a conic; Z.
    """

    def __init__(self) -> None:
        # Compact arrays, as a file may have a million segments.
        self._letters = bytearray()
        self._numbers = array("d")
        self._shapes: dict[str, Shape] = {}

    def __len__(self) -> int:
        return len(self._letters)

    def segments(self) -> Iterator[tuple[str, tuple[float, ...]]]:
        """Yields each segment's letter and numbers."""
        at = 0
        for letter in self._letters.decode():
            size = _SIZES[letter]
            yield letter, tuple(self._numbers[at : at + size])
            at += size

    def move_to(self, x: float, y: float) -> None:
        self._add(b"M", (x, y))

    def line_to(self, x: float, y: float) -> None:
        self._add(b"L", (x, y))

    def conic_to(self, x1: float, y1: float, weight: float, x2: float, y2: float) -> None:
        self._add(b"W", (x1, y1, weight, x2, y2))

    def close(self) -> None:
        self._add(b"Z", ())

    def extend(self, letters: bytes, numbers: "array[float]") -> None:
        """Appends segments: one letter each, and all their numbers."""
        if len(self._letters) + len(letters) > MAX_SEGMENTS:
            raise _too_many()
        self._letters += letters
        self._numbers.extend(numbers)

    def _add(self, letter: bytes, numbers: tuple[float, ...]) -> None:
        if len(self._letters) >= MAX_SEGMENTS:
            raise _too_many()
        self._letters += letter
        self._numbers.extend(numbers)

    def transformed(self, matrix: Matrix) -> "Outline":
        """Returns the outline under an affine map."""
        moved = Outline()
        a, b, c, d, e, f = matrix
        for letter, numbers in self.segments():
            weight = numbers[2:3] if letter == "W" else ()
            points = numbers[:2] + numbers[3:] if letter == "W" else numbers
            pairs = zip(points[::2], points[1::2], strict=True)
            mapped = [v for x, y in pairs for v in (a * x + c * y + e, b * x + d * y + f)]
            moved._add(letter.encode(), (*mapped[:2], *weight, *mapped[2:]))
        return moved

    def ellipse(self, cx: float, cy: float, rx: float, ry: float) -> None:
        """Adds an ellipse, from its rightmost point through the largest y."""
        self.move_to(cx + rx, cy)
        for (x1, y1), (x2, y2) in (
            ((1, 1), (0, 1)),
            ((-1, 1), (-1, 0)),
            ((-1, -1), (0, -1)),
            ((1, -1), (1, 0)),
        ):
            self.conic_to(cx + rx * x1, cy + ry * y1, math.sqrt(0.5), cx + rx * x2, cy + ry * y2)
        self.close()

    def rectangle(
        self, x: float, y: float, width: float, height: float, rx: float, ry: float
    ) -> None:
        """Adds a rectangle with elliptical corners."""
        right, bottom = x + width, y + height
        is_round = rx > 0.0 and ry > 0.0
        if not is_round:
            rx = ry = 0.0
        corners = (
            ((right - rx, y), (right, y), (right, y + ry)),
            ((right, bottom - ry), (right, bottom), (right - rx, bottom)),
            ((x + rx, bottom), (x, bottom), (x, bottom - ry)),
            ((x, y + ry), (x, y), (x + rx, y)),
        )
        self.move_to(x + rx, y)
        for index, (before, corner, after) in enumerate(corners):
            if is_round:
                self.line_to(*before)
                self.conic_to(*corner, math.sqrt(0.5), *after)
            elif index < 3:
                self.line_to(*corner)
        self.close()

    def bounds(self) -> tuple[float, float, float, float] | None:
        """Returns the bounding box; None without a point."""
        return _native.drawn_box(bytes(self._letters), np.array(self._numbers))

    def is_box(self) -> bool:
        """Returns whether the outline is a single axis-aligned rectangle."""
        if not re.fullmatch("MLLLL?Z?", self._letters.decode()):
            return False
        bounds = self.bounds()
        if bounds is None:
            return False
        points = [numbers for _, numbers in self.segments() if numbers]
        if len(points) == 5 and points[4] != points[0]:
            return False
        turns = {(bool(a[0] - b[0]), bool(a[1] - b[1])) for a, b in pairwise(points[:4])}
        corners = {(x, y) for x in bounds[::2] for y in bounds[1::2]}
        return set(points[:4]) == corners and turns == {(True, False), (False, True)}

    def length(self) -> float:
        """Returns an upper bound of the length: that of the control polygon."""
        total = 0.0
        x, y = begin = (0.0, 0.0)
        for kind, numbers in self.segments():
            points = numbers[:2] + numbers[3:] if kind == "W" else (numbers or begin)
            for next_x, next_y in zip(points[::2], points[1::2], strict=True):
                total += _native.hypot(next_x - x, next_y - y) if kind != "M" else 0.0
                x, y = next_x, next_y
            if kind == "M":
                begin = (x, y)
        return total

    def shape(self, fill_rule: str) -> Shape:
        """Returns the outline as a shape, cached."""
        if fill_rule not in self._shapes:
            shape = Shape(fill_rule=fill_rule)
            shape.add_path(self._letters.decode(), np.array(self._numbers))
            self._shapes[fill_rule] = shape
        return self._shapes[fill_rule]


def _too_many() -> TooLargeError:
    return TooLargeError(f"more than {MAX_SEGMENTS} lines and curves in a path")


def read_path(text: str) -> tuple[Outline, bool]:
    """Reads path data up to the first error; returns whether there was none, too."""
    letters, numbers, is_complete = _native.read_path(text.encode(errors="replace"), MAX_SEGMENTS)
    if letters is None or numbers is None:
        raise _too_many()
    outline = Outline()
    outline.extend(letters, array("d", numbers))
    return outline, is_complete
