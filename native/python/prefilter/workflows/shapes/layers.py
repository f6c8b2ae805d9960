# SPDX-License-Identifier: GPL-3.0-or-later

"""Sources of rasterized images: layers of filled contours, UV maps, and SVG files."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

import prefilter

from ...options.colors import Color
from ...options.shapes import RasterizeSettings
from ...shapes.svg_image import SvgPicture
from ..matrices import product
from ..memory import Memory, free_memory
from ..progress import Progress, go_on, share
from ..up_to_date import fingerprint, fingerprint_of, is_self_contained
from .frames import Frame, check_memory, fitted_frame, whole_frame
from .outlines import add_contour, box_of

FloatArray = NDArray[np.float64]

_WHITE = (1.0, 1.0, 1.0, 1.0)
_TILES_PER_ROW = 10
_LAYERS_AT_ONCE = 64
_MOST_WARNINGS = 5


@dataclass(frozen=True)
class PlacedShapes:
    """Shapes placed in an image.

    Attributes:
        width: Pixels.
        height: Pixels.
        shapes: Shapes with one channel for coverage, otherwise four.
        color: The common color of all shapes, for coverage; None if each shape has its own.
        warnings: Warnings about omissions.
        place: Position of the image; None if unknown.
        draw: Draws content other than shapes, given a progress callback; None for shapes.
        light: Encoding of colors in the drawn image: "linear" or "srgb".
    """

    width: int
    height: int
    shapes: list["prefilter.Shape"]
    color: Color | None
    warnings: Sequence[str] = ()
    place: Any = None
    draw: Callable[[Progress], NDArray[Any]] | None = None
    light: str = "linear"


class Source(Protocol):
    """Content that has been read and can be drawn."""

    @property
    def name(self) -> str:
        """The name for the image."""

    def inputs(self, settings: RasterizeSettings) -> str | None:
        """Returns a fingerprint of all inputs; None if they are not all known.

        Raises:
            OSError: A file cannot be read.
        """

    def drawn(self, settings: RasterizeSettings, progress: Progress) -> PlacedShapes:
        """Returns the shapes placed in an image.

        Raises:
            ValueError: There are no shapes, or they do not fit the settings.
            OSError: A file cannot be read.
            MemoryError: The image would not fit into memory.
            prefilter.Cancelled: `progress` returned False.
        """


@dataclass(frozen=True)
class Layer:
    """Contours on a plane that are filled together, in the form of `outlines`."""

    contours: list[FloatArray]
    color: Color
    fill_rule: str


@dataclass(frozen=True)
class Layers:
    """Layers, from the farthest to the nearest."""

    name: str
    layers: list[Layer]
    frame: Frame | None
    """Placement of the plane in the image; None to fit it."""
    memory: Memory = free_memory
    placed: Callable[[Frame], Any] = lambda _: None
    """Returns the position of the image."""
    grown: float = 0.0
    """Distance in pixels by which shapes extend beyond their contours."""

    def inputs(self, settings: RasterizeSettings) -> str:
        """Returns a fingerprint of the contours, colors and settings."""
        arrays = [contour for layer in self.layers for contour in layer.contours]
        looks = [[len(each.contours), each.color, each.fill_rule] for each in self.layers]
        if self.frame is not None:
            arrays.append(self.frame.to_pixels)
        return fingerprint_of(
            arrays, {**_result_settings(settings), "looks": looks, "grown": self.grown}
        )

    def drawn(self, settings: RasterizeSettings, progress: Progress) -> PlacedShapes:
        """Returns the shapes placed in an image."""
        frame = self.frame
        if frame is None:
            boxes = np.array([box_of(one) for layer in self.layers for one in layer.contours])
            box = np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
            frame = fitted_frame(box, settings)
        check_memory(frame, self.memory)
        colors = {layer.color for layer in self.layers}
        if settings.color != "material":
            colors = {_WHITE}
        # A translucent color combines with itself only where shapes overlap.
        is_coverage = len(colors) <= 1 and all(color[3] == 1.0 for color in colors)
        shapes = []
        for i, layer in enumerate(self.layers):
            if i % _LAYERS_AT_ONCE == 0:
                go_on(progress, i / len(self.layers))
            shape = prefilter.Shape(layer.fill_rule)
            shape.color = (1.0,) if is_coverage else _associated(layer.color)
            for contour in layer.contours:
                add_contour(shape, product(contour, frame.to_pixels.T))
            shapes.append(shape)
            if self.grown > 0.0:
                shapes.append(shape.stroked(2.0 * self.grown, join="round"))
        color = next(iter(colors), _WHITE) if is_coverage else None
        return PlacedShapes(frame.width, frame.height, shapes, color, place=self.placed(frame))


@dataclass(frozen=True)
class _Svg:
    """An SVG file."""

    name: str
    path: Path
    memory: Memory
    placed: Callable[[FloatArray], Any]
    """Returns the position of the image, from half of its side lengths."""

    def inputs(self, settings: RasterizeSettings) -> str | None:
        """Returns a fingerprint of the file and the settings; None unless it is self-contained."""
        return (
            fingerprint([self.path], _result_settings(settings))
            if is_self_contained(self.path)
            else None
        )

    def drawn(self, settings: RasterizeSettings, progress: Progress) -> PlacedShapes:
        """Reads the file, and returns a function that draws it into an image."""
        fonts = [settings.font_folder] if settings.font_folder else None
        picture = SvgPicture(self.path, settings.light, fonts, share(progress, 0.0, 1.0))
        box = np.array([[0.0, 0.0], [picture.width, picture.height]])
        frame = fitted_frame(box, settings)
        check_memory(frame, self.memory)
        half = np.array([frame.width, frame.height]) / 2.0
        scale = frame.to_pixels[0, 0]
        half /= scale if settings.resolution == "density" else 2.0 * half.max()

        def draw(progress: Progress) -> NDArray[Any]:
            return picture.drawn(
                frame.width,
                frame.height,
                (scale, *frame.to_pixels[:2, 2].tolist()),
                filter_name=settings.filter,
                threads=settings.threads,
                progress=progress,
            )

        return PlacedShapes(
            frame.width,
            frame.height,
            [],
            None,
            self._warnings(picture),
            self.placed(half),
            draw,
            settings.light,
        )

    def _warnings(self, picture: SvgPicture) -> list[str]:
        warnings = [str(warning) for warning in picture.warnings]
        more = len(warnings) - _MOST_WARNINGS
        if more > 0:
            warnings[_MOST_WARNINGS:] = [f"and {more} more"]
        return [f"'{self.path.name}': {'; '.join(warnings)}"] if warnings else []


def _result_settings(settings: RasterizeSettings) -> dict[str, Any]:
    return {
        name: value
        for name, value in asdict(settings).items()
        if name not in ("threads", "filepath", "image_name")
    }


def uv_layers(
    name: str,
    polygons: Sequence[FloatArray],
    settings: RasterizeSettings,
    memory: Memory = free_memory,
) -> Layers:
    """Returns the area that a mesh's faces cover in a tile of UV space, as layers.

    Args:
        name: The name for the image.
        polygons: The borders of that area, from `layouts.borders`.
        settings: The tile, the size of the image, and the growth of the area.
        memory: Returns the available memory.
    """
    row, column = divmod(settings.tile - 1001, _TILES_PER_ROW)
    contours = []
    for polygon in polygons:
        corners = np.concatenate([polygon, np.ones((len(polygon), 1))], axis=1)
        contours.append(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1))
    low = (float(column), float(row))
    frame = whole_frame(settings.width, settings.height, low, (low[0] + 1.0, low[1] + 1.0))
    layers = [Layer(contours, _WHITE, "nonzero")]
    return Layers(name, layers, frame, memory, grown=settings.uv_margin)


def svg_drawing(
    argument: str,
    path: str,
    memory: Memory = free_memory,
    placed: Callable[[FloatArray], Any] = lambda _: None,
) -> Source:
    """Returns an SVG file as a source; it is read when it is drawn.

    Args:
        argument: The path's name in messages.
        path: The file.
        memory: Returns the available memory.
        placed: Returns the position of the image, from half of its side lengths.

    Raises:
        OSError: There is no such file.
    """
    file = Path(path)
    if not file.is_file():
        raise OSError(f"{argument}: there is no file '{path}'")
    return _Svg(file.stem, file, memory, placed)


def _associated(color: Color) -> Color:
    red, green, blue, alpha = color
    return red * alpha, green * alpha, blue * alpha, alpha
