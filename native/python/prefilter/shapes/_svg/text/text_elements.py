# SPDX-License-Identifier: GPL-3.0-or-later

"""Outlines of text elements."""

from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from ..._fonts.font import Glyph
from ...affine import Matrix, compose
from ..model.outline import Outline
from ..model.tree import Box
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.styles import Style
from .characters import Span, TextReader
from .color_glyphs import ColoredLetter, ColoredPiece
from .font_selection import FontSelector
from .layout import Cluster, TextLayout

# Thickness of text decorations, in em.
_LINE_THICKNESS = 0.1
# Glyphs transformed at a time.
_GLYPHS_PER_BATCH = 256


@dataclass(frozen=True, slots=True)
class TextPiece:
    """Glyphs or a decoration of one element.

    Attributes:
        element: The element that paints it.
        outline: In the text element's units; not empty.
    """

    element: SvgElement
    style: Style
    outline: Outline
    box: Box


@dataclass(frozen=True, slots=True)
class DrawnText:
    """A text element.

    Attributes:
        pieces: Bottom first.
        bounds: Bounding box of all glyph cells: from start to advance, and from ascent to descent.
            None without glyphs.
    """

    pieces: list[TextPiece | ColoredPiece]
    bounds: Box | None


def lay_out_text(element: SvgElement, context: Context, sources: Sources) -> DrawnText:
    """Lays out a text element; `context` is that within the element."""
    characters = TextReader(sources, context).read(element)
    if not characters:
        return DrawnText([], None)
    fonts = FontSelector(sources.fonts.fonts, sources.warnings)
    clusters = [
        cluster
        for cluster in TextLayout(fonts).lay_out(characters)
        if cluster.matrix is not None and cluster.scale > 0.0
    ]
    pieces: list[TextPiece | ColoredPiece] = []
    for span in dict.fromkeys(character.span for character in characters):
        own = [cluster for cluster in clusters if cluster.span is span]
        if own and span.style.visibility == "visible":
            pieces.extend(_pieces(span, own, fonts))
    return DrawnText(pieces, _bounds(clusters))


def _pieces(
    span: Span, clusters: Sequence[Cluster], fonts: FontSelector
) -> Iterator[TextPiece | ColoredPiece]:
    """Yields a span's glyphs, between the decorations below and above them."""
    lines = [(line, each) for each in span.ancestry() for line in each.lines]
    for name in ("underline", "overline"):
        for line, owner in lines:
            if line == name:
                yield from _piece(owner, _decoration(name, owner, span, clusters, fonts))
    plain, colored = [], []
    for cluster in clusters:
        for glyph, matrix in _place_glyphs(cluster):
            color_glyph = fonts.color_glyph_of(cluster.font, glyph, span)
            if color_glyph is None:
                plain.append((fonts.outline_of(cluster.font, glyph, span), matrix))
            else:
                colored.append(ColoredLetter(cluster.font, color_glyph, matrix))
    yield from _piece(span, _outline_of_glyphs(plain))
    if colored:
        yield ColoredPiece(span.element, span.style, colored)
    for line, owner in lines:
        if line == "line-through":
            yield from _piece(owner, _decoration(line, owner, span, clusters, fonts))


def _piece(span: Span, outline: Outline) -> Iterator[TextPiece]:
    """Yields an outline with a span's style, unless it is empty."""
    bounds = outline.shape("nonzero").bounds if len(outline) else None
    if bounds is not None:
        (left, top), (right, bottom) = bounds
        style = span.style
        if style.fill_rule != "nonzero":
            style = replace(style, fill_rule="nonzero")
        box = (float(left), float(top), float(right), float(bottom))
        yield TextPiece(span.element, style, outline, box)


def _place_glyphs(cluster: Cluster) -> Iterator[tuple[int, Matrix]]:
    """Yields glyphs with matrices from font units to the text's units."""
    assert cluster.matrix is not None
    scale, at = cluster.scale, 0.0
    wide = scale * cluster.stretch
    for shaped in cluster.glyphs:
        x, y = wide * (at + shaped.x), -scale * shaped.y
        own: Matrix = (wide, 0.0, wide * cluster.font.skew, -scale, x, y)
        yield shaped.glyph, compose(cluster.matrix, own)
        at += shaped.advance


