# SPDX-License-Identifier: GPL-3.0-or-later

"""Textures painted from the colors of scans, in three steps: read, compute, write."""

import math
from collections.abc import Sequence

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge import attributes
from ..bridge.image_materials import show_on
from ..bridge.new_images import new_packed, suffixed
from ..bridge.points import Points, read_points
from ..bridge.target_frame import find_object
from ..core.jobs import Progress
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, amount, listed
from .choices import PaintSettings

_ENDING = "colors"
# Texels between charts, so that lookups in the first levels see only one chart.
_MARGIN = 4.0
# With Blender's default of 66 degrees, charts of thin rims, as of Suzanne's ears, overlap.
_SMART_UV_ANGLE = math.radians(50)


class Painting:
    """Paints a texture of a mesh from the colors of points."""

    def __init__(
        self,
        obj: bpy.types.Object,
        scans: Sequence[bpy.types.Object],
        settings: PaintSettings,
        depsgraph: bpy.types.Depsgraph,
    ) -> None:
        """Copies the mesh and the points; unwraps a mesh that has no UV map.

        Raises:
            ValueError: The mesh has no faces, or no point has a color.
        """
        check(settings)
        self._settings = settings
        self._name = obj.name
        origin: NDArray[np.float64] = np.array(obj.matrix_world.translation)
        parts = read_points(scans, depsgraph, origin)
        self._points = np.concatenate([part.positions for part in parts])
        self._colors = np.concatenate([_colors(part) for part in parts])
        if not obj.data.uv_layers:
            unwrap(obj, _MARGIN / settings.size)
        self._surface = _surface(obj, origin)
        self._image: NDArray[np.float32] | None = None

    def compute(self, progress: Progress) -> None:
        """Fits the texture.

        Raises:
            prefilter.Cancelled: `progress` returned False.
        """
        size = self._settings.size
        self._image = prefilter.paint_texture(
            self._surface,
            self._points,
            self._colors,
            size,
            size,
            smoothing=self._settings.smoothing,
            progress=progress,
        )

    def write(self) -> Outcome:
        """Makes the image, and a material of the mesh that shows it.

        Raises:
            ValueError: The mesh is gone.
        """
        assert self._image is not None
        obj = find_object(self._name)
        image = new_packed(suffixed(obj.name, _ENDING), None, self._image)
        obj.data.materials.clear()
        obj.data.materials.append(show_on(obj, image))
        points = amount(len(self._points), "point")
        return Outcome(
            Sentence("Made '{}' from the colors of {}", image.name, points), objects=[obj.name]
        )

    def discard(self) -> None:
        """Releases the image."""
        self._image = None


def unwrap(obj: bpy.types.Object, margin: float) -> None:
    """Gives a mesh a UV map by Blender's Smart UV Project; restores the selection.

    `margin` is the distance between charts, as a fraction of the image.
    """
    view_layer = bpy.context.view_layer
    active, selected = view_layer.objects.active, list(bpy.context.selected_objects)
    for other in selected:
        other.select_set(other == obj)
    view_layer.objects.active = obj
    obj.select_set(True)
    try:
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.smart_project(
            angle_limit=_SMART_UV_ANGLE, island_margin=margin, margin_method="FRACTION"
        )
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
        for other in selected:
            other.select_set(True)
        view_layer.objects.active = active


def _colors(points: Points) -> NDArray[np.float32]:
    """Active colors of points, as sRGB values."""
    colors = points.attributes.get(points.active_color)
    if colors is None:
        raise ValueError(Sentence("object {}: its points have no colors", listed([points.name])))
    return prefilter.to_srgb(np.clip(colors.values[:, :3], 0.0, 1.0))


def _surface(obj: bpy.types.Object, origin: NDArray[np.float64]) -> "prefilter.Surface":
    mesh: bpy.types.Mesh = obj.data
    corners, _ = attributes.corner_triangles(mesh)
    layer = next(each for each in mesh.uv_layers if each.active_render)
    uvs = np.empty((len(layer.uv), 2), np.float32)
    layer.uv.foreach_get("vector", uvs.ravel())
    matrix = np.array(obj.matrix_world)
    placed = attributes.positions(mesh) @ matrix[:3, :3].T + (matrix[:3, 3] - origin)
    return prefilter.Surface(placed, attributes.corner_vertices(mesh)[corners], uvs[corners])
