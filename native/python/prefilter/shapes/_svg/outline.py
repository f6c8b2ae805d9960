# SPDX-License-Identifier: GPL-3.0-or-later

"""Outlines in the units of the drawing: lines, curves, and exact arcs of ellipses."""

import math
import re
from array import array
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ... import _native
from ..shape import Shape
from .limits import MOST_SEGMENTS, TooLargeError
from .values import NUMBER, leading_numbers

_COMMAND = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])([^MmZzLlHhVvCcSsQqTtAa]*)")
_BLANK = re.compile(r"\s*", re.ASCII)
# What a number has taken, it does not give back to flags.
_WHOLE = rf"((?>{NUMBER}))\s*,?\s*"
_ARC = re.compile(rf"{3 * _WHOLE}([01])\s*,?\s*([01])\s*,?\s*{2 * _WHOLE}", re.ASCII)
_ARGUMENTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2}
# How many numbers a segment has.
_SIZES = {"M": 2, "L": 2, "Q": 4, "C": 6, "W": 5, "Z": 0}


class Outline:
    """Contours, as they are drawn.

    Their segments are: M and its point; L and its end; Q or C and the control points behind the
    start; W, a control point, its weight and the end, for a conic; Z.
    """

    def __init__(self) -> None:
        # Without an object for each segment: a file may have a million.
        self._letters = bytearray()
        self._numbers = array("d")
        self._shapes: dict[str, Shape] = {}

    def __len__(self) -> int:
        return len(self._letters)

    def segments(self) -> Iterator[tuple[str, tuple[float, ...]]]:
        """Yields each segment's letter and its numbers."""
        at = 0
        for letter in self._letters.decode():
            size = _SIZES[letter]
            yield letter, tuple(self._numbers[at : at + size])
            at += size

    def move_to(self, x: float, y: float) -> None:
        self._add(b"M", (x, y))

    def line_to(self, x: float, y: float) -> None:
        self._add(b"L", (x, y))

    def quadratic_to(self, *numbers: float) -> None:
        self._add(b"Q", numbers)

    def cubic_to(self, *numbers: float) -> None:
        self._add(b"C", numbers)

    def conic_to(self, x1: float, y1: float, weight: float, x2: float, y2: float) -> None:
        self._add(b"W", (x1, y1, weight, x2, y2))

    def close(self) -> None:
        self._add(b"Z", ())

    def extend(self, letters: bytes, numbers: "array[float]") -> None:
        """Adds segments, a letter for each, and the numbers of all of them."""
        if len(self._letters) + len(letters) > MOST_SEGMENTS:
            raise TooLargeError(f"more than {MOST_SEGMENTS} lines and curves in a path")
        self._letters += letters
        self._numbers.extend(numbers)

    def _add(self, letter: bytes, numbers: tuple[float, ...]) -> None:
        if len(self._letters) >= MOST_SEGMENTS:
            raise TooLargeError(f"more than {MOST_SEGMENTS} lines and curves in a path")
        self._letters += letter
        self._numbers.extend(numbers)

    def ellipse(self, cx: float, cy: float, rx: float, ry: float) -> None:
        """A whole ellipse, from its right side on over its lower one (with y downwards)."""
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
        """A rectangle whose corners are quarters of ellipses."""
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

    def arc_to(
        self,
        start: tuple[float, float],
        radii: tuple[float, float],
        rotation: float,
        is_large: bool,
        is_positive: bool,
        end: tuple[float, float],
    ) -> None:
        """An arc of an ellipse between two points, as conics of a quarter or less.

        See "Conversion from endpoint to center parameterization" in the appendix of SVG 1.1, F.6.5.
        """
        rx, ry = abs(radii[0]), abs(radii[1])
        if start == end:
            return
        if rx == 0.0 or ry == 0.0:
            self.line_to(*end)
            return
        cos, sin = _native.cos(math.radians(rotation)), _native.sin(math.radians(rotation))
        half_x, half_y = (start[0] - end[0]) / 2.0, (start[1] - end[1]) / 2.0
        # The start seen from the middle of the chord, where the ellipse is a unit circle.
        x = (cos * half_x + sin * half_y) / rx
        y = (cos * half_y - sin * half_x) / ry
        squared = x * x + y * y
        if squared > 1.0:
            rx, ry = rx * math.sqrt(squared), ry * math.sqrt(squared)
            x, y, squared = x / math.sqrt(squared), y / math.sqrt(squared), 1.0
        if not 0.0 < squared <= 1.0 or not math.isfinite(rx * ry):
            self.line_to(*end)
            return
        toward_center = math.sqrt((1.0 - squared) / squared)
        if is_large == is_positive:
            toward_center = -toward_center
        center_x, center_y = toward_center * y, -toward_center * x
        first = _native.atan2(y - center_y, x - center_x)
        turn = _native.atan2(-y - center_y, -x - center_x) - first
        if is_positive and turn <= 0.0:
            turn += 2.0 * math.pi
        elif not is_positive and turn >= 0.0:
            turn -= 2.0 * math.pi
        middle = ((start[0] + end[0]) / 2.0, (start[1] + end[1]) / 2.0)

        def placed(u: float, v: float) -> tuple[float, float]:
            u, v = rx * (u + center_x), ry * (v + center_y)
            return (middle[0] + cos * u - sin * v, middle[1] + sin * u + cos * v)

        count = max(1, math.ceil(abs(turn) / (math.pi / 2.0) - 1e-9))
        weight = _native.cos(turn / count / 2.0)
        for k in range(count):
            peak, after = first + turn * (k + 0.5) / count, first + turn * (k + 1) / count
            control = placed(_native.cos(peak) / weight, _native.sin(peak) / weight)
            there = end if k == count - 1 else placed(_native.cos(after), _native.sin(after))
            self.conic_to(*control, weight, *there)

    def bounds(self) -> tuple[float, float, float, float] | None:
        """The smallest box: left, top, right, bottom; None without a point."""
        points = list(self._extremes())
        if not points:
            return None
        xs, ys = zip(*points, strict=True)
        return min(xs), min(ys), max(xs), max(ys)

    def is_box(self) -> bool:
        """Whether it is one upright rectangle."""
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
        """How long it is at most: as long as the lines from control point to control point."""
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
        """The outline as a shape, made once."""
        if fill_rule not in self._shapes:
            shape = Shape(fill_rule=fill_rule)
            shape.add_path(self._letters.decode(), np.array(self._numbers))
            self._shapes[fill_rule] = shape
        return self._shapes[fill_rule]

    def _extremes(self) -> Iterator[tuple[float, float]]:
        """Ends, and points of curves where one coordinate is largest or smallest."""
        at = begin = (0.0, 0.0)
        has_begun = False
        following = (self._letters + b"M")[1:].decode()
        for (kind, numbers), letter_after in zip(self.segments(), following, strict=True):
            if kind == "M":
                at = begin = (numbers[0], numbers[1])
                # A move that draws nothing does not count.
                has_begun = letter_after != "M"
                if has_begun:
                    yield at
                continue
            if kind == "Z":
                at = begin
                continue
            end = (numbers[-2], numbers[-1])
            yield end
            if kind != "L":
                weight = numbers[2] if kind == "W" else 1.0
                inner = numbers[:2] if kind == "W" else numbers[:-2]
                controls = [at, *zip(inner[::2], inner[1::2], strict=True), end]
                for axis in (0, 1):
                    for t in _turning_points([point[axis] for point in controls], weight):
                        yield _point_at(controls, weight, t)
            at = end


