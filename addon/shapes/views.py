# SPDX-License-Identifier: GPL-3.0-or-later

"""Views of shapes, and the pose of the image plane in the world."""

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
    """A view of the world.

    Attributes:
        matrix: (4, 4), from world space to view space: right, up, toward the viewer.
        projection: (4, 4), from view space to clip space of a camera, whose frame is [-1, 1] x
            [-1, 1]; None for a view along an axis, which has no frame.
    """

    matrix: FloatArray
    projection: FloatArray | None = None

    def project(self, points: FloatArray) -> FloatArray:
        """Projects (..., 4) homogeneous points of the world to (..., 3) points of the plane."""
        projected = points @ self.matrix.T
        if self.projection is not None:
            projected = projected @ self.projection.T
        return projected[..., [0, 1, 3]]

    def pose(self, frame: Frame, point: FloatArray, rotation: Quaternion) -> "PlanePose | None":
        """Returns the pose of an image; None if it is behind the camera.

        Args:
            frame: The position of the view's plane in the image.
            point: (3,) the origin of an object.
            rotation: The rotation of the object in the world.
        """
        origin = self.matrix @ [*point, 1.0]
        in_image = np.array([[0.0, 0.0, 1.0], [frame.width, frame.height, 1.0]])
        corners = in_image @ np.linalg.inv(frame.to_pixels).T
        if self.projection is not None:
            depth = self.projection @ origin
            if depth[3] <= 0.0:
                return None
            clip = np.insert(corners, 2, depth[2] / depth[3], axis=1)
            corners = clip @ np.linalg.inv(self.projection).T
            corners /= corners[:, 3:]
        view_rotation = Matrix(self.matrix.tolist()).to_quaternion().inverted()
        return PlanePose(rotation.inverted() @ view_rotation, corners[:, :2] - origin[:2])

    def nearness(self, point: FloatArray) -> float:
        """Returns a number that increases toward the viewer."""
        return float((self.matrix @ [*point, 1.0])[2])


def find_view(
    settings: RasterizeSettings,
    active: bpy.types.Object,
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
) -> View:
    """Returns the view of the settings.

    Args:
        settings: The settings.
        active: The object for the view along an object's Z axis.
        scene: The scene with the camera.
        depsgraph: The evaluated dependency graph.

    Raises:
        ValueError: There is no camera, or it is panoramic.
    """
    if settings.view in _WORLD:
        return View(_WORLD[settings.view])
    if settings.view == "object":
        evaluated = active.evaluated_get(depsgraph) if active.visible_get() else active
        location, rotation, _ = evaluated.matrix_world.decompose()
        matrix = Matrix.LocRotScale(location, rotation, None)
        return View(np.array(matrix.inverted(), np.float64))
    camera = scene.camera
    if camera is None:
        raise ValueError(Sentence("View: the scene has no camera"))
    if camera.data.type == "PANO":
        raise ValueError(f"View: camera '{camera.name}' is panoramic; another type is needed")
    evaluated = camera.evaluated_get(depsgraph)
    matrix = evaluated.matrix_world.normalized()
    projection = evaluated.calc_matrix_camera(depsgraph, x=settings.width, y=settings.height)
    return View(np.array(matrix.inverted(), np.float64), np.array(projection, np.float64))


@dataclass(frozen=True)
class PlanePose:
    """The pose of an image on a plane through an object's origin, facing the viewer.

    Attributes:
        rotation: The rotation of the plane relative to the object: a quaternion. The axes of the
            plane are those of the image, and the direction toward the viewer.
        box: (2, 2): the low and the high corner of the image on the plane, relative to the origin.
    """

    rotation: Quaternion
    box: FloatArray
