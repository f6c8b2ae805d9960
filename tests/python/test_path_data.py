# SPDX-License-Identifier: GPL-3.0-or-later

"""Path data against a reader of regular expressions; arcs lie on their ellipses."""

import random

import numpy as np
import pytest
from path_oracle import arc_residual, numbers_of, steps_of
from prefilter import _native
from prefilter.shapes._svg.model.limits import TooLargeError
from prefilter.shapes._svg.model.outline import Outline, read_path

ODD = ["1e400", "-1e-400", ".5", "5.", "+.25", "1.5.5", "1e", "-", "0x1", "00", "1-2", "--3", "."]
COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "a": 7, "z": 0}


def number(source, odd):
    kind = source.random()
    if kind < odd:
        return source.choice(ODD)
    if kind < 0.5:
        return str(source.randint(-50, 50))
    return repr(source.uniform(-99, 99)) if kind < 0.9 else f"{source.uniform(-9, 9):.2e}"


def path_data(source, odd=0.03):
    """Random path data, some of them with errors."""
    text = ""
    for index in range(source.randint(1, 6)):
        letter = source.choice("Mm" if index == 0 else "MmZzLlHhVvCcSsQqTtAaAa")
        count = COUNTS[letter.lower()] * source.choice([1, 1, 2, 3]) + (source.random() < odd)
        numbers = [
            source.choice("01") if letter in "Aa" and k % 7 in (3, 4) else number(source, odd)
            for k in range(count)
        ]
        blank = source.choice(["", " ", "\n\t", " , " if source.random() < odd else " "])
        after = source.choice(["", " ", "\u00e9" if source.random() < odd else "\r"])
        text += letter + blank + source.choice([" ", ",", " , "]).join(numbers) + after
    return text


def points_of(letter, numbers):
    places = {"W": (0, 1, 3, 4)}.get(letter, range(len(numbers)))
    found = [numbers[k] for k in places]
    return [complex(*pair) for pair in zip(found[::2], found[1::2], strict=True)]


def test_agrees_with_regular_expressions():
    source = random.Random(1)
    for _ in range(4000):
        text = path_data(source)
        outline, is_whole = read_path(text)
        steps, expected_whole = steps_of(text)
        assert is_whole == expected_whole, text
        segments = [(letter, points_of(letter, numbers)) for letter, numbers in outline.segments()]
        at = 0
        for letter, points in steps:
            if letter != "A":
                assert segments[at][0] == letter, text
                assert segments[at][1] == (points if letter != "Z" else []), text
                at += 1
                continue
            # Conics of a quarter or less, or a line, to the end of the arc.
            before = points[0]
            while before != points[-1]:
                kind, controls = segments[at]
                assert kind in "WL", text
                before = controls[-1]
                at += 1
        assert at == len(segments), text


def test_arcs_are_on_their_ellipses():
    """Arcs follow their ellipses all along, on the side that their flags ask for."""
    source = random.Random(2)
    for _ in range(400):
        rx, ry, turn = source.uniform(1, 40), source.uniform(1, 40), source.uniform(-400, 400)
        flags = f"{source.choice('01')} {source.choice('01')}"
        text = f"M 3 4 A {rx!r} {ry!r} {turn!r} {flags} {source.uniform(-30, 30)!r} 9"
        outline, _ = read_path(text)
        arc = steps_of(text)[0][1][1]
        at = 3 + 4j
        swept = 0.0
        for letter, numbers in outline.segments():
            if letter != "W":
                continue
            control, weight, end = complex(*numbers[:2]), float(numbers[2]), complex(*numbers[3:])
            for t in (step / 6 for step in range(7)):
                before, between, after = (1 - t) ** 2, 2 * weight * t * (1 - t), t * t
                point = before * at + between * control + after * end
                assert arc_residual(arc, point / (before + between + after)) < 1e-9, text
            swept += ((control - at).conjugate() * (end - control)).imag
            at = end
        assert (swept > 0.0) == (arc[3].imag == 1.0), text


@pytest.mark.parametrize("radius", ["1e140", "1e156", "1e303", "1e308"])
def test_arcs_of_ellipses_that_are_far_larger_than_their_chord(radius):
    """Such arcs become lines or reach their end points; the fuzzer found one that did neither."""
    for radii in (f"{radius} 1", f"1 {radius}", f"{radius} {radius}"):
        for flags in ("0 0", "0 1", "1 0", "1 1"):
            outline, is_whole = read_path(f"M 0 9 A {radii} 0 {flags} 0 6 A {radii} 0 {flags} 3 6")
            assert is_whole
            numbers = [numbers for _, numbers in outline.segments()]
            assert np.isfinite(np.concatenate(numbers)).all()
            ends = [one[-2:] for one in numbers]
            assert list(ends[-1]) == [3.0, 6.0]
            assert any(list(end) == [0.0, 6.0] for end in ends)


def test_numbers():
    source = random.Random(3)
    for _ in range(2000):
        count = source.randint(0, 5)
        text = source.choice([" ", ",", ", "]).join(number(source, 0.2) for _ in range(count))
        text = source.choice(["", " ", ","]) + text + source.choice(["", "\n", ",", "e"])
        assert _native.read_numbers(text.encode()) == numbers_of(text), text


def test_bounds_are_those_of_dense_points():
    source = random.Random(4)
    for _ in range(300):
        text = path_data(source, odd=0.0)
        outline, _ = read_path(text)
        at = begin = 0j
        segments = list(outline.segments())
        points = []
        for index, (letter, numbers) in enumerate(segments):
            if letter == "Z":
                at = begin
                continue
            controls = [at, *points_of(letter, numbers)]
            if letter == "M":
                at = begin = controls[-1]
                if index + 1 < len(segments) and segments[index + 1][0] != "M":
                    points.append(at)
                continue
            t = np.linspace(0, 1, 2001)[:, None]
            if letter == "W":
                weights = np.array([1.0, numbers[2], 1.0])
                shares = np.concatenate([(1 - t) ** 2, 2 * t * (1 - t), t * t], 1) * weights
                curve = shares @ np.array(controls) / shares.sum(1)
            else:
                levels = np.array(controls) * np.ones_like(t)
                while levels.shape[1] > 1:
                    levels = (1 - t) * levels[:, :-1] + t * levels[:, 1:]
                curve = levels[:, 0]
            points += list(curve)
            at = controls[-1]
        box = outline.bounds()
        if not points:
            assert box is None, text
            continue
        xs, ys = np.real(points), np.imag(points)
        slack = 1e-6 * max(1.0, np.ptp(xs) + np.ptp(ys))
        assert box == pytest.approx((xs.min(), ys.min(), xs.max(), ys.max()), abs=slack), text


def test_empty():
    assert read_path("")[1]
    assert Outline().bounds() is None
    assert not read_path("L 1 2")[1]
    assert _native.read_numbers(b"") == ([], True)


def test_too_many():
    with pytest.raises(TooLargeError, match="lines and curves"):
        read_path("M0 0" + "h1" * 2_000_001)
