# SPDX-License-Identifier: GPL-3.0-or-later

"""Times images of bytes from Python, beside Skia: overlaps, other filters and reading.

Usage: scripts/run python3 -m bench.vectors.times [DRAWING...] [--rounds N] [--skia FOLDER]
    [--json FILE]

Both build the paths of a drawing beforehand; the timed call returns a new array of bytes. All run
on one thread, in turns, and processor time counts. The criteria are shares of Skia's time, of the
time where nothing is known to overlap, of the box filter's time, and of the drawing's time.
"""

import argparse
import math
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from bench.report import Report, add_json_option

Floats = NDArray[np.float64]
Color = tuple[float, ...]
SVG = Path(__file__).resolve().parents[3] / "shared/data/svg"
FONT = SVG / "fonts/NotoSans-Regular.ttf"
QUARTER = math.sqrt(0.5)
LETTERS = {"M": 1, "L": 1, "Q": 2, "W": 2, "C": 3, "Z": 0}
LEAST_SECONDS = 0.02  # per timed batch
ICON_MICROSECONDS = 50.0
SKIA_BARS = {
    "strokes": 1.5, "radial gradients": 1.5, "linear gradients": 1.5, "map": 1.5, "text": 1.0,
    "dots": 1.0,
}  # fmt: skip
OVERLAP_BARS = {"map": 1.2, "text": 1.5, "rings": 1.5, "dots": 1.2}
FILTER_BARS = {
    "tent": 4.0, "bspline2": 4.0, "mitchell": 4.0, "lanczos2": 10.0, "lanczos3": 10.0,
    "radial2": 10.0, "radial3": 10.0,
}  # fmt: skip


@dataclass(frozen=True)
class Gradient:
    """From the first color to the second: from a point to another, or out to a radius."""

    start: tuple[float, float]
    end: tuple[float, float]
    radius: float
    colors: tuple[Color, Color]


@dataclass(frozen=True)
class Filled:
    """A filled path: letters and numbers as `Shape.add_path` takes them, and the paint."""

    letters: str
    numbers: Floats
    paint: Color | Gradient
    width: float = 0.0  # of a stroke


@dataclass(frozen=True)
class Drawing:
    """Paths over each other, premultiplied colors."""

    paths: list[Filled]
    side: int


def polygon(points: Floats) -> tuple[str, Floats]:
    """Returns a closed contour of lines."""
    return "M" + "L" * (len(points) - 1) + "Z", points.ravel()


def disc(x: float, y: float, r: float) -> tuple[str, list[float]]:
    """Returns a circle of four conics."""
    corners = ((1, 1, 0, 1), (-1, 1, -1, 0), (-1, -1, 0, -1), (1, -1, 1, 0))
    numbers = [x + r, y]
    for a, b, c, d in corners:
        numbers += [x + r * a, y + r * b, QUARTER, x + r * c, y + r * d]
    return "MWWWWZ", numbers


def joined(parts: list[tuple[str, list[float]]]) -> tuple[str, Floats]:
    """Returns contours in one."""
    return "".join(p[0] for p in parts), np.concatenate([np.asarray(p[1]) for p in parts])


def icon(_: np.random.Generator) -> Drawing:
    """Returns a gear of curves with a hole, 48 x 48."""
    numbers: list[float] = []
    letters = "M"
    for k in range(32):
        angles = [(k + j / 3) * 2 * math.pi / 32 for j in range(4)]
        radii = [20.0, 22.0, 22.0, 20.0] if k // 2 % 2 else [16.0] * 4
        points = [
            24 + r * f(a) for a, r in zip(angles, radii, strict=True) for f in (math.cos, math.sin)
        ]
        numbers += points if k == 0 else points[2:]
        letters += "C"
    outer = (letters + "Z", numbers)
    x, y, hole = 24.0, 24.0, 8.0
    inner = ("MCCCCZ", [x + hole, y, *_arcs(x, y, hole)])
    letters, found = joined([outer, inner])
    return Drawing([Filled(letters, found, (0.1, 0.3, 0.6, 1.0))], 48)


