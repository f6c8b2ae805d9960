# SPDX-License-Identifier: GPL-3.0-or-later

"""Path data read by regular expressions, with arcs as points rather than as curves."""

import cmath
import math
import re

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_NUMBER = re.compile(NUMBER, re.ASCII)
_SEPARATOR = re.compile(r"\s*,?\s*", re.ASCII)
_COMMAND = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])([^MmZzLlHhVvCcSsQqTtAa]*)")
_WHOLE = rf"((?>{NUMBER}))\s*,?\s*"
_ARC = re.compile(rf"{3 * _WHOLE}([01])\s*,?\s*([01])\s*,?\s*{2 * _WHOLE}", re.ASCII)
_COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2}
Step = tuple[str, list[complex]]


def numbers_of(text: str) -> tuple[list[float], bool]:
    """The numbers at the start of a text, and whether it holds nothing else."""
    numbers: list[float] = []
    position = len(text) - len(text.lstrip())
    while match := _NUMBER.match(text, position):
        if not math.isfinite(float(match[0])):
            return numbers, False
        numbers.append(float(match[0]))
        separator = _SEPARATOR.match(text, match.end())
        assert separator is not None
        position = separator.end()
    return numbers, position >= len(text)


def steps_of(text: str) -> tuple[list[Step], bool]:
    """What path data draw up to their first error, and whether there is none.

    A step is a letter and its points; A has two radii as one, the rotation in radians, both flags
    as one and the end.
    """
    pen = _Pen()
    position = len(text) - len(text.lstrip())
    for match in _COMMAND.finditer(text):
        if match.start() != position or not pen.draw(match[1], match[2]):
            return pen.steps, False
        position = match.end()
    return pen.steps, position == len(text)


class _Pen:
    """Position in path data."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._at = self._begin = 0j
        self._last: Step = ("", [])

    def draw(self, letter: str, text: str) -> bool:
        """Reads one command; returns whether it is valid."""
        name, origin = letter.lower(), letter.islower()
        if not self.steps and name != "m":
            return False
        if name == "z":
            self._add("Z", self._begin)
            return not text.strip()
        if name == "a":
            return self._arcs(origin, text)
        numbers, is_whole = numbers_of(text)
        count = _COUNTS[name]
        for k in range(0, len(numbers) - count + 1, count):
            self._segment(name, self._at if origin else 0j, numbers[k : k + count])
            name = "l" if name == "m" else name
        return is_whole and len(numbers) >= count and len(numbers) % count == 0

    def _segment(self, name: str, origin: complex, numbers: list[float]) -> None:
        at = self._at
        if name == "h":
            self._add("L", complex(origin.real + numbers[0], at.imag))
        elif name == "v":
            self._add("L", complex(at.real, origin.imag + numbers[0]))
        else:
            pairs = zip(numbers[::2], numbers[1::2], strict=True)
            points = [complex(origin.real + x, origin.imag + y) for x, y in pairs]
            kind = {"s": "c", "t": "q"}.get(name, name)
            if kind != name:
                mirrors = self._last[0] == kind.upper()
                points.insert(0, 2.0 * at - self._last[1][-2] if mirrors else at)
            self._add(kind.upper(), *points)
            if name == "m":
                self._begin = points[0]

    def _arcs(self, is_relative: bool, text: str) -> bool:
        position = len(text) - len(text.lstrip())
        is_whole = False
        while match := _ARC.match(text, position):
            rx, ry, turn, x, y = (float(match[k]) for k in (1, 2, 3, 6, 7))
            if not all(map(math.isfinite, (rx, ry, turn, x, y))):
                return False
            end = complex(x, y) + (self._at if is_relative else 0j)
            flags = complex(match[4] == "1", match[5] == "1")
            self._add("A", self._at, complex(rx, ry), complex(math.radians(turn)), flags, end)
            position = match.end()
            is_whole = position == len(text)
        return is_whole

    def _add(self, letter: str, *points: complex) -> None:
        self._last = (letter, list(points))
        self.steps.append(self._last)
        self._at = points[-1]


def arc_residual(arc: list[complex], point: complex) -> float:
    """Distance of a point from an arc's ellipse, scaled to a unit circle; 0 for degenerate arcs."""
    start, radii, turn, flags, end = arc
    rx, ry = abs(radii.real), abs(radii.imag)
    if start == end or rx == 0.0 or ry == 0.0:
        return 0.0

    def unit(z: complex) -> complex:
        turned = z * cmath.exp(-1j * turn.real)
        return complex(turned.real / rx, turned.imag / ry)

    a, b = unit(start), unit(end)
    half = (b - a) / 2
    size = max(1.0, abs(half))
    away = math.sqrt(max(0.0, size * size - abs(half) ** 2))
    side = -1.0 if (flags.real == 1.0) == (flags.imag == 1.0) else 1.0
    center = (a + b) / 2 + side * 1j * away * half / abs(half)
    return abs(abs(unit(point) - center) - size)
