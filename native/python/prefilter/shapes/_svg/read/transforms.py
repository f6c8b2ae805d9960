# SPDX-License-Identifier: GPL-3.0-or-later

"""What moves an element: `transform`, `translate`, `rotate` and `scale`, about an origin."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...affine import IDENTITY, Matrix, multiplied
from ..model.tree import Box
from ..model.values import as_origin, as_rotate, as_transform, needs_whole
from .document import SvgElement
from .lengths import Units, about_origin
from .styles import INDIVIDUAL

if TYPE_CHECKING:
    from .context import Context, Sources

_FILL_BOXES = ("fill-box", "content-box")
_STROKE_BOXES = ("stroke-box", "border-box")


def own_transform(
    element: SvgElement, declared: Mapping[str, str], context: "Context", sources: "Sources"
) -> Matrix | None:
    """From the units of an element to those of its parent; None where they are the same.

    Args:
        element: The element.
        declared: Its attributes and properties.
        context: With its style, in its parent's units.
        sources: What it is read with.
    """
    turn, origin = declared.get("transform", ""), declared.get("transform-origin", "")
    parts = {name: declared[key] for name, key in INDIVIDUAL.items() if key in declared}
    if not turn and not parts:
        if origin and as_origin(origin) is None:
            sources.warnings.broken("transform-origin", "ignored", element.line)
        return None
    box = _reference_box(element, declared, context, sources)
    if box is None:
        return None
    units = Units(box[2] - box[0], box[3] - box[1], context.style.font_size)
    matrix = IDENTITY
    # In this order, whatever order they are declared in.
    for name in ("translate", "rotate", "scale"):
        text = parts.get(name, "none").strip()
        if text.lower() == "none":
            continue
        part = as_rotate(text) if name == "rotate" else _listed(f"{name}({text})", units)
        if part is None:
            sources.warnings.broken(f"{name} '{text[:40]}'", "ignored", element.line)
            continue
        matrix = multiplied(matrix, part)
    own = _listed(turn, units)
    if own is None:
        sources.warnings.broken("transform", "ignored", element.line)
        own = IDENTITY
    matrix = multiplied(matrix, own)
    turned = about_origin(matrix, origin, units, (box[0], box[1]))
    if turned is None:
        sources.warnings.broken("transform-origin", "ignored", element.line)
        return matrix
    return turned


def _listed(text: str, units: Units) -> Matrix | None:
    if not needs_whole(text):
        return as_transform(text)
    return as_transform(text, units.width, units.height, units.font_size)


def _reference_box(
    element: SvgElement, declared: Mapping[str, str], context: "Context", sources: "Sources"
) -> Box | None:
    """The box that `transform-box` names; None for one that the element does not have."""
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
