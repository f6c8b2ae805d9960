# SPDX-License-Identifier: GPL-3.0-or-later

"""Text layout: characters become clusters of glyphs, which follow each other."""

import math
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from ..._fonts.bidi import embedding_levels, visual_order
from ..._fonts.font import Font
from ..._fonts.shaping import (
    COMPLEX,
    HAS_HARFBUZZ,
    JOINING,
    Features,
    ShapedGlyph,
    detect_scripts,
    shape,
)
from ...affine import Matrix, compose, translation
from ..model.values import rotation
from .characters import Character, Fitted, Span
from .font_selection import FontSelector

_SPACES = (" ", "\u00a0")


@dataclass(slots=True)
class Cluster:
    """Glyphs that represent characters together.

    Attributes:
        glyphs: From left to right.
        advance: Distance to the next cluster in pixels, spacing included.
        spacing: Letter spacing after it.
        stretch: Horizontal scale.
        shift: Offset of its baseline below the line.
        matrix: From its origin on the baseline to the text's units; None if it is not drawn.
    """

    characters: Sequence[Character]
    font: Font
    glyphs: list[ShapedGlyph]
    advance: float
    spacing: float = 0.0
    stretch: float = 1.0
    shift: float = 0.0
    matrix: Matrix | None = None

    @property
    def span(self) -> Span:
        """The first character's span."""
        return self.characters[0].span

    @property
    def scale(self) -> float:
        """Pixels per font unit."""
        return self.span.style.font_size / self.font.units_per_em


@dataclass(slots=True)
class _Run:
    """Characters shaped together."""

    begin: int
    end: int
    font: Font
    level: int
    script: str


class TextLayout:
    """Lays out text."""

    def __init__(self, fonts: FontSelector) -> None:
        self._fonts = fonts
        self._at = (0.0, 0.0)

    def lay_out(self, characters: Sequence[Character]) -> list[Cluster]:
        """Returns the clusters of a text, with their matrices."""
        chunks = [(chunk, self._clusters(chunk)) for chunk in _chunks(characters) if chunk]
        everything = [cluster for _, clusters in chunks for cluster in clusters]
        _fit(everything)
        self._at = (0.0, 0.0)
        for chunk, clusters in chunks:
            self._place(chunk, clusters)
        return everything

    def _clusters(self, chunk: Sequence[Character]) -> list[Cluster]:
        """Shapes the characters of a chunk; returns clusters from left to right."""
        text = "".join(character.letter for character in chunk)
        base = 1 if next(chunk[0].span.ancestry()).text.direction == "rtl" else 0
        levels = embedding_levels(text, base, [character.span.forced for character in chunk])
        runs = list(self._runs(chunk, text, levels))
        order = visual_order([run.level for run in runs])
        clusters = [cluster for index in order for cluster in self._shape(chunk, runs[index])]
        # No letter spacing after the last cluster.
        for cluster in clusters[:-1]:
            cluster.advance += cluster.spacing
        if clusters:
            clusters[-1].spacing = 0.0
        return clusters

    def _runs(self, chunk: Sequence[Character], text: str, levels: Sequence[int]) -> Iterator[_Run]:
        fonts = self._fonts.fonts_of(chunk)
        keys = [
            (font, level, script, _key(character.span))
            for font, level, script, character in zip(
                fonts, levels, detect_scripts(text), chunk, strict=True
            )
        ]
        begin = 0
        for (font, level, script, _), group in groupby(keys):
            end = begin + len(list(group))
            if font is not None:
                yield _Run(begin, end, font, level, script)
            begin = end

    def _shape(self, chunk: Sequence[Character], run: _Run) -> Iterator[Cluster]:
        characters = chunk[run.begin : run.end]
        span = characters[0].span
        style = span.text
        if run.script in COMPLEX and not HAS_HARFBUZZ:
            self._fonts.warnings.unsupported(
                f"script {run.script}",
                "letters are not joined without uharfbuzz",
                span.element.line,
            )
        features = Features(
            style.has_kerning, style.letter_spacing == 0.0, style.has_small_capitals
        )
        text = "".join(character.letter for character in characters)
        glyphs = shape(run.font, text, run.script, span.language, features, run.level % 2 == 1)
        if not glyphs:
            return
        starts = sorted({glyph.cluster for glyph in glyphs})
        ends = dict(zip(starts, [*starts[1:], len(text)], strict=True))
        for start, group in groupby(glyphs, lambda glyph: glyph.cluster):
            inside = characters[start : ends[start]]
            cluster_glyphs = list(group)
            cluster = Cluster(inside, run.font, cluster_glyphs, 0.0)
            cluster.advance = cluster.scale * sum(glyph.advance for glyph in cluster_glyphs)
            own = inside[0].span.text
            if run.script not in JOINING or detect_scripts(inside[0].letter)[0] not in JOINING:
                cluster.spacing = own.letter_spacing
            if inside[0].letter in _SPACES:
                cluster.advance += own.word_spacing
            cluster.shift = self._fonts.shift_of(inside[0].span)
            yield cluster

    def _place(self, chunk: Sequence[Character], clusters: list[Cluster]) -> None:
        """Positions the clusters of a chunk."""
        first = chunk[0]
        along = first.span.path
        x = self._at[0] if first.x is None else first.x
        y = self._at[1] if first.y is None else first.y
        if along is not None:
            x, y = along.offset + (first.x or 0.0), 0.0
        style = first.span.text
        is_vertical = along is None and next(first.span.ancestry()).text.is_vertical
        low, high = _extent(clusters, is_vertical)
        share = {"start": 0.0, "middle": 0.5, "end": 1.0}[style.anchor]
        if style.direction == "rtl":
            share = 1.0 - share
        # SVG 2, 11.5: the anchor applies to the extent of all glyphs of the chunk, with dx and dy
        # applied; that point comes to the position of the first glyph.
        shift = low + share * (high - low) - (first.dx, first.dy)[is_vertical]
        if is_vertical:
            y -= shift
        else:
            x -= shift
        for cluster in clusters:
            head = cluster.characters[0]
            x += sum(each.dx for each in cluster.characters)
            y += sum(each.dy for each in cluster.characters)
            if is_vertical:
                cluster.matrix = _downward(cluster, head, x, y)
                y += cluster.advance
            else:
                cluster.matrix = _matrix(cluster, head, x, y)
                x += cluster.advance
        if along is None:
            self._at = (x, y)
        else:
            end = along.track.at(along.track.length)
            self._at = (end[4], end[5]) if end is not None else self._at