def _arcs(x: float, y: float, r: float) -> list[float]:
    """Returns the cubics of a circle, clockwise from its right."""
    k = 0.5522847498
    units = (
        (1, -k, k, -1, 0, -1), (-k, -1, -1, -k, -1, 0), (-1, k, -k, 1, 0, 1), (k, 1, 1, k, 1, 0),
    )  # fmt: skip
    return [at + r * u for unit in units for u, at in zip(unit, (x, y) * 3, strict=True)]


def dots(random: np.random.Generator) -> Drawing:
    """Returns 2500 discs of many colors that do not meet, 1024 x 1024."""
    paths = []
    for row in range(50):
        for column in range(50):
            x, y = (column + 0.5) * 20.4, (row + 0.5) * 20.4
            letters, numbers = disc(x, y, float(random.uniform(3, 9)))
            paths.append(Filled(letters, np.asarray(numbers), (*random.random(3), 1.0)))
    return Drawing(paths, 1024)


def strokes(random: np.random.Generator) -> Drawing:
    """Returns 1500 curved strokes of many colors over each other, 1024 x 1024."""
    paths = []
    for _ in range(1500):
        start = random.random(2) * 1024
        points = start + np.cumsum(random.normal(0, 40, (7, 2)), axis=0)
        paths.append(Filled("MCC", points.ravel(), (*random.random(3), 1.0), 2.0))
    return Drawing(paths, 1024)


def gradients(random: np.random.Generator, is_radial: bool) -> Drawing:
    """Returns 64 discs of gradients that touch, 1024 x 1024."""
    paths = []
    for row in range(8):
        for column in range(8):
            x, y = 64.0 + 128 * column, 64.0 + 128 * row
            letters, numbers = disc(x, y, 63.0)
            colors = (*random.random(3), 1.0), (*random.random(3), 1.0)
            paint = Gradient((x - 45, y - 45), (x + 45, y + 45), 0.0, colors)
            if is_radial:
                paint = Gradient((x, y), (x, y), 63.0, colors)
            paths.append(Filled(letters, np.asarray(numbers), paint))
    return Drawing(paths, 1024)


def border(a: Floats, b: Floats, random: np.random.Generator, depth: int) -> Floats:
    """Returns a line between two points that is rough at every scale, without its end."""
    points = np.stack([a, b])
    for _ in range(depth):
        middle = 0.5 * (points[1:] + points[:-1])
        along = points[1:] - points[:-1]
        across = np.stack([-along[:, 1], along[:, 0]], 1)
        middle += across * random.uniform(-0.08, 0.08, (len(along), 1))
        both = np.empty((2 * len(points) - 1, 2))
        both[::2], both[1::2] = points, middle
        points = both
    return points[:-1]


def atlas(random: np.random.Generator) -> Drawing:
    """Returns 240 countries whose rough borders they share, 200,000 lines, 1024 x 512."""
    columns, rows = 20, 12
    places = np.empty((rows + 1, columns + 1, 2))
    places[..., 0] = np.linspace(10, 1014, columns + 1)
    places[..., 1] = np.linspace(10, 1014, rows + 1)[:, None]
    places += random.uniform(-9, 9, places.shape)
    rough = 8
    flat = {
        (r, c): border(places[r, c], places[r, c + 1], random, rough)
        for r in range(rows + 1)
        for c in range(columns)
    }
    steep = {
        (r, c): border(places[r, c], places[r + 1, c], random, rough)
        for r in range(rows)
        for c in range(columns + 1)
    }
    paths = []
    for r in range(rows):
        for c in range(columns):
            right, top = steep[r, c + 1], flat[r + 1, c]
            far = places[r + 1, c + 1]
            back = np.concatenate([far[None], top[:0:-1]])
            down = np.concatenate([places[r + 1, c][None], steep[r, c][:0:-1]])
            letters, numbers = polygon(np.concatenate([flat[r, c], right, back, down]))
            paths.append(Filled(letters, numbers, (*random.random(3), 1.0)))
    return Drawing(paths, 1024)


