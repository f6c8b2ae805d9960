# SPDX-License-Identifier: GPL-3.0-or-later

"""Outlines of paths and basic shapes."""

from collections.abc import Mapping

from ..model.outline import Outline, read_path
from ..model.values import leading_numbers
from ..model.warnings import Warnings
from .document import SvgElement
from .lengths import Units, read_length

BASIC_SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")


def read_shape(
    element: SvgElement, values: Mapping[str, str], units: Units, warnings: Warnings
) -> Outline | None:
    """Reads the outline of one of BASIC_SHAPES; returns None if it has none."""
    outline = Outline()

    def pixels(name: str) -> float:
        length = read_length(element, values, name, warnings)
        return 0.0 if length is None else units.pixels(length, name)

    def radii() -> tuple[float, float]:
        """Returns rx and ry; a missing or negative one equals the other."""
        lengths = [read_length(element, values, name, warnings) for name in ("rx", "ry")]
        rx, ry = (
            None if length is None or length.value < 0.0 else units.pixels(length, name)
            for name, length in zip(("rx", "ry"), lengths, strict=True)
        )
        either = rx if rx is not None else ry or 0.0
        return either, either if ry is None else ry

    match element.tag:
        case "path":
            outline, is_complete = read_path(values.get("d", ""))
            if not is_complete:
                effect = "drawn up to an error" if len(outline) else "left out"
                warnings.broken("path data", effect, element.line)
        case "rect":
            width, height = pixels("width"), pixels("height")
            if width <= 0.0 or height <= 0.0:
                return None
            rx, ry = radii()
            rx, ry = min(rx, width / 2.0), min(ry, height / 2.0)
            outline.rectangle(pixels("x"), pixels("y"), width, height, rx, ry)
        case "circle" | "ellipse":
            rx, ry = (pixels("r"),) * 2 if element.tag == "circle" else radii()
            if rx <= 0.0 or ry <= 0.0:
                return None
            outline.ellipse(pixels("cx"), pixels("cy"), rx, ry)
        case "line":
            outline.move_to(pixels("x1"), pixels("y1"))
            outline.line_to(pixels("x2"), pixels("y2"))
        case _:
            numbers, is_complete = leading_numbers(values.get("points", ""))
            if not is_complete or len(numbers) % 2:
                warnings.broken("points", "drawn up to an error", element.line)
            if len(numbers) < 4:
                return None
            outline.move_to(numbers[0], numbers[1])
            for k in range(2, len(numbers) - 1, 2):
                outline.line_to(numbers[k], numbers[k + 1])
            if element.tag == "polygon":
                outline.close()
    return outline if outline.bounds() is not None else None