def _turning_points(values: list[float], weight: float) -> list[float]:
    """Where in (0, 1) a coordinate of a curve has no slope."""
    if len(values) == 4:
        d0, d1, d2 = (values[k + 1] - values[k] for k in range(3))
        a, b, c = d0 - 2.0 * d1 + d2, 2.0 * (d1 - d0), d0
    else:
        # Of the quotient of two quadratics; the weights at the ends are 1.
        d0, d1, d2 = values[1] - values[0], values[2] - values[1], values[2] - values[0]
        a = (weight - 1.0) * d2
        b = d2 - 2.0 * weight * d0
        c = weight * d0
    # The sum of both roots is -b / a, and their product c / a.
    discriminant = b * b - 4.0 * a * c
    if discriminant < 0.0:
        return []
    q = -0.5 * (b + math.copysign(math.sqrt(discriminant), b))
    roots = [n / d for n, d in ((q, a), (c, q)) if d != 0.0]
    return [t for t in roots if 0.0 < t < 1.0]


def _point_at(controls: list[tuple[float, float]], weight: float, t: float) -> tuple[float, float]:
    s = 1.0 - t
    if len(controls) == 4:
        shares = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    else:
        shares = [s * s, 2.0 * weight * s * t, t * t]
    total = sum(shares)
    x = sum(share * point[0] for share, point in zip(shares, controls, strict=True)) / total
    y = sum(share * point[1] for share, point in zip(shares, controls, strict=True)) / total
    return x, y