def text(_: np.random.Generator) -> Drawing:
    """Returns a page of letters in one path, 800 x 800."""
    import skia

    font = skia.Font(skia.Typeface.MakeFromFile(str(FONT)), 12)
    words = "Whole drawings as browsers show them, and none that hangs: quick foxes jump. "
    ids = font.textToGlyphs(words * 2)
    widths = font.getWidths(ids)
    outlines = {glyph: _contours(font.getPath(glyph)) for glyph in set(ids)}
    parts = []
    for line in range(50):
        x = 4.0
        for glyph, width in zip(ids, widths, strict=True):
            letters, numbers = outlines[glyph]
            parts.append((letters, numbers + np.array([x, 14.0 + 15 * line])))
            x += width
            if x > 780:
                break
    letters, numbers = joined([(a, b.ravel()) for a, b in parts])
    return Drawing([Filled(letters, numbers, (0.0, 0.0, 0.0, 1.0))], 800)


def _contours(path: Any) -> tuple[str, Floats]:
    """Returns a path of Skia's, of lines and curves."""
    letters, points = "", []
    for verb, found in path or ():
        letter = "MLQ?CZ?"[int(verb)]
        letters += letter
        count = LETTERS[letter]
        points += [(p.x(), p.y()) for p in found[len(found) - count :]] if count else []
    return letters, np.asarray(points, np.float64).reshape(-1, 2)


def _pairs(numbers: list[float]) -> list[tuple[float, float]]:
    """Returns the points of a disc."""
    found = [(numbers[0], numbers[1])]
    for k in range(2, len(numbers), 5):
        found += [(numbers[k], numbers[k + 1]), (numbers[k + 3], numbers[k + 4])]
    return found


def _conics(points: Floats) -> list[float]:
    """Returns the numbers of a disc of its points."""
    numbers = [*points[0]]
    for middle, end in zip(points[1::2], points[2::2], strict=True):
        numbers += [*middle, QUARTER, *end]
    return numbers


def rings(_: np.random.Generator) -> Drawing:
    """Returns circles within each other in one path, 512 x 512."""
    parts = []
    for k in range(1, 65):
        letters, numbers = disc(256.0, 256.0, 3.9 * k)
        if k % 2 == 1:
            # Reversed, so that rings remain.
            points = np.asarray([(y, x) for x, y in _pairs(numbers)])
            numbers = _conics(points)
        parts.append((letters, np.asarray(numbers)))
    letters, numbers = joined([(a, b) for a, b in parts])
    return Drawing([Filled(letters, numbers, (0.0, 0.0, 0.0, 1.0))], 512)


CASES: dict[str, Callable[[np.random.Generator], Drawing]] = {
    "icon": icon,
    "text": text,
    "dots": dots,
    "rings": rings,
    "strokes": strokes,
    "radial gradients": lambda random: gradients(random, True),
    "linear gradients": lambda random: gradients(random, False),
    "map": atlas,
}


def our_shapes(drawing: Drawing, *, winds_once: bool = False) -> list[prefilter.Shape]:
    """Returns the paths as shapes."""
    shapes = []
    for path in drawing.paths:
        shape = prefilter.Shape(winds_once=winds_once, color=(0.0, 0.0, 0.0, 1.0))
        shape.add_path(path.letters, path.numbers)
        if isinstance(path.paint, Gradient):
            stops = list(zip((0.0, 1.0), path.paint.colors, strict=True))
            if path.paint.radius > 0.0:
                shape.radial_gradient(path.paint.start, path.paint.radius, stops)
            else:
                shape.linear_gradient(path.paint.start, path.paint.end, stops)
        else:
            shape.color = path.paint
        shapes.append(shape.stroked(path.width) if path.width > 0.0 else shape)
    return shapes


def ours(drawing: Drawing, **options: Any) -> Callable[[], object]:
    """Returns a call that draws with Prefilter."""
    shapes = our_shapes(drawing)
    side = drawing.side
    return lambda: prefilter.rasterize(shapes, side, side, dtype=np.uint8, threads=1, **options)


def strokes_of_ours(drawing: Drawing) -> Callable[[], object]:
    """Returns our timed call with stroking included, as in Skia."""
    lines = our_shapes(Drawing([replace(path, width=0.0) for path in drawing.paths], drawing.side))
    widths = [path.width for path in drawing.paths]
    side = drawing.side

    def draw() -> object:
        shapes = [shape.stroked(width) for shape, width in zip(lines, widths, strict=True)]
        return prefilter.rasterize(shapes, side, side, dtype=np.uint8, threads=1)

    return draw


