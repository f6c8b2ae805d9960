# SPDX-License-Identifier: GPL-3.0-or-later

"""Text as outlines."""

from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from ..._fonts.font import Glyph
from ...affine import Matrix, multiplied
from ..model.outline import Outline
from ..model.tree import Box
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.styles import Style
from .characters import Span, TextReader
from .color_glyphs import ColoredLetter, ColoredPiece
from .layout import Cluster, TextLayout
from .lettering import Lettering

# Of lines at letters, in sizes of these.
_LINE_THICKNESS = 0.1
# Letters whose points are moved at once.
_TOGETHER = 256


@dataclass(frozen=True, slots=True)
class TextPiece:
    """Letters of one element, or a line at them.

    Attributes:
        element: What the line, or the letters, belong to.
        style: Its properties.
        outline: In the units of the text element; not empty.
        box: Around it.
    """

    element: SvgElement
    style: Style
    outline: Outline
    box: Box


@dataclass(frozen=True, slots=True)
class DrawnText:
    """A text element.

    Attributes:
        pieces: First what is below.
        bounds: The box around the cells of all letters: as wide as they lead, and from the highest
            to the lowest of their font. None where there are none.
    """

    pieces: list[TextPiece | ColoredPiece]
    bounds: Box | None


def drawn_text(element: SvgElement, context: Context, sources: Sources) -> DrawnText:
    """The outlines of a text element.

    Args:
        element: The element.
        context: Within it.
        sources: What it is read with.
    """
    characters = TextReader(sources, context).read(element)
    if not characters:
        return DrawnText([], None)
    lettering = Lettering(sources.fonts.fonts, sources.warnings)
    clusters = [
        cluster
        for cluster in TextLayout(lettering).lay_out(characters)
        if cluster.matrix is not None and cluster.scale > 0.0
    ]
    pieces: list[TextPiece | ColoredPiece] = []
    for span in dict.fromkeys(character.span for character in characters):
        own = [cluster for cluster in clusters if cluster.span is span]
        if own and span.style.visibility == "visible":
            pieces.extend(_pieces(span, own, lettering))
    return DrawnText(pieces, _bounds(clusters))


def _pieces(
    span: Span, clusters: Sequence[Cluster], lettering: Lettering
) -> Iterator[TextPiece | ColoredPiece]:
    """Yields the letters of a span between the lines below and above them."""
    lines = [(line, each) for each in span.line() for line in each.lines]
    for name in ("underline", "overline"):
        for line, owner in lines:
            if line == name:
                yield from _piece(owner, _line(name, owner, span, clusters, lettering))
    plain, colored = [], []
    for cluster in clusters:
        for glyph, matrix in _placed(cluster):
            look = lettering.look_of(cluster.font, glyph, span)
            if look is None:
                plain.append((lettering.outline_of(cluster.font, glyph, span), matrix))
            else:
                colored.append(ColoredLetter(cluster.font, look, matrix))
    yield from _piece(span, _letters(plain))
    if colored:
        yield ColoredPiece(span.element, span.style, colored)
    for line, owner in lines:
        if line == "line-through":
            yield from _piece(owner, _line(line, owner, span, clusters, lettering))


def _piece(span: Span, outline: Outline) -> Iterator[TextPiece]:
    """Yields an outline with the paint of a span, if there is anything in it."""
    found = outline.shape("nonzero").bounds if len(outline) else None
    if found is not None:
        (left, top), (right, bottom) = found
        style = span.style
        if style.fill_rule != "nonzero":
            style = replace(style, fill_rule="nonzero")
        box = (float(left), float(top), float(right), float(bottom))
        yield TextPiece(span.element, style, outline, box)


def _placed(cluster: Cluster) -> Iterator[tuple[int, Matrix]]:
    """Yields glyphs, and what leads from units of their font to those of the text."""
    assert cluster.matrix is not None
    scale, at = cluster.scale, 0.0
    wide = scale * cluster.stretch
    for shaped in cluster.glyphs:
        x, y = wide * (at + shaped.x), -scale * shaped.y
        own: Matrix = (wide, 0.0, wide * cluster.font.skew, -scale, x, y)
        yield shaped.glyph, multiplied(cluster.matrix, own)
        at += shaped.advance


def _letters(placed: Sequence[tuple[Glyph, Matrix]]) -> Outline:
    """Glyphs where they stand, many of them at a time."""
    outline = Outline()
    for first in range(0, len(placed), _TOGETHER):
        some = placed[first : first + _TOGETHER]
        points = np.concatenate([np.frombuffer(glyph.numbers) for glyph, _ in some]).reshape(-1, 2)
        counts = [len(glyph.numbers) // 2 for glyph, _ in some]
        a, b, c, d, e, f = np.repeat([matrix for _, matrix in some], counts, axis=0).T
        moved = np.empty_like(points)
        moved[:, 0] = a * points[:, 0] + c * points[:, 1] + e
        moved[:, 1] = b * points[:, 0] + d * points[:, 1] + f
        letters = b"".join(glyph.letters for glyph, _ in some)
        outline.extend(letters, array("d", moved.tobytes()))
    return outline


def _line(
    name: str, owner: Span, span: Span, clusters: Sequence[Cluster], lettering: Lettering
) -> Outline:
    """A line of an element at letters of one in it, straight as far as they stand on one."""
    outline = Outline()
    font = lettering.font_of_span(span)
    if font is None:
        return outline
    metrics, size = font.metrics, span.style.font_size
    # As in browsers, whatever the font says, and as large as the letters are.
    thickness = _LINE_THICKNESS
    middle = {
        "underline": -thickness,
        "overline": metrics.ascent + thickness,
        "line-through": metrics.ascent / 3.0,
    }[name]
    raised = lettering.shift_of(owner)
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
    """Whether what is there begins where a strip that is not turned ends."""
    is_upright = before[1] == after[1] == 0.0 and before[0] == after[0] and before[5] == after[5]
    return is_upright and abs(before[4] + width - after[4]) < 1e-6 * (1.0 + abs(width))


def _add_box(outline: Outline, matrix: Matrix, width: float, top: float, bottom: float) -> None:
    if width <= 0.0 or bottom <= top:
        return
    corners = [
        _through(matrix, x, y) for x, y in ((0, top), (width, top), (width, bottom), (0, bottom))
    ]
    outline.move_to(*corners[0])
    for corner in corners[1:]:
        outline.line_to(*corner)
    outline.close()


def _through(matrix: Matrix, x: float, y: float) -> tuple[float, float]:
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
