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
    """What a drawing shows, in any size. `read_svg` makes it.

    The shapes are in pixels, with y upwards, as `rasterize` takes them; those that come first are
    below, so that they want `overlap="cover"`. Their colors have red, green, blue and alpha, the
    first three multiplied by alpha.
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
        """What the file says of its width, in pixels; from its view box, or 300, if nothing."""
        return self._drawing.page.width

    @property
    def height(self) -> float:
        """What the file says of its height, in pixels; from its view box, or 150, if nothing."""
        return self._drawing.page.height

    @property
    def light(self) -> str:
        """What the colors are: "linear" or "srgb"."""
        return self._light

    @property
    def warnings(self) -> tuple[SvgWarning, ...]:
        """What was found in the file and is not in the shapes, in the order of the file."""
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
        """The shapes for an image of another size.

        The drawing fills it as its preserveAspectRatio says: usually as large as fits, in the
        middle. Strokes are made for the size.

        Args:
            width: In pixels, positive.
            height: In pixels, positive.
            progress: Called with the share that is done; False stops.

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

    Letters are outlines of their fonts. What needs layers, pictures, patterns and filters is left
    out or ignored; the `warnings` of the result tell of it. Arcs, circles and ellipses stay exact.

    Args:
        source: The path of a file, plain (.svg) or compressed (.svgz); or markup, as text that
            begins with "<", or as bytes.
        light: SVG blends colors as they are encoded for display. "linear": they are decoded, and
            gradients look as in a browser; what is translucent blends as light does. "srgb": they
            stay encoded, so that all looks as in a browser; so is an image of them.
        fonts: Files and folders of fonts for text, the best first: only these, so that the drawing
            is the same on every system. None: the fonts of the system.
        progress: Called with the share that is done; False stops.

    Returns:
        The drawing. Where the file is wrong in places, what is right, with a warning for the rest.

    Raises:
        ValueError: There is no drawing in the source, or XML that is broken, or what would take no
            end of memory; the message names the file and the line.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    as_one_of("light", light, ("linear", "srgb"))
    # Style sheets take modules that those who read no drawings need not wait for.
    from ._svg.draw.opening import open_drawing
    from ._svg.model.gradients import Colors

    report = progress_reporter(as_progress(progress))
    colors = Colors(light == "linear", is_stepped=False)
    name, drawing, warnings = open_drawing(
        source, colors=colors, reads_files=False, report=report, fonts=fonts
    )
    return SvgDrawing(name, drawing, light, warnings)


def progress_reporter(progress: ProgressCallback | None) -> Callable[[float], None]:
    """Returns what tells of progress, and raises Cancelled where that says so."""

    def report(share: float) -> None:
        if progress is not None and progress(share) is False:
            raise Cancelled("cancelled by the progress callback")

    return report
