# SPDX-License-Identifier: GPL-3.0-or-later

"""Transforms of elements: `transform`, `translate`, `rotate` and `scale`, with their origin."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...affine import IDENTITY, Matrix, compose
from ..model.tree import Box
from ..model.values import has_relative_lengths, parse_origin, parse_rotate, parse_transform
from .document import SvgElement
from .lengths import Units, transform_about_origin
from .styles import INDIVIDUAL

if TYPE_CHECKING:
    from .context import Context, Sources

_FILL_BOXES = ("fill-box", "content-box")
_STROKE_BOXES = ("stroke-box", "border-box")


def read_transform(
    element: SvgElement, declared: Mapping[str, str], context: "Context", sources: "Sources"
) -> Matrix | None:
    """Returns the matrix from an element's units to its parent's; None if they are the same.

    Args:
        context: The context with its style, in its parent's units.
    """
    transform_text, origin = declared.get("transform", ""), declared.get("transform-origin", "")
    parts = {name: declared[key] for name, key in INDIVIDUAL.items() if key in declared}
    if not transform_text and not parts:
        if origin and parse_origin(origin) is None:
            sources.warnings.broken("transform-origin", "ignored", element.line)
        return None
    box = _reference_box(element, declared, context, sources)
    if box is None:
        return None
    units = Units(box[2] - box[0], box[3] - box[1], context.style.font_size)
    matrix = IDENTITY
    # The order is fixed, whatever the order of declarations.
    for name in ("translate", "rotate", "scale"):
        text = parts.get(name, "none").strip()
        if text.lower() == "none":
            continue
        part = parse_rotate(text) if name == "rotate" else _listed(f"{name}({text})", units)
        if part is None:
            sources.warnings.broken(f"{name} '{text[:40]}'", "ignored", element.line)
            continue
        matrix = compose(matrix, part)
    own = _listed(transform_text, units)
    if own is None:
        sources.warnings.broken("transform", "ignored", element.line)
        own = IDENTITY
    matrix = compose(matrix, own)
    turned = transform_about_origin(matrix, origin, units, (box[0], box[1]))
    if turned is None:
        sources.warnings.broken("transform-origin", "ignored", element.line)
        return matrix
    return turned


def _listed(text: str, units: Units) -> Matrix | None:
    if not has_relative_lengths(text):
        return parse_transform(text)
    return parse_transform(text, units.width, units.height, units.font_size)


def _reference_box(
    element: SvgElement, declared: Mapping[str, str], context: "Context", sources: "Sources"
) -> Box | None:
    """Returns the box named by `transform-box`; None if the element has no such box."""
    name = declared.get("transform-box", "view-box").strip().lower()
    if name not in _FILL_BOXES and name not in _STROKE_BOXES:
        return (0.0, 0.0, *context.viewport)
    assert sources.measure is not None
    box = sources.measure(element, context, sources)
    if box is None:
        return (0.0, 0.0, 0.0, 0.0)
    stroke = context.style.stroke
    if name in _STROKE_BOXES and (stroke.color is not None or stroke.server):
        half = 0.5 * context.units.pixels(context.style.stroke_width, "stroke-width")
        box = (box[0] - half, box[1] - half, box[2] + half, box[3] + half)
    return box
