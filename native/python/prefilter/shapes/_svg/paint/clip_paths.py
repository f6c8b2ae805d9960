# SPDX-License-Identifier: GPL-3.0-or-later

"""Clip paths."""

from collections.abc import Iterator
from dataclasses import replace

from ...affine import compose
from ..model.tree import Clip, ClipPart, make_clip
from ..model.values import parse_paint
from ..read.basic_shapes import BASIC_SHAPES
from ..read.context import Context, Sources
from ..read.document import NOT_DRAWN, SvgElement
from ..read.nesting import enter_element, resolve_use
from .bounds import object_bounds


def apply_clip_path(element: SvgElement, context: Context, sources: Sources) -> Context | None:
    """Clips the context within an element at its clip path; returns None if nothing is visible."""
    text = sources.sheets.declared(element).get("clip-path", "none")
    if text.lower() == "none":
        return context
    paint = parse_paint(text)
    if paint is None or not paint.server:
        sources.warnings.unsupported("clip-path", f"ignored: {text[:40]}", element.line)
        return context
    path = sources.resolve_url(text)
    if path is None or path.tag != "clipPath":
        sources.warnings.broken("clip-path", "ignored", element.line)
        return context
    if path in context.uses:
        sources.warnings.broken("clip-path", "ignored, as it refers to itself", element.line)
        return context
    clip = _clip(path, element, context, sources)
    if clip is None:
        return None
    return replace(context, clips=(*context.clips, clip))


def _clip(path: SvgElement, element: SvgElement, context: Context, sources: Sources) -> Clip | None:
    """Reads a clip path; returns None if it is empty."""
    path_context = replace(context, clips=(), uses=(*context.uses, path), use=None)
    outer = apply_clip_path(path, path_context, sources)
    if outer is None:
        return None
    inside = enter_element(path, path_context, sources)
    if path.get("clipPathUnits") == "objectBoundingBox":
        box = object_bounds(element, context, sources)
        if box is None or box[2] <= box[0] or box[3] <= box[1]:
            return None
        to_box = (box[2] - box[0], 0.0, 0.0, box[3] - box[1], box[0], box[1])
        inside = replace(inside, matrix=compose(inside.matrix, to_box), viewport=(1.0, 1.0))
    inside = replace(inside, style=sources.sheets.style(path))
    parts: list[ClipPart] = []
    for child in path:
        assert isinstance(child, SvgElement)
        if child.tag not in NOT_DRAWN:
            parts.extend(_parts(child, inside, sources))
    clip = make_clip(parts, outer.clips)
    return clip if clip.bounds is not None else None


def _parts(child: SvgElement, context: Context, sources: Sources) -> Iterator[ClipPart]:
    """Yields the outlines of a child of a clip path."""
    declared = sources.sheets.declared(child)
    if declared.get("display", "") == "none":
        return
    inner = apply_clip_path(
        child, enter_element(child, replace(context, clips=()), sources), sources
    )
    if inner is None:
        return
    if child.tag == "use":
        for target, inside in resolve_use(child, inner, sources):
            if target.tag in BASIC_SHAPES or target.tag == "text":
                for part in _parts(target, inside, sources):
                    yield replace(part, clips=(*inner.clips, *part.clips))
        return
    if child.tag == "text":
        # Font modules load slowly, and drawings without text do not need them.
        from ..text.text_elements import TextPiece, lay_out_text

        for piece in lay_out_text(child, inner, sources).pieces:
            if not isinstance(piece, TextPiece):
                continue
            sources.budget.take_segments(len(piece.outline), 0.0)
            yield ClipPart(piece.outline, "nonzero", inner.matrix, inner.clips)
    if child.tag not in BASIC_SHAPES or child.tag == "line":
        return
    outline = sources.outline(child, inner.units)
    if outline is None or inner.style.visibility != "visible":
        return
    sources.budget.take_segments(len(outline), 0.0)
    yield ClipPart(outline, inner.style.clip_rule, inner.matrix, inner.clips)