def read_path(text: str) -> tuple[Outline, bool]:
    """The outline that path data draw up to their first error, and whether there is none."""
    outline = Outline()
    pen = _PathPen(outline)
    position = len(text) - len(text.lstrip())
    for match in _COMMAND.finditer(text):
        if match.start() != position or not pen.draw(match[1], match[2]):
            return outline, False
        position = match.end()
    return outline, position == len(text)


class _PathPen:
    """Draws the commands of path data."""

    def __init__(self, outline: Outline) -> None:
        self._outline = outline
        self._at = (0.0, 0.0)
        self._begin = (0.0, 0.0)
        self._mirrored = ("", 0.0, 0.0)
        self._has_begun = False

    def draw(self, letter: str, text: str) -> bool:
        """One command, as often as its arguments repeat it; returns whether all of it is valid."""
        name = letter.lower()
        if not self._has_begun and name != "m":
            return False
        self._has_begun = True
        if name == "z":
            self._outline.close()
            self._at, self._mirrored = self._begin, ("", 0.0, 0.0)
            return not text.strip()
        if name == "a":
            return self._arcs(letter == "a", text)
        numbers, is_whole = leading_numbers(text)
        count = _ARGUMENTS[name]
        for k in range(0, len(numbers) - count + 1, count):
            self._segment(name, letter == name, numbers[k : k + count])
            if name == "m":
                name, letter = "l", "l" if letter == "m" else "L"
        return is_whole and len(numbers) >= count and len(numbers) % count == 0

    def _segment(self, name: str, is_relative: bool, numbers: list[float]) -> None:
        x, y = self._at
        if name in "hv":
            from_x, from_y = (x, y) if is_relative else (0.0, 0.0)
            ends = [from_x + numbers[0], y] if name == "h" else [x, from_y + numbers[0]]
        elif is_relative:
            ends = [value + (y if k % 2 else x) for k, value in enumerate(numbers)]
        else:
            ends = numbers
        mirrored = ("", 0.0, 0.0)
        if name == "m":
            self._outline.move_to(*ends)
            self._begin = (ends[0], ends[1])
        elif name in "lhv":
            self._outline.line_to(*ends)
        elif name in "cs":
            first = ends[:2] if name == "c" else self._mirror("c")
            self._outline.cubic_to(*first, *ends[-4:])
            mirrored = ("c", ends[-4], ends[-3])
        else:
            control = ends[:2] if name == "q" else self._mirror("q")
            self._outline.quadratic_to(*control, *ends[-2:])
            mirrored = ("q", control[0], control[1])
        self._mirrored = mirrored
        self._at = (ends[-2], ends[-1])

    def _mirror(self, kind: str) -> list[float]:
        """The last control point on the other side, if a curve of the same kind has one."""
        x, y = self._at
        if self._mirrored[0] != kind:
            return [x, y]
        return [2.0 * x - self._mirrored[1], 2.0 * y - self._mirrored[2]]

    def _arcs(self, is_relative: bool, text: str) -> bool:
        self._mirrored = ("", 0.0, 0.0)
        position = len(text) - len(text.lstrip())
        is_whole = False
        while match := _ARC.match(text, position):
            rx, ry, rotation, x, y = (float(match[k]) for k in (1, 2, 3, 6, 7))
            if not all(map(math.isfinite, (rx, ry, rotation, x, y))):
                return False
            end = (self._at[0] + x, self._at[1] + y) if is_relative else (x, y)
            self._outline.arc_to(
                self._at, (rx, ry), rotation, match[4] == "1", match[5] == "1", end
            )
            self._at = end
            position = match.end()
            is_whole = position == len(text)
        return is_whole
