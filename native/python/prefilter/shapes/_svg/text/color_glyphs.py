# SPDX-License-Identifier: GPL-3.0-or-later

"""Colored glyphs as items of a tree."""

from collections.abc import Sequence
from dataclasses import dataclass

from ..._fonts.bitmaps import Bitmap
from ..._fonts.color_layers import ColorFill, ColorGroup, ColorStop
from ..._fonts.font import Font
from ...affine import Matrix, compose, determinant, inverse
from ..model.colors import Color
from ..model.gradients import Colors, Gradient, Stop, sample_stops
from ..model.outline import Outline
from ..model.tree import Clip, ClipPart, Group, Mask, Painted, Picture, make_clip, transform_box
from ..model.values import BLACK
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.image_files import ImageError, decode_image, image_size
from ..read.styles import Style

# Half side of the square that an unbounded fill covers, in em.
_UNBOUNDED_EM = 8.0


@dataclass(frozen=True, slots=True)
class ColoredLetter:
    """A glyph.

    Attributes:
        color_glyph: Its layers, or its bitmap.
        matrix: From font units, y upwards, to the text element's units.
    """

    font: Font
    color_glyph: ColorGroup | Bitmap
    matrix: Matrix


@dataclass(frozen=True, slots=True)
class ColoredPiece:
    """Colored glyphs of one element, in order."""

    element: SvgElement
    style: Style
    letters: Sequence[ColoredLetter]


def draw_colored(piece: ColoredPiece, context: Context, sources: Sources) -> None:
    """Draws colored glyphs; the text's fill gives visibility, opacity and the current color.

    Args:
        context: The context within the text element.
    """
    style, line = piece.style, piece.element.line
    paint = style.fill
    if paint.color is None and not paint.server:
        return
    color = style.color if paint.color == "current" else paint.color
    target = Group(opacity=context.colors.opacity(style.fill_opacity), is_isolated=True, line=line)
    context.target.items.append(target)
    own = color if isinstance(color, tuple) else BLACK
    drawing = _GlyphDrawer(context.colors, own, sources, line)
    for letter in piece.letters:
        drawing.draw(letter, compose(context.matrix, letter.matrix), context.clips, target)


class _GlyphDrawer:
    """Draws glyphs with one current color."""

    def __init__(self, colors: Colors, color: Color, sources: Sources, line: int) -> None:
        self._colors = colors
        self._color = color
        self._sources = sources
        self._line = line

    def draw(
        self, letter: ColoredLetter, matrix: Matrix, clips: tuple[Clip, ...], target: Group
    ) -> None:
        """Draws a glyph; the matrix leads from font units to the tree's."""
        if determinant(matrix) == 0.0:
            return
        if isinstance(letter.color_glyph, Bitmap):
            self._draw_bitmap(letter.color_glyph, matrix, clips, target)
        else:
            self._draw_group(letter.font, letter.color_glyph, matrix, clips, target)

    def _draw_bitmap(
        self, bitmap: Bitmap, matrix: Matrix, clips: tuple[Clip, ...], target: Group
    ) -> None:
        width, height = image_size(bitmap.data)
        known = self._sources.letters
        if bitmap not in known:
            self._sources.budget.take_texels(width * height)
            try:
                known[bitmap] = decode_image(bitmap.data)
            except ImageError as error:
                self._sources.warnings.broken("letter", f"left out, {error}", self._line)
                return
        wide, high = width * bitmap.unit, height * bitmap.unit
        top = bitmap.edge if bitmap.is_top else bitmap.edge + high
        unit = compose(matrix, (wide, 0.0, 0.0, -high, bitmap.left, top))
        box = transform_box((0.0, 0.0, 1.0, 1.0), unit)
        is_linear = self._colors.is_linear
        target.items.append(Picture(known[bitmap], unit, False, is_linear, clips, box, self._line))

    def _draw_group(
        self,
        font: Font,
        group: ColorGroup,
        matrix: Matrix,
        clips: tuple[Clip, ...],
        target: Group,
    ) -> None:
        """Draws layers, in a group of their own if they are blended or masked."""
        self._sources.budget.take_element()
        if group.cut is not None:
            glyph, glyph_matrix = group.cut
            outline = self._outline(font, glyph)
            self._sources.budget.take_segments(len(outline), 0.0)
            part = ClipPart(outline, "nonzero", compose(matrix, glyph_matrix))
            clip = make_clip([part], ())
            if clip.bounds is None:
                return
            clips = (*clips, clip)
        if group.inside is not None or group.blend != "normal":
            masks: tuple[Mask, ...] = ()
            if group.inside is not None:
                seen = Group(is_isolated=True, line=self._line)
                self._draw_group(font, group.inside, matrix, (), seen)
                masks = (Mask(seen, is_luminance=False, is_linear=False),)
            inner_group = Group(blend=group.blend, masks=masks, is_isolated=True, line=self._line)
            target.items.append(inner_group)
            target = inner_group
        for item in group.items:
            if isinstance(item, ColorGroup):
                self._draw_group(font, item, matrix, clips, target)
            else:
                self._fill(font, item, matrix, clips, target)

    def _fill(
        self,
        font: Font,
        fill: ColorFill,
        matrix: Matrix,
        clips: tuple[Clip, ...],
        target: Group,
    ) -> None:
        outline = self._outline(font, fill.glyph)
        bounds = outline.bounds() if len(outline) else None
        if bounds is None or determinant(fill.matrix) == 0.0:
            return
        self._sources.budget.take_segments(len(outline), 0.0)
        whole = compose(matrix, fill.matrix)
        box = transform_box(bounds, whole)
        paint = self._paint(fill)
        target.items.append(Painted(outline, "nonzero", whole, paint, None, clips, box, self._line))

    def _paint(self, fill: ColorFill) -> tuple[float, ...] | Gradient:
        stops = [Stop(stop.offset, self._color_of(stop)) for stop in fill.stops]
        if fill.kind == "solid" or determinant(fill.paint_matrix) == 0.0:
            return next(iter(sample_stops(stops[:1], self._colors)))[1]
        is_radial = fill.kind == "radial"
        matrix = compose(inverse(fill.matrix), fill.paint_matrix)
        pieces = list(sample_stops(stops, self._colors))
        return Gradient(is_radial, fill.numbers, pieces, fill.spread, matrix)

    def _color_of(self, stop: ColorStop) -> Color:
        color = self._color if stop.color is None else stop.color
        return (*color[:3], color[3] * min(max(stop.alpha, 0.0), 1.0))

    def _outline(self, font: Font, number: int | None) -> Outline:
        """Returns the outline of a glyph in font units, or a large square for None."""
        outline = Outline()
        if number is None:
            side = _UNBOUNDED_EM * font.units_per_em
            outline.rectangle(-side, -side, 2.0 * side, 2.0 * side, 0.0, 0.0)
        else:
            glyph = font.glyph(number)
            outline.extend(glyph.letters, glyph.numbers)
        return outline
