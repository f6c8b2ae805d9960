# SPDX-License-Identifier: GPL-3.0-or-later

"""From where shapes are seen, and where they are in the image."""

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Quaternion
from numpy.typing import NDArray

from ..core.memory import usable_memory
from ..core.wording import Sentence
from .choices import LARGEST_SIDE, RasterizeSettings

FloatArray = NDArray[np.float64]

_BYTES_PER_PIXEL = 40.0
"""What an image takes while it is made: its values as floats, a copy, and its bytes."""
_FRONT = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)
_RIGHT = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1]], np.float64)
_WORLD = {"top": np.eye(4), "front": _FRONT, "right": _RIGHT}


@dataclass(frozen=True)
class View:
    """How a point of the world is seen.

    Attributes:
        matrix: (4, 4), from world space to the view: right, up, toward the viewer.
        projection: (4, 4), from there to a camera's frame, which is [-1, 1] x [-1, 1] wherever the
            last number is 1; None for a view along an axis, which has no frame.
    """

    matrix: FloatArray
    projection: FloatArray | None = None

    def seen(self, points: FloatArray) -> FloatArray:
        """Returns (..., 3) homogeneous points of the plane, of (..., 4) ones of the world."""
        found = points @ self.matrix.T
        if self.projection is not None:
            found = found @ self.projection.T
        return found[..., [0, 1, 3]]

    def place(self, frame: "Frame", point: FloatArray, rotation: Quaternion) -> "Place | None":
        """Returns where an image is; None if that is behind the camera.

        Args:
            frame: Where the plane of the view is in the image.
            point: (3,) the origin of an object.
            rotation: Its rotation in the world.
        """
        seen = self.matrix @ [*point, 1.0]
        in_image = np.array([[0.0, 0.0, 1.0], [frame.width, frame.height, 1.0]])
        corners = in_image @ np.linalg.inv(frame.to_pixels).T
        if self.projection is not None:
            depth = self.projection @ seen
            if depth[3] <= 0.0:
                return None
            clip = np.insert(corners, 2, depth[2] / depth[3], axis=1)
            corners = clip @ np.linalg.inv(self.projection).T
            corners /= corners[:, 3:]
        of_view = Matrix(self.matrix.tolist()).to_quaternion().inverted()
        return Place(rotation.inverted() @ of_view, corners[:, :2] - seen[:2])

    def nearness(self, point: FloatArray) -> float:
        """Returns a number that is greater for points that are nearer to the viewer."""
        return float((self.matrix @ [*point, 1.0])[2])


def find_view(
    settings: RasterizeSettings,
    active: bpy.types.Object,
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
) -> View:
    """Returns the view that the settings name.

    Args:
        settings: The settings.
        active: The object whose Z axis is meant.
        scene: The scene with the camera.
        depsgraph: The evaluated dependency graph.

    Raises:
        ValueError: There is no camera, or it has no frame of a plane.
    """
    if settings.view in _WORLD:
        return View(_WORLD[settings.view])
    if settings.view == "object":
        shown = active.evaluated_get(depsgraph) if active.visible_get() else active
        location, rotation, _ = shown.matrix_world.decompose()
        placed = Matrix.LocRotScale(location, rotation, None)
        return View(np.array(placed.inverted(), np.float64))
    camera = scene.camera
    if camera is None:
        raise ValueError(Sentence("View: the scene has no camera"))
    if camera.data.type == "PANO":
        raise ValueError(f"View: camera '{camera.name}' is panoramic; another type is needed")
    shown = camera.evaluated_get(depsgraph)
    placed = shown.matrix_world.normalized()
    projection = shown.calc_matrix_camera(depsgraph, x=settings.width, y=settings.height)
    return View(np.array(placed.inverted(), np.float64), np.array(projection, np.float64))


@dataclass(frozen=True)
class Place:
    """Where an image is: on a plane through the origin of an object, as the image was seen.

    Attributes:
        rotation: The quaternion from the plane, whose axes are those of the image and toward the
            viewer, to the object's rotation.
        box: (2, 2): the low and the high corner of the image, on the plane, from that origin.
    """

    rotation: Quaternion
    box: FloatArray


@dataclass(frozen=True)
class Frame:
    """Where a plane is in an image.

    Attributes:
        width: In pixels.
        height: In pixels.
        to_pixels: (3, 3), from homogeneous points of the plane to those of the image.
    """

    width: int
    height: int
    to_pixels: FloatArray


def whole_frame(width: int, height: int, low: Sequence[float], high: Sequence[float]) -> Frame:
    """Returns the frame in which a box is stretched over an image."""
    scale = [width / (high[0] - low[0]), height / (high[1] - low[1])]
    return _frame(width, height, scale, [-low[0] * scale[0], -low[1] * scale[1]])


def fitted_frame(box: FloatArray, settings: RasterizeSettings) -> Frame:
    """Returns the frame in which a box is in the middle of an image, with the margin around it.

    Args:
        box: (2, 2): the low and the high corner.
        settings: The resolution and the margin.

    Raises:
        ValueError: The box has no size, the margin leaves no room, or the image would be too large.
    """
    size = box[1] - box[0]
    if not np.all(size > 0.0):
        raise ValueError(Sentence("the shapes have no area, as seen from there"))
    if settings.resolution == "density":
        scale = settings.density
        sides = np.ceil(size * scale + 2.0 * settings.margin - 1e-6)
        if np.any(sides > LARGEST_SIDE):
            raise ValueError(
                f"Pixels per Unit: {scale:g} would make an image of {sides[0]:.0f} x "
                f"{sides[1]:.0f} pixels; the limit is {LARGEST_SIDE}"
            )
        width, height = (max(1, int(side)) for side in sides)
    elif settings.resolution == "side":
        inside = settings.side - 2.0 * settings.margin
        if inside <= 0.0:
            raise ValueError(
                f"Margin: {settings.margin:g} leaves no room in {settings.side} pixels"
            )
        scale = inside / float(np.max(size))
        sides = np.ceil(size * scale + 2.0 * settings.margin - 1e-6)
        width, height = (max(1, int(side)) for side in sides)
    else:
        width, height = settings.width, settings.height
        room = np.array([width, height]) - 2.0 * settings.margin
        if np.any(room <= 0.0):
            raise ValueError(
                f"Margin: {settings.margin:g} leaves no room in {width} x {height} pixels"
            )
        scale = float(np.min(room / size))
    shift = np.array([width, height]) / 2.0 - scale * (box[0] + box[1]) / 2.0
    return _frame(width, height, [scale, scale], shift)


def _frame(width: int, height: int, scale: Sequence[float], shift: Sequence[float]) -> Frame:
    matrix = np.array([[scale[0], 0.0, shift[0]], [0.0, scale[1], shift[1]], [0.0, 0.0, 1.0]])
    return Frame(width, height, matrix)


def check_memory(width: int, height: int) -> None:
    """Raises MemoryError where an image of that size cannot be made."""
    needed = _BYTES_PER_PIXEL * width * height
    free, why = usable_memory()
    if needed > free:
        raise MemoryError(
            f"an image of {width} x {height} pixels needs about {needed / 1e9:.1f} GB of memory; "
            f"{why}: make it smaller"
        )