def _outline_of_glyphs(placed: Sequence[tuple[Glyph, Matrix]]) -> Outline:
    """Transforms glyphs into one outline, a batch at a time."""
    outline = Outline()
    for first in range(0, len(placed), _GLYPHS_PER_BATCH):
        some = placed[first : first + _GLYPHS_PER_BATCH]
        points = np.concatenate([np.frombuffer(glyph.numbers) for glyph, _ in some]).reshape(-1, 2)
        counts = [len(glyph.numbers) // 2 for glyph, _ in some]
        a, b, c, d, e, f = np.repeat([matrix for _, matrix in some], counts, axis=0).T
        moved = np.empty_like(points)
        moved[:, 0] = a * points[:, 0] + c * points[:, 1] + e
        moved[:, 1] = b * points[:, 0] + d * points[:, 1] + f
        letters = b"".join(glyph.letters for glyph, _ in some)
        outline.extend(letters, array("d", moved.tobytes()))
    return outline


def _decoration(
    name: str, owner: Span, span: Span, clusters: Sequence[Cluster], fonts: FontSelector
) -> Outline:
    """Makes a decoration of an ancestor for a span, in one strip as far as the baseline is
    straight.
    """
    outline = Outline()
    font = fonts.font_of_span(span)
    if font is None:
        return outline
    metrics, size = font.metrics, span.style.font_size
    # Browsers ignore font metrics of lines; thickness and distance follow the font size.
    thickness = _LINE_THICKNESS
    middle = {
        "underline": -thickness,
        "overline": metrics.ascent + thickness,
        "line-through": metrics.ascent / 3.0,
    }[name]
    raised = fonts.shift_of(owner)
    strips: list[tuple[Matrix, float, float]] = []
    for cluster in clusters:
        assert cluster.matrix is not None
        shift, matrix, width = raised - cluster.shift, cluster.matrix, cluster.advance
        last = strips[-1] if strips else None
        if last is not None and last[2] == shift and _continues(last[0], last[1], matrix):
            strips[-1] = (last[0], matrix[4] + width - last[0][4], shift)
        else:
            strips.append((matrix, width, shift))
    for matrix, width, shift in strips:
        low = shift - (middle + (0.5 if name != "overline" else 0.0) * thickness) * size
        _add_box(outline, matrix, width, low, low + thickness * size)
    return outline


def _continues(before: Matrix, width: float, after: Matrix) -> bool:
    """Returns whether a cluster continues a horizontal strip."""
    is_upright = before[1] == after[1] == 0.0 and before[0] == after[0] and before[5] == after[5]
    return is_upright and abs(before[4] + width - after[4]) < 1e-6 * (1.0 + abs(width))


def _add_box(outline: Outline, matrix: Matrix, width: float, top: float, bottom: float) -> None:
    if width <= 0.0 or bottom <= top:
        return
    corners = [
        _apply(matrix, x, y) for x, y in ((0, top), (width, top), (width, bottom), (0, bottom))
    ]
    outline.move_to(*corners[0])
    for corner in corners[1:]:
        outline.line_to(*corner)
    outline.close()


def _apply(matrix: Matrix, x: float, y: float) -> tuple[float, float]:
    a, b, c, d, e, f = matrix
    return a * x + c * y + e, b * x + d * y + f


def _bounds(clusters: Sequence[Cluster]) -> Box | None:
    if not clusters:
        return None
    sizes = np.array([cluster.span.style.font_size for cluster in clusters])
    metrics = [(cluster.font.metrics.ascent, cluster.font.metrics.descent) for cluster in clusters]
    x = np.array([(0.0, cluster.advance) for cluster in clusters])[:, :, None]
    y = (-np.array(metrics) * sizes[:, None])[:, None, :]
    matrices = np.array([cast(Matrix, cluster.matrix) for cluster in clusters])
    a, b, c, d, e, f = matrices.T[:, :, None, None]
    xs, ys = a * x + c * y + e, b * x + d * y + f
    return float(xs.min()), float(ys.min()), float(xs.max()), float(ys.max())
