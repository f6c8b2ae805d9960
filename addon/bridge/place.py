# SPDX-License-Identifier: GPL-3.0-or-later

"""The objects that get the results: where they are, and whether they are still there."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ..core.wording import Sentence


@dataclass(frozen=True)
class Place:
    """Where the results of an object go: its name, and the way from its frame to its own space."""

    name: str
    origin: NDArray[np.float64]
    to_local: NDArray[np.float64]

    @classmethod
    def of(cls, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, name: str = "") -> "Place":
        """Returns the place of an object itself, or of a named one that stands for it."""
        found = cls._at(obj, obj.evaluated_get(depsgraph).matrix_world)
        return replace(found, name=name) if name else found

    @classmethod
    def beside(cls, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> "Place":
        """Returns the place of a new object where another one is; it has no shear."""
        matrix = obj.evaluated_get(depsgraph).matrix_world
        return cls._at(obj, Matrix.LocRotScale(*matrix.decompose()))

    @classmethod
    def _at(cls, obj: bpy.types.Object, placed: Matrix) -> "Place":
        matrix = np.array(placed, np.float64)
        linear = matrix[:3, :3]
        lengths = np.linalg.norm(linear, axis=0)
        # A matrix of tiny numbers is fine, one that is flat is not.
        if not np.all(lengths > 0.0) or abs(np.linalg.det(linear / lengths)) < 1e-6:
            raise ValueError(f"object '{obj.name}': its scale is 0 along an axis")
        to_local = np.asarray(np.linalg.inv(linear), np.float64)
        return cls(obj.name, matrix[:3, 3].copy(), to_local)

    @property
    def is_mirrored(self) -> bool:
        """Whether triangles go the other way around in the object's space."""
        return bool(np.linalg.det(self.to_local) < 0)

    def localize_normals(self, normals: NDArray[np.floating]) -> NDArray[np.float32]:
        """Returns normals in the object's space."""
        local = normals.astype(np.float64) @ np.linalg.inv(self.to_local)
        lengths = np.linalg.norm(local, axis=1, keepdims=True)
        return np.asarray(local / np.maximum(lengths, 1e-30), np.float32)

    def localize(
        self, positions: NDArray[np.floating], faces: NDArray[np.int32]
    ) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """Returns triangles or quads in the object's space, right side out there too."""
        local = (positions.astype(np.float64) @ self.to_local.T).astype(np.float32)
        return local, self.localize_corners(faces)

    def localize_corners(self, corners: NDArray[np.int32]) -> NDArray[np.int32]:
        """Returns what corners of triangles or quads have, in their order in the object's space.

        Those that the diagonal of a quad is between stay first and third.
        """
        return corners[:, [2, 1, 0, 3][: corners.shape[1]]] if self.is_mirrored else corners


def still_there(name: str) -> bpy.types.Object:
    """Returns the object of a name; raises ValueError where it is gone or in another mode."""
    obj = bpy.data.objects.get(name)
    if obj is None:
        raise ValueError(Sentence("object '{}' is gone", name))
    if obj.mode != "OBJECT":
        raise ValueError(Sentence("object '{}' is not in Object Mode any more", name))
    return obj


@contextmanager
def naming(name: str) -> Iterator[None]:
    """Puts the name of an object before messages."""
    try:
        yield
    except ValueError as error:
        raise ValueError(Sentence("object '{}': {}", name, str(error))) from error
    except MemoryError as error:
        raise MemoryError(Sentence("object '{}': {}", name, str(error))) from error