def skias(drawing: Drawing) -> Callable[[], object]:
    """Returns a call that draws with Skia."""
    import skia

    drawn = [(skia_path(path), skia_paint(path)) for path in drawing.paths]
    side = drawing.side

    def draw() -> object:
        pixels = np.zeros((side, side, 4), np.uint8)
        canvas = skia.Surface(pixels).getCanvas()
        for path, paint in drawn:
            canvas.drawPath(path, paint)
        return pixels

    return draw


def skia_path(path: Filled) -> Any:
    """Returns the path of Skia's."""
    import skia

    builder = skia.Path()
    steps = {
        "M": builder.moveTo, "L": builder.lineTo, "Q": builder.quadTo, "C": builder.cubicTo,
        "W": lambda x, y, weight, u, v: builder.conicTo(x, y, u, v, weight),
    }  # fmt: skip
    at = 0
    for letter in path.letters:
        if letter == "Z":
            builder.close()
            continue
        count = 2 * LETTERS[letter] + (letter == "W")
        steps[letter](*map(float, path.numbers[at : at + count]))
        at += count
    return builder


def skia_paint(path: Filled) -> Any:
    """Returns the paint of Skia's."""
    import skia

    paint = skia.Paint(AntiAlias=True)
    if path.width > 0.0:
        paint.setStyle(skia.Paint.kStroke_Style)
        paint.setStrokeWidth(path.width)
    if not isinstance(path.paint, Gradient):
        paint.setColor4f(skia.Color4f(*path.paint))
        return paint
    colors = [skia.Color4f(*color).toColor() for color in path.paint.colors]
    start = skia.Point(*path.paint.start)
    if path.paint.radius > 0.0:
        paint.setShader(skia.GradientShader.MakeRadial(start, path.paint.radius, colors))
    else:
        ends = [start, skia.Point(*path.paint.end)]
        paint.setShader(skia.GradientShader.MakeLinear(ends, colors))
    return paint


def markup(drawing: Drawing) -> str:
    """Returns a drawing of lines and curves as SVG."""
    paths = []
    for path in drawing.paths:
        data, at = [], 0
        for letter in path.letters:
            count = 2 * LETTERS[letter]
            numbers = " ".join(f"{number:.3f}" for number in path.numbers[at : at + count])
            data.append(letter + numbers)
            at += count
        assert not isinstance(path.paint, Gradient)
        color = "rgb({} {} {})".format(*(round(255 * value) for value in path.paint[:3]))
        paint = f'fill="none" stroke="{color}" stroke-width="{path.width:g}"'
        if path.width == 0.0:
            paint = f'fill="{color}"'
        paths.append(f'<path d="{"".join(data)}" {paint}/>')
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{drawing.side}" height="{drawing.side}">'
    )
    return "\n".join([head, *paths, "</svg>"])


def compare_reading(report: Report, rounds: int) -> None:
    """Reports the times of reading a drawing and of drawing it."""
    rows = []
    claims = []
    sources: dict[str, str | Path] = {
        name: markup(CASES[name](np.random.default_rng(31))) for name in ("map", "text", "strokes")
    }
    sources["tiger"] = SVG / "Ghostscript_Tiger.svg"
    for name, source in sources.items():
        side = 1024
        shapes = prefilter.read_svg(source).shapes_for(side, side)
        calls = {
            "read": partial(prefilter.read_svg, source),
            "outline": partial(prefilter.read_svg(source).shapes_for, side, side),
            "draw": partial(
                prefilter.rasterize, shapes, side, side, dtype=np.uint8, threads=1
            ),
        }  # fmt: skip
        found = measured(calls, rounds)
        reading = found["read"] + found["outline"]
        rows.append([name, *(f"{1e3 * found[what]:.1f}" for what in calls)])
        claim = f"{name}: reading takes {reading / found['draw']:.2f} of drawing, at most 1"
        claims.append((reading <= found["draw"], claim))
    report.table("reading", ["drawing", "read ms", "outlines ms", "drawn ms"], rows, "reading")
    for holds, claim in claims:
        report.verdict(holds, claim)


