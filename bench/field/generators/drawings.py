# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawings of one shape, whose area and color are known, written in the many ways that SVG has."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

_COLORS = {
    "#f00": (1, 0, 0),
    "rgb(0 128 255)": (0, 128 / 255, 1),
    "rgb(0 50% 100% / 1)": (0, 0.5, 1),
    "hsl(120 100% 25%)": (0, 0.5, 0),
    "hsl(240deg, 100%, 50%)": (0, 0, 1),
    "hwb(0 0% 0%)": (1, 0, 0),
    "var(--paint, #f00)": (0, 0.6, 0),
    "var(--none, #00f)": (0, 0, 1),
    "color(srgb 1 0.5 0)": (1, 0.5, 0),
    "color-mix(in srgb, red 40%, blue)": (0.4, 0, 0.6),
    "oklab(0.627955 0.224863 0.125846)": (1, 0, 0),
    "oklch(0.51975 0.176858 142.495)": (0, 0.50196, 0),
    "lab(29.5683 68.2874 -112.0294)": (0, 0, 1),
    "lch(54.2905 106.837 40.8576)": (1, 0, 0),
}


def write(stem: Path, random: np.random.Generator) -> Mapping[str, Any]:
    """Writes an SVG file."""
    color = str(random.choice(sorted(_COLORS)))
    offset = random.choice([0, 0, 2.5e6, -7e5, 1e8], 2)
    width, height = random.uniform(4, 40, 2).round(2)
    x, y = offset + random.uniform(0, 5, 2).round(2)
    shape, share = _shape(x, y, width, height, random)
    paint = f'fill="{color}"' if random.random() < 0.5 else f'style="fill:{color}"'
    style = "<style>:root { --paint: #090 }</style>"
    box = f"{x - 1:.9g} {y - 1:.9g} {width + 2:.9g} {height + 2:.9g}"
    stem.with_suffix(".svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">{style}'
        f"<g {paint}>{shape}</g></svg>",
        encoding="utf-8",
    )
    return {"must_work": True, "covered_share": share, "color": _COLORS[color], "made": color}


def _shape(
    x: float, y: float, width: float, height: float, random: np.random.Generator
) -> tuple[str, float]:
    """Returns an element that fills a box, and the share of the box that it covers."""
    kind = str(random.choice(["rect", "triangle", "ellipse", "path", "calc", "d"]))
    right, bottom = f"{x + width:.12g}", f"{y + height:.12g}"
    left, top = f"{x:.12g}", f"{y:.12g}"
    if kind == "triangle":
        return f'<polygon points="{left},{top} {right},{top} {left},{bottom}"/>', 0.5
    if kind == "ellipse":
        middle = f'cx="{x + width / 2:.12g}" cy="{y + height / 2:.12g}"'
        return f'<ellipse {middle} rx="{width / 2:.9g}" ry="{height / 2:.9g}"/>', np.pi / 4
    if kind == "path":
        return f'<path d="M{left} {top}H{right}V{bottom}H{left}Z"/>', 1.0
    if kind == "d":
        return f"<path style=\"d: path('M{left} {top}H{right}L{left} {bottom}Z')\"/>", 0.5
    if kind == "calc":
        size = f"width: calc({width:.9g}px / 2 + {width / 2:.9g}px)"
        return f'<rect x="{left}" y="{top}" height="{height:.9g}" style="{size}"/>', 1.0
    return f'<rect x="{left}" y="{top}" width="{width:.9g}" height="{height:.9g}"/>', 1.0
