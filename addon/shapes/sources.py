# SPDX-License-Identifier: GPL-3.0-or-later

"""What is made an image of: curves and texts, a UV map, an SVG file."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import bpy
import numpy as np
import prefilter
from mathutils import Quaternion
from numpy.typing import NDArray

from ..bridge.curves import Curves, read_curves
from ..bridge.materials import WHITE
from ..bridge.outlines import add_contour, box_of
from ..bridge.uv_layouts import read_layout
from ..core.colors import Color
from ..core.jobs import Progress, go_on, share
from ..core.wording import Sentence, counted, listed
from .choices import RasterizeSettings
from .framing import Frame, Place, check_memory, find_view, fitted_frame, whole_frame

FloatArray = NDArray[np.float64]

_TILES_PER_ROW = 10
_LAYERS_AT_ONCE = 64
_MOST_WARNINGS = 5


@dataclass(frozen=True)
class Drawn:
    """Shapes in an image.

    Attributes:
        width: In pixels.
        height: In pixels.
        shapes: Those of a coverage have one channel, others four.
        color: Of a coverage: the color of all shapes. None where each shape has its own.
        warnings: What is not in them.
        place: Where the image is; None where that is not known.
    """

    width: int
    height: int
    shapes: list["prefilter.Shape"]
    color: Color | None
    warnings: Sequence[str] = ()
    place: Place | None = None


class Source(Protocol):
    """What was read and can be drawn; it touches no Blender data."""

    @property
    def name(self) -> str:
        """What the image is named after."""

    def drawn(self, settings: RasterizeSettings, progress: Progress) -> Drawn:
        """Returns the shapes in an image.

        Raises:
            ValueError: There are none, or they do not fit the settings.
            OSError: A file cannot be read.
            MemoryError: The image would not fit into memory.
            prefilter.Cancelled: `progress` has said so.
        """


@dataclass(frozen=True)
class _Layer:
    """Contours on a plane that are filled together, as `bridge.outlines` has them."""

    contours: list[FloatArray]
    color: Color


@dataclass(frozen=True)
class _Layers:
    """Layers, from the farthest to the nearest."""

    name: str
    layers: list[_Layer]
    fill_rule: str
    frame: Frame | None
    """Where the plane is in the image; None to fit it."""
    placed: Callable[[Frame], Place | None] = lambda _: None
    """Returns where the image is."""

    def drawn(self, settings: RasterizeSettings, progress: Progress) -> Drawn:
        """Returns the shapes in an image."""
        frame = self.frame
        if frame is None:
            boxes = np.array([box_of(one) for layer in self.layers for one in layer.contours])
            box = np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
            frame = fitted_frame(box, settings)
        check_memory(frame.width, frame.height)
        colors = {layer.color for layer in self.layers}
        if settings.color != "material":
            colors = {WHITE}
        # What is translucent covers itself only where shapes overlap.
        is_coverage = len(colors) <= 1 and all(color[3] == 1.0 for color in colors)
        shapes = []
        for i, layer in enumerate(self.layers):
            if i % _LAYERS_AT_ONCE == 0:
                go_on(progress, i / len(self.layers))
            shape = prefilter.Shape(self.fill_rule)
            shape.color = (1.0,) if is_coverage else _associated(layer.color)
            for contour in layer.contours:
                add_contour(shape, contour @ frame.to_pixels.T)
            shapes.append(shape)
        color = next(iter(colors), WHITE) if is_coverage else None
        return Drawn(frame.width, frame.height, shapes, color, place=self.placed(frame))


@dataclass(frozen=True)
class _Svg:
    """An SVG file."""

    name: str
    path: Path

    def drawn(self, settings: RasterizeSettings, progress: Progress) -> Drawn:
        """Reads the file, and returns its shapes in an image."""
        drawing = prefilter.read_svg(self.path, progress=share(progress, 0.0, 0.5))
        box = np.array([[0.0, 0.0], [drawing.width, drawing.height]])
        frame = fitted_frame(box, settings)
        check_memory(frame.width, frame.height)
        scale = frame.to_pixels[0, 0]
        made = drawing.shapes_for(
            scale * drawing.width, scale * drawing.height, progress=share(progress, 0.5, 1.0)
        )
        move = np.concatenate([np.eye(2), frame.to_pixels[:2, 2:]], axis=1)
        warnings = [str(one) for one in drawing.warnings]
        more = len(warnings) - _MOST_WARNINGS
        if more > 0:
            warnings[_MOST_WARNINGS:] = [f"and {more} more"]
        told = [f"'{self.path.name}': {'; '.join(warnings)}"] if warnings else []
        shapes = [shape.transformed(move) for shape in made]
        half = np.array([frame.width, frame.height]) / 2.0
        half /= scale if settings.resolution == "density" else 2.0 * half.max()
        place = Place(Quaternion(), np.stack([-half, half]))
        return Drawn(frame.width, frame.height, shapes, None, told, place)


def curves_source(
    objects: Sequence[bpy.types.Object],
    settings: RasterizeSettings,
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
) -> tuple[Source, list[str]]:
    """Copies what curves and texts fill.

    Args:
        objects: Curve and text objects; the view may be along the Z axis of the first.
        settings: The view.
        scene: The scene with the camera.
        depsgraph: The evaluated dependency graph.

    Returns:
        What was read, and warnings.

    Raises:
        ValueError: Nothing is filled, or there is no such view.
    """
    view = find_view(settings, objects[0], scene, depsgraph)
    placed = partial(view.place, **_stand(objects[0], depsgraph))
    found = read_curves(objects, depsgraph)
    warnings = _problems(found)
    found.sort(key=lambda curves: view.nearness(curves.center))
    layers: list[_Layer] = []
    behind: dict[str, None] = {}
    for curves in found:
        for fill in curves.fills:
            contours = [view.seen(contour) for contour in fill.contours]
            if any(contour[..., 2].min() <= 0.0 for contour in contours):
                behind[curves.name] = None
            else:
                layers.append(_Layer(contours, fill.color))
    if behind:
        text = "left out, as it reaches behind the camera: {}"
        warnings.append(Sentence(text, listed(behind)))
    if not layers:
        names = listed(obj.name for obj in objects)
        raise ValueError(
            f"object{'s' if len(objects) > 1 else ''} {names}: found no closed splines to fill"
            + (f" ({'; '.join(warnings)})" if warnings else "")
        )
    frame = None
    if view.projection is not None:
        frame = whole_frame(settings.width, settings.height, (-1.0, -1.0), (1.0, 1.0))
    return _Layers(objects[0].name, layers, "evenodd", frame, placed), warnings


def uv_source(
    obj: bpy.types.Object, settings: RasterizeSettings, depsgraph: bpy.types.Depsgraph
) -> tuple[Source, list[str]]:
    """Copies what the faces of a mesh cover in its active UV map.

    Returns:
        What was read, and warnings.

    Raises:
        ValueError: It has no UV map, or its UVs are not finite.
    """
    row, column = divmod(settings.tile - 1001, _TILES_PER_ROW)
    polygons = read_layout(obj, depsgraph)
    warnings: list[str] = []
    if not polygons:
        warnings.append(Sentence("object '{}': no face has an area in the UV map", obj.name))
    contours = []
    for polygon in polygons:
        corners = np.concatenate([polygon, np.ones((len(polygon), 1))], axis=1)
        contours.append(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1))
    low = (float(column), float(row))
    frame = whole_frame(settings.width, settings.height, low, (low[0] + 1.0, low[1] + 1.0))
    return _Layers(f"{obj.name}.uv", [_Layer(contours, WHITE)], "nonzero", frame), warnings


def svg_source(path: str) -> tuple[Source, list[str]]:
    """Returns an SVG file, which is read when it is drawn.

    Raises:
        ValueError: No file is named.
        OSError: There is no such file.
    """
    if not path:
        raise ValueError(Sentence("SVG File: none is named"))
    file = Path(path)
    if not file.is_file():
        raise OSError(f"SVG File: there is no file '{path}'")
    return _Svg(file.stem, file), []


def _stand(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> dict[str, Any]:
    """Returns the origin and the rotation of an object in the world."""
    shown = obj.evaluated_get(depsgraph) if obj.visible_get() else obj
    location, rotation, _ = shown.matrix_world.decompose()
    return {"point": np.array(location, np.float64), "rotation": rotation}


def _problems(found: Sequence[Curves]) -> list[str]:
    warnings: list[str] = []
    open_splines = [curves.name for curves in found if curves.open_splines]
    if open_splines:
        count = sum(curves.open_splines for curves in found)
        splines = counted(range(count), "open spline")
        text = "left out, because Blender fills only closed ones: {} of {}"
        warnings.append(Sentence(text, splines, listed(open_splines)))
    for problem in dict.fromkeys(one for curves in found for one in curves.problems):
        names = listed(curves.name for curves in found if problem in curves.problems)
        warnings.append(f"{problem} of {names} do not show")
    return warnings


def _associated(color: Color) -> Color:
    red, green, blue, alpha = color
    return red * alpha, green * alpha, blue * alpha, alpha