def _extent(clusters: Sequence[Cluster], is_vertical: bool) -> tuple[float, float]:
    """Returns the least and greatest position of clusters along their line."""
    at = 0.0
    low, high = math.inf, -math.inf
    for cluster in clusters:
        at += sum((each.dx, each.dy)[is_vertical] for each in cluster.characters)
        low = min(low, at, at + cluster.advance)
        high = max(high, at, at + cluster.advance)
        at += cluster.advance
    return (low, high) if clusters else (0.0, 0.0)


def _matrix(cluster: Cluster, head: Character, x: float, y: float) -> Matrix | None:
    below = y + cluster.shift
    place = head.span.path
    if place is None:
        matrix: Matrix | None = translation(x, below)
    else:
        half = 0.5 * (cluster.advance - cluster.spacing)
        matrix = place.track.at(x + half)
        if matrix is not None:
            matrix = compose(matrix, translation(-half, below))
    if matrix is not None and head.rotate != 0.0:
        matrix = compose(matrix, rotation(head.rotate))
    return matrix


def _downward(cluster: Cluster, head: Character, x: float, y: float) -> Matrix:
    """Returns the matrix of a cluster in vertical text, rotated by 90 degrees and centered on the
    line.

    Upright characters, such as Chinese, are rotated back around their centers.
    """
    metrics = cluster.font.metrics
    middle = 0.5 * (metrics.ascent + metrics.descent) * cluster.span.style.font_size
    matrix = compose((0.0, 1.0, -1.0, 0.0, x, y), translation(0.0, cluster.shift + middle))
    if _is_upright(head.letter):
        half = (cluster.advance - cluster.spacing) / 2.0
        matrix = compose(matrix, (0.0, -1.0, 1.0, 0.0, half + middle, half - middle))
    if head.rotate != 0.0:
        matrix = compose(matrix, rotation(head.rotate))
    return matrix


def _is_upright(letter: str) -> bool:
    is_wide = unicodedata.east_asian_width(letter) in ("W", "F")
    return is_wide and not unicodedata.category(letter).startswith("P")


def _chunks(characters: Sequence[Character]) -> Iterator[Sequence[Character]]:
    """Splits characters into chunks, each with an absolute position or a path."""
    begin = 0
    for index, character in enumerate(characters):
        previous_path = characters[index - 1].span.path if index else character.span.path
        is_new = character.span.path is not previous_path
        if character.x is not None or (character.y is not None and character.span.path is None):
            is_new = True
        if is_new and index > begin:
            yield characters[begin:index]
            begin = index
    yield characters[begin:]


def _key(span: Span) -> object:
    """Returns the properties that all characters of a run share."""
    style = span.text
    return (
        span.style.font_size,
        style.has_kerning,
        style.letter_spacing == 0.0,
        style.has_small_capitals,
        span.language,
    )


def _fit(clusters: Sequence[Cluster]) -> None:
    """Fits elements with `textLength`."""
    clusters_by_span: dict[Span, list[Cluster]] = {}
    for cluster in clusters:
        # The innermost element takes precedence.
        for span in (cluster.span, *reversed(cluster.span.around)):
            if span.fitted is not None:
                clusters_by_span.setdefault(span, []).append(cluster)
                break
    for span, inside in clusters_by_span.items():
        assert span.fitted is not None
        _fit_span(inside, span.fitted)


def _fit_span(clusters: Sequence[Cluster], fitted: Fitted) -> None:
    natural = sum(cluster.advance for cluster in clusters)
    if fitted.is_stretched:
        if natural > 0.0:
            factor = fitted.length / natural
            for cluster in clusters:
                cluster.advance *= factor
                cluster.stretch *= factor
        return
    if len(clusters) > 1:
        more = (fitted.length - natural) / (len(clusters) - 1)
        for cluster in clusters[:-1]:
            cluster.advance += more
            cluster.spacing += more
