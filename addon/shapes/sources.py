# SPDX-License-Identifier: GPL-3.0-or-later

"""The sources of rasterized images: curves and texts, a UV map, an SVG file."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import bpy
import numpy as np
from mathutils import Quaternion
from numpy.typing import NDArray
from prefilter.workflows.shapes.frames import whole_frame
from prefilter.workflows.shapes.layers import Layer, Layers, Source, svg_drawing, uv_layers

from ..bridge.curves import Curves, read_curves
from ..bridge.uv_layouts import read_layout
from ..core.memory import usable_memory
from ..core.wording import Sentence, counted, listed
from .choices import RasterizeSettings
from .views import PlanePose, find_view

FloatArray = NDArray[np.float64]


def curves_source(
    objects: Sequence[bpy.types.Object],
    settings: RasterizeSettings,
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
) -> tuple[Source, list[str]]:
    """Copies the filled areas of curves and texts.

    Args:
        objects: Curve and text objects; the view may be along the Z axis of the first.
        settings: The settings with the view.
        scene: The scene with the camera.
        depsgraph: The evaluated dependency graph.

    Returns:
        The source, and warnings.

    Raises:
        ValueError: Nothing is filled, or the view does not exist.
    """
    view = find_view(settings, objects[0], scene, depsgraph)
    pose = partial(view.pose, **_origin_and_rotation(objects[0], depsgraph))
    all_curves = read_curves(objects, depsgraph)
    warnings = _problems(all_curves)
    all_curves.sort(key=lambda curves: view.nearness(curves.center))
    layers: list[Layer] = []
    behind: dict[str, None] = {}
    for curves in all_curves:
        for fill in curves.fills:
            contours = [view.project(contour) for contour in fill.contours]
            if any(contour[..., 2].min() <= 0.0 for contour in contours):
                behind[curves.name] = None
            else:
                layers.append(Layer(contours, fill.color, fill.fill_rule))
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
    return Layers(objects[0].name, layers, frame, usable_memory, pose), warnings


def uv_source(
    obj: bpy.types.Object, settings: RasterizeSettings, depsgraph: bpy.types.Depsgraph
) -> tuple[Source, list[str]]:
    """Copies the area that the faces of a mesh cover in its active UV map.

    Returns:
        The source, and warnings.

    Raises:
        ValueError: It has no UV map, or its UVs are not finite.
    """
    polygons = read_layout(obj, depsgraph)
    warnings: list[str] = []
    if not polygons:
        warnings.append(Sentence("object '{}': no face has an area in the UV map", obj.name))
    return uv_layers(f"{obj.name}.uv", polygons, settings, usable_memory), warnings


def svg_source(path: str) -> tuple[Source, list[str]]:
    """Returns an SVG file as a source, which is read when it is drawn.

    Raises:
        ValueError: No file is given.
        OSError: The file does not exist.
    """
    if not path:
        raise ValueError(Sentence("SVG File: none is named"))
    return svg_drawing("SVG File", path, usable_memory, _svg_pose), []


def _svg_pose(half: FloatArray) -> PlanePose:
    return PlanePose(Quaternion(), np.stack([-half, half]))


def _origin_and_rotation(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> dict[str, Any]:
    """Returns the world-space origin and rotation of an object, as arguments of `View.pose`."""
    evaluated = obj.evaluated_get(depsgraph) if obj.visible_get() else obj
    location, rotation, _ = evaluated.matrix_world.decompose()
    return {"point": np.array(location, np.float64), "rotation": rotation}


def _problems(all_curves: Sequence[Curves]) -> list[str]:
    warnings: list[str] = []
    open_splines = [curves.name for curves in all_curves if curves.open_splines]
    if open_splines:
        count = sum(curves.open_splines for curves in all_curves)
        splines = counted(range(count), "open spline")
        text = "left out, because Blender fills only closed ones: {} of {}"
        warnings.append(Sentence(text, splines, listed(open_splines)))
    for problem in dict.fromkeys(text for curves in all_curves for text in curves.problems):
        names = listed(curves.name for curves in all_curves if problem in curves.problems)
        warnings.append(f"{problem} of {names} do not show")
    return warnings
