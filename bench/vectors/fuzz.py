# SPDX-License-Identifier: GPL-3.0-or-later

"""Random SVG drawings: whether each is drawn or refused within a time and memory.

Usage: scripts/run python3 -m bench.vectors.fuzz [PATTERN...] [--count N] [--first SEED]

Each drawing is made in its own process, which is stopped after a limit of processor time. Memory
counts beyond a process that draws a box. A refusal by a ValueError, or by a MemoryError that states
the required memory, is a success. Ends with status 1 where a drawing takes more, or fails
otherwise; the seed makes it again.
"""

import argparse
import os
import random
import resource
import sys
import time
import traceback
from collections.abc import Callable

import prefilter

SIDE = 512
MOST_SECONDS = 2.0
MOST_MIB = 200.0
LIMIT = 10
REFUSED = 3

Draw = random.Random


def number(draw: Draw) -> str:
    """Returns a coordinate, mostly within the view box, sometimes far from it or none."""
    kind = draw.random()
    if kind < 0.9:
        return f"{draw.uniform(-20, 120):.3f}"
    if kind < 0.9998:
        return f"{draw.uniform(-1, 1) * 10 ** draw.uniform(0, 9):g}"
    return draw.choice(
        ["1e38", "-1e300", "1e-300", "0", "-0", "nan", ".", "1e", "--1", "99999999999"]
    )


def path(draw: Draw, most: int) -> str:
    """Returns path data of up to so many commands."""
    wants = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
    data = ["M", number(draw), number(draw)]
    for _ in range(int(most ** draw.random())):
        command = draw.choice(list(wants))
        data.append(draw.choice([command, command.lower()]))
        values = [number(draw) for _ in range(wants[command])]
        if command == "A":
            values[3:5] = [draw.choice("01"), draw.choice("01")]
        data += values
    return " ".join(data)


def paths(draw: Draw) -> str:
    """Filled paths."""
    rule = draw.choice(["evenodd", "nonzero"])
    return "".join(
        f'<path fill-rule="{rule}" fill-opacity="{draw.random():.2f}" d="{path(draw, 20000)}"/>'
        for _ in range(draw.randint(1, 8))
    )


def strokes(draw: Draw) -> str:
    """Strokes with dashes, joins and caps."""
    dashes = " ".join(f"{10 ** draw.uniform(-6, 3):g}" for _ in range(draw.randint(1, 6)))
    width = 10 ** draw.uniform(-3, 5)
    return (
        f'<path fill="none" stroke="red" stroke-width="{width:g}" stroke-dasharray="{dashes}" '
        f'stroke-linejoin="{draw.choice(["miter", "round", "bevel"])}" '
        f'stroke-linecap="{draw.choice(["butt", "round", "square"])}" d="{path(draw, 2000)}"/>'
    )


def nested(draw: Draw) -> str:
    """Elements in each other."""
    depth = int(10 ** draw.uniform(1, 4.3))
    rest = draw.choice(
        [
            'opacity="0.99"',
            'transform="scale(1.001)"',
            'style="isolation:isolate"',
            "",
            'mask="url(#m)"',
        ]
    )
    name = draw.choice(["g", "svg", "a", "unknown"])
    mask = '<mask id="m"><rect width="100" height="100" fill="white"/></mask>'
    return (
        mask + f"<{name} {rest}>" * depth + '<rect width="50" height="50"/>' + f"</{name}>" * depth
    )


def uses(draw: Draw) -> str:
    """Elements used again and again."""
    levels, each = draw.randint(1, 20), draw.randint(1, 12)
    body = '<rect id="u0" width="5" height="5" fill-opacity="0.3"/>'
    for level in range(1, levels):
        body += f'<g id="u{level}">'
        for i in range(each):
            body += f'<use href="#u{level - 1}" x="{draw.uniform(0, 9):.2f}" y="{i}"/>'
        body += "</g>"
    return body


def filters(draw: Draw) -> str:
    """Blurs, offsets and shadows of any size."""
    size = 10 ** draw.uniform(-3, 9)
    other = 10 ** draw.uniform(-3, 9)
    primitive = draw.choice(
        [
            f'<feGaussianBlur stdDeviation="{size:g} {other:g}"/>',
            f'<feOffset dx="{size:g}" dy="{other:g}"/>',
            f'<feDropShadow dx="{size:g}" dy="3" stdDeviation="{other:g}"/>',
            f'<feFlood flood-color="red"/><feGaussianBlur stdDeviation="{size:g}"/>' * 5,
        ]
    )
    region = f'x="{-size:g}" y="-1" width="{2 * size:g}" height="{other:g}"'
    return (
        f'<filter id="f" {region if draw.random() < 0.7 else ""}>{primitive}</filter>'
        f'<g filter="url(#f)"><path d="{path(draw, 50)}"/><circle r="40" cx="50" cy="50"/></g>'
    )


def patterns(draw: Draw) -> str:
    """Patterns of tiles of any size."""
    size = 10 ** draw.uniform(-6, 4)
    return (
        f'<pattern id="p" width="{size:g}" height="{size:g}" patternUnits="userSpaceOnUse">'
        f'<circle r="{size / 3:g}"/><path d="{path(draw, 30)}"/></pattern>'
        f'<path fill="url(#p)" stroke="url(#p)" d="{path(draw, 50)}"/>'
    )


KINDS: dict[str, Callable[[Draw], str]] = {
    "paths": paths,
    "strokes": strokes,
    "nested": nested,
    "uses": uses,
    "filters": filters,
    "patterns": patterns,
}


def drawing(kind: str, seed: int) -> str:
    """Returns an SVG document."""
    body = KINDS[kind](random.Random(f"{kind} {seed}"))
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">{body}</svg>'


def draw_in_child(source: str) -> None:
    """Draws, and ends this process."""
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
    try:
        prefilter.rasterize_svg(source.encode(), SIDE, SIDE)
    except (ValueError, MemoryError):
        os._exit(REFUSED)
    except BaseException:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)


def measured(source: str) -> tuple[int, float, float]:
    """Returns the exit status, the processor time and the most memory, in MiB, of a process."""
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        draw_in_child(source)
    _, status, used = os.wait4(child, 0)
    return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("patterns", nargs="*", metavar="PATTERN", help=", ".join(KINDS))
    parser.add_argument("--count", type=int, default=40, help="of each kind (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="seed (default: %(default)s)")
    options = parser.parse_args()
    prefilter.rasterize_svg(drawing("paths", 0).encode(), SIDE, SIDE)  # imports its modules
    box = '<svg xmlns="http://www.w3.org/2000/svg"><rect width="9" height="9"/></svg>'
    measured(box)
    least = measured(box)[2]
    failed = 0
    begin = time.monotonic()
    for kind in options.patterns or KINDS:
        worst, refused = [0.0, 0.0], 0
        for seed in range(options.first, options.first + options.count):
            status, seconds, mib = measured(drawing(kind, seed))
            mib -= least
            worst = [max(worst[0], seconds), max(worst[1], mib)]
            refused += status == REFUSED
            if status not in (0, REFUSED) or seconds > MOST_SECONDS or mib > MOST_MIB:
                failed += 1
                print(f"{kind} {seed}: status {status}, {seconds:.2f} s, {mib:.0f} MiB")
        print(f"{kind}: at most {worst[0]:.2f} processor s, {worst[1]:.0f} MiB; {refused} refused")
    print(f"{failed} failed, {time.monotonic() - begin:.0f} s")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
