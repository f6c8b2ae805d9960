# SPDX-License-Identifier: GPL-3.0-or-later

"""Objects that get results: their coordinate frames, and checks that they still exist."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ..core.wording import Sentence


@dataclass(frozen=True)
class TargetFrame:
    """Name of the object that gets a result, and the transform from work to object space.

    Work is done in the axes and units of the world, relative to `origin`.

    Attributes:
        name: Name of the object.
        origin: (3,), position of the object in world space.
        to_local: (3, 3), from work space to the object's own space.
    """

    name: str
    origin: NDArray[np.float64]
    to_local: NDArray[np.float64]

    @classmethod
    def of(
        cls, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, name: str = ""
    ) -> "TargetFrame":
        """Returns the frame of an object; `name` names another object that gets the result."""
        frame = cls._at(obj, obj.evaluated_get(depsgraph).matrix_world)
        return replace(frame, name=name) if name else frame

    @classmethod
    def beside(cls, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> "TargetFrame":
        """Returns the frame of a new object at the position of another one, without shear."""
        matrix = obj.evaluated_get(depsgraph).matrix_world
        return cls._at(obj, Matrix.LocRotScale(*matrix.decompose()))

    @classmethod
    def _at(cls, obj: bpy.types.Object, matrix_world: Matrix) -> "TargetFrame":
        matrix = np.array(matrix_world, np.float64)
        linear = matrix[:3, :3]
        lengths = np.linalg.norm(linear, axis=0)
        # Tiny scales are fine, flat ones are not.
        if not np.all(lengths > 0.0) or abs(np.linalg.det(linear / lengths)) < 1e-6:
            raise ValueError(f"object '{obj.name}': its scale is 0 along an axis")
        to_local = np.asarray(np.linalg.inv(linear), np.float64)
        return cls(obj.name, matrix[:3, 3].copy(), to_local)

    @property
    def is_mirrored(self) -> bool:
        """Whether the transform reverses the orientation of triangles."""
        return bool(np.linalg.det(self.to_local) < 0)

    def localize_normals(self, normals: NDArray[np.floating]) -> NDArray[np.float32]:
        """Transforms normals to the object's space."""
        local = normals.astype(np.float64) @ np.linalg.inv(self.to_local)
        lengths = np.linalg.norm(local, axis=1, keepdims=True)
        return np.asarray(local / np.maximum(lengths, 1e-30), np.float32)

    def localize(
        self, positions: NDArray[np.floating], faces: NDArray[np.int32]
    ) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """Transforms triangles or quads to the object's space, and preserves their outside."""
        local = (positions.astype(np.float64) @ self.to_local.T).astype(np.float32)
        return local, self.localize_corners(faces)

    def localize_corners(self, corners: NDArray[np.int32]) -> NDArray[np.int32]:
        """Reorders per-corner values of triangles or quads for the object's space.

        The corners on the diagonal of a quad stay first and third.
        """
        return corners[:, [2, 1, 0, 3][: corners.shape[1]]] if self.is_mirrored else corners


def find_object(name: str) -> bpy.types.Object:
    """Finds an object by name; raises ValueError if it is gone or not in Object Mode."""
    obj = bpy.data.objects.get(name)
    if obj is None:
        raise ValueError(Sentence("object '{}' is gone", name))
    if obj.mode != "OBJECT":
        raise ValueError(Sentence("object '{}' is not in Object Mode any more", name))
    return obj


@contextmanager
def prefix_errors(name: str) -> Iterator[None]:
    """Prefixes the messages of errors with the name of an object."""
    try:
        yield
    except ValueError as error:
        raise ValueError(Sentence("object '{}': {}", name, str(error))) from error
    except MemoryError as error:
        raise MemoryError(Sentence("object '{}': {}", name, str(error))) from error