def measured(calls: dict[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Returns the median processor time of each call [s], in turns."""
    counts = {}
    for name, call in calls.items():
        call()
        began = time.process_time()
        call()
        counts[name] = max(1, int(LEAST_SECONDS / max(time.process_time() - began, 1e-6)))
    found: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            began = time.process_time()
            for _ in range(counts[name]):
                call()
            found[name].append((time.process_time() - began) / counts[name])
    return {name: statistics.median(seconds) for name, seconds in found.items()}


def compare(report: Report, names: list[str], rounds: int) -> None:
    """Ours beside Skia, and beside the same where it is known that nothing overlaps."""
    rows = []
    claims = []
    for name in names:
        drawing = CASES[name](np.random.default_rng(31))
        makes_strokes = any(path.width > 0.0 for path in drawing.paths)
        calls = {"ours": strokes_of_ours(drawing) if makes_strokes else ours(drawing)}
        calls["Skia"] = skias(drawing)
        if name in OVERLAP_BARS:
            known = our_shapes(drawing, winds_once=True)
            calls["known"] = partial(
                prefilter.rasterize, known, drawing.side, drawing.side, overlap="add",
                dtype=np.uint8, threads=1,
            )  # fmt: skip
        found = measured(calls, rounds)
        share = found["ours"] / found["Skia"]
        row = [name, *(f"{1e6 * found[who]:.0f}" for who in ("ours", "Skia")), f"{share:.2f}"]
        if name == "icon":
            us = 1e6 * found["ours"]
            claims.append(
                (us <= ICON_MICROSECONDS, f"icon: {us:.0f} us, at most {ICON_MICROSECONDS:g}")
            )
        if name in SKIA_BARS:
            bar = SKIA_BARS[name]
            claims.append((share <= bar, f"{name}: {share:.2f} of Skia's time, at most {bar:g}"))
        if name in OVERLAP_BARS:
            more = found["ours"] / found["known"]
            bar = OVERLAP_BARS[name]
            row += [f"{1e6 * found['known']:.0f}", f"{more:.2f}"]
            claims.append(
                (
                    more <= bar,
                    f"{name}: {more:.2f} times what it takes without overlaps, at most {bar:g}",
                )
            )
        rows.append([*row, *[""] * (6 - len(row))])
    head = ["drawing", "us", "Skia us", "of Skia", "known to be apart us", "of that"]
    report.table("bytes from Python", head, rows, "bytes")
    for holds, claim in claims:
        report.verdict(holds, claim)


def compare_filters(report: Report, rounds: int) -> None:
    """Other filters beside the box, on a page of text and on dots."""
    rows = []
    claims = []
    for name in ("text", "dots"):
        drawing = CASES[name](np.random.default_rng(31))
        shapes = our_shapes(drawing, winds_once=True)
        calls = {
            filter_name: partial(
                prefilter.rasterize, shapes, drawing.side, drawing.side, overlap="add",
                filter=filter_name, threads=1,
            )
            for filter_name in ("box", *FILTER_BARS)
        }  # fmt: skip
        found = measured(calls, rounds)
        for filter_name, seconds in found.items():
            times = seconds / found["box"]
            rows.append([name, filter_name, f"{1e3 * seconds:.1f}", f"{times:.2f}"])
            if filter_name in FILTER_BARS:
                bar = FILTER_BARS[filter_name]
                claim = f"{name}, {filter_name}: {times:.2f} times the box, at most {bar:g}"
                claims.append((times <= bar, claim))
    report.table("filters", ["drawing", "filter", "ms", "of box"], rows, "filters")
    for holds, claim in claims:
        report.verdict(holds, claim)


PARTS = {"filters": compare_filters, "reading": compare_reading}


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("drawings", nargs="*", metavar="DRAWING", help=", ".join([*CASES, *PARTS]))
    parser.add_argument("--rounds", type=int, default=7, help="how often (default: %(default)s)")
    parser.add_argument("--skia", type=Path, help="the folder where Skia's package is")
    add_json_option(parser)
    options = parser.parse_args()
    if options.skia is not None:
        sys.path.insert(0, str(options.skia))
    report = Report()
    names = options.drawings or [*CASES, *PARTS]
    drawings = [name for name in names if name not in PARTS]
    if drawings:
        compare(report, drawings, options.rounds)
    for name, part in PARTS.items():
        if name in names:
            part(report, options.rounds)
    report.finish(options.json)


if __name__ == "__main__":
    main()
