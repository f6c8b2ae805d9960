# SPDX-License-Identifier: GPL-3.0-or-later

"""From where shapes are seen, and where they are in the image."""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Quaternion
from numpy.typing import NDArray
from prefilter.workflows.shapes.frames import Frame

from ..core.wording import Sentence
from .choices import RasterizeSettings

FloatArray = NDArray[np.float64]

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

    def place(self, frame: Frame, point: FloatArray, rotation: Quaternion) -> "Place | None":
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
