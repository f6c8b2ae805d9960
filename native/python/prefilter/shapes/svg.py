# SPDX-License-Identifier: GPL-3.0-or-later

"""SVG drawings as shapes."""

import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from .._border.arguments import ProgressCallback, as_one_of, as_progress
from .._native import Cancelled
from ._svg.model.warnings import SvgWarning, Warnings
from .shape import Shape

if TYPE_CHECKING:
    from ._svg.draw.drawing import Drawing


class SvgDrawing:
    """A drawing as shapes, for any size. Made by `read_svg`.

    Shapes are in pixels, y upwards, as `rasterize` takes them, bottom first: rasterize them with
    `overlap="cover"`. Colors are red, green and blue premultiplied by alpha, and alpha.
    """

    def __init__(self, name: str, drawing: "Drawing", light: str, warnings: Warnings) -> None:
        from ._svg.draw.flattening import FlatTree
        from ._svg.draw.opening import as_value_errors

        self._name = name
        self._drawing = drawing
        self._light = light
        with as_value_errors(name):
            self._painted = FlatTree(drawing.tree, warnings).painted
        self._warnings = warnings.all()
        self._shapes: list[Shape] | None = None

    @property
    def width(self) -> float:
        """Width in pixels, from the file; by default from the view box, or 300."""
        return self._drawing.page.width

    @property
    def height(self) -> float:
        """Height in pixels, from the file; by default from the view box, or 150."""
        return self._drawing.page.height

    @property
    def light(self) -> str:
        """Encoding of the colors: "linear" or "srgb"."""
        return self._light

    @property
    def warnings(self) -> tuple[SvgWarning, ...]:
        """Warnings about parts of the file missing in the shapes, in the order of the file."""
        return self._warnings

    @property
    def shapes(self) -> list[Shape]:
        """The shapes at `width` x `height`, as a new list."""
        if self._shapes is None:
            self._shapes = self.shapes_for(self.width, self.height)
        return list(self._shapes)

    def shapes_for(
        self, width: float, height: float, *, progress: ProgressCallback | None = None
    ) -> list[Shape]:
        """Returns the shapes for another size.

        The drawing is fitted into it by its preserveAspectRatio: by default as large as possible,
        and centered. Strokes are computed for the size.

        Args:
            width: In pixels, positive.
            height: In pixels, positive.
            progress: Called with the fraction done; returning False stops the work.

        Raises:
            ValueError: A side is not positive.
            Cancelled: `progress` returned False.
        """
        for name, side in (("width", width), ("height", height)):
            if isinstance(side, bool) or not 0.0 < side < 1e7:
                raise ValueError(f"{name}: {side!r}; a positive number of pixels is needed")
        from ._svg.draw.outlines import ShapeBuilder

        report = progress_reporter(as_progress(progress))
        to_pixels, around = self._drawing.placement(float(width), float(height))
        outlining = ShapeBuilder()
        shapes = []
        background = self._drawing.background_in(to_pixels)
        if background is not None:
            shapes.append(background)
        for index, (item, opacity) in enumerate(self._painted):
            if index % 20 == 0:
                report(index / len(self._painted))
            shape = outlining.shape(item, to_pixels, opacity, around)
            if shape is not None:
                shapes.append(shape)
        return shapes


def read_svg(
    source: str | os.PathLike[str] | bytes,
    *,
    light: str = "srgb",
    fonts: Iterable[str | os.PathLike[str]] | None = None,
    progress: ProgressCallback | None = None,
) -> SvgDrawing:
    """Reads a drawing: its paths, basic shapes and text, with colors, gradients and strokes.

    Glyphs become outlines. Layers, images, patterns and filters are left out or ignored, with
    `warnings` in the result. Arcs, circles and ellipses stay exact.

    Args:
        source: Path of a file, plain (.svg) or compressed (.svgz); or markup, as text that begins
            with "<", or as bytes.
        light: SVG blends colors in their encoding for display. "srgb": colors stay encoded, so that
            everything looks as in a browser; so is an image of them. "linear": colors are decoded;
            gradients look as in a browser, but translucent shapes blend in linear light.
        fonts: Font files and folders for text, in order of preference. Only these are used, so that
            the drawing is the same on every system. None: the system's fonts.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        The drawing. Invalid parts of the file are left out, with warnings.

    Raises:
        ValueError: The source is no drawing, its XML is not well-formed, or it exceeds a size
            limit; the message names the file and the line.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    as_one_of("light", light, ("linear", "srgb"))
    # CSS modules load slowly, and are only needed for drawings.
    from ._svg.draw.opening import open_drawing
    from ._svg.model.gradients import Colors

    report = progress_reporter(as_progress(progress))
    colors = Colors(light == "linear", is_stepped=False)
    name, drawing, warnings = open_drawing(
        source, colors=colors, reads_files=False, report=report, fonts=fonts
    )
    return SvgDrawing(name, drawing, light, warnings)


def progress_reporter(progress: ProgressCallback | None) -> Callable[[float], None]:
    """Returns a function that reports progress, and raises Cancelled if told to stop."""

    def report(share: float) -> None:
        if progress is not None and progress(share) is False:
            raise Cancelled("cancelled by the progress callback")

    return report
