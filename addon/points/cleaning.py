# SPDX-License-Identifier: GPL-3.0-or-later

"""Removal of points in three steps: read from Blender, choose points, write to Blender."""

from collections.abc import Callable, Sequence

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray
from prefilter.workflows.points import labeled

from ..bridge.kept_points import check_editable, keep_points, may_lose_points, world_positions
from ..bridge.target_frame import find_object
from ..core.jobs import Progress
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, amount, listed
from .choices import CropSettings, OutlierSettings, SubsampleSettings

Keep = Callable[[NDArray[np.float64], Progress], NDArray[np.bool_]]
"""Returns a mask of the points to keep, from their positions."""


class Cleaning:
    """Removes points of objects; the points of all objects count as one cloud."""

    def __init__(self, objects: Sequence[bpy.types.Object], keep: Keep) -> None:
        """Copies the positions; raises ValueError if there are none, or points are not editable."""
        for obj in objects:
            check_editable(obj)
        self._names = [obj.name for obj in objects]
        self._positions = [world_positions(obj) for obj in objects]
        if not any(map(len, self._positions)):
            text = "object {}: no points" if len(objects) == 1 else "objects {}: no points"
            raise ValueError(Sentence(text, listed(self._names)))
        self._keep = keep
        self._kept: list[NDArray[np.bool_]] = []

    def compute(self, progress: Progress) -> None:
        """Chooses the points.

        Raises:
            ValueError: A setting does not suit the points, or none is left.
            prefilter.Cancelled: `progress` returned False.
        """
        with labeled():
            kept = self._keep(np.concatenate(self._positions), progress)
        if not kept.any():
            raise ValueError(Sentence("no point would be left"))
        self._kept = np.split(kept, np.cumsum(list(map(len, self._positions)))[:-1])

    def write(self) -> Outcome:
        """Removes the other points from the objects.

        Raises:
            ValueError: An object is gone, or its points have changed.
        """
        objects = [find_object(name) for name in self._names]
        for obj, kept in zip(objects, self._kept, strict=True):
            if not may_lose_points(obj) or len(obj.data.attributes["position"].data) != len(kept):
                raise ValueError(Sentence("object '{}' has changed meanwhile", obj.name))
        for obj, kept in zip(objects, self._kept, strict=True):
            if not kept.all():
                keep_points(obj, kept)
        left = sum(int(kept.sum()) for kept in self._kept)
        points = sum(len(kept) for kept in self._kept)
        return Outcome(
            Sentence("Kept {} of {}", f"{left}", amount(points, "point")), objects=self._names
        )

    def discard(self) -> None:
        """Releases the copied positions."""
        self._positions.clear()


def subsampling(objects: Sequence[bpy.types.Object], settings: SubsampleSettings) -> Cleaning:
    """Prepares subsampling the points of objects."""
    check(settings)

    def keep(positions: NDArray[np.float64], progress: Progress) -> NDArray[np.bool_]:
        kept = np.zeros(len(positions), bool)
        kept[
            prefilter.subsample_points(
                positions, settings.spacing, method=settings.method, progress=progress
            )
        ] = True
        return kept

    return Cleaning(objects, keep)


def without_outliers(objects: Sequence[bpy.types.Object], settings: OutlierSettings) -> Cleaning:
    """Prepares removing the outliers of objects."""
    check(settings)

    def keep(positions: NDArray[np.float64], progress: Progress) -> NDArray[np.bool_]:
        return ~prefilter.find_outliers(
            positions,
            neighbours=settings.neighbors,
            factor=settings.factor,
            progress=progress,
        )

    return Cleaning(objects, keep)


def cropping(
    objects: Sequence[bpy.types.Object], box: bpy.types.Object, settings: CropSettings
) -> Cleaning:
    """Prepares cropping the points of objects to the oriented bounding box of another object.

    Raises:
        ValueError: The box is flat.
    """
    check(settings)
    corners = np.array([corner[:] for corner in box.bound_box])
    low, high = corners.min(axis=0), corners.max(axis=0)
    matrix = np.array(box.matrix_world, np.float64)
    if not (high > low).all() or abs(np.linalg.det(matrix[:3, :3])) == 0.0:
        raise ValueError(Sentence("object '{}' has no volume to crop to", box.name))
    to_box = np.linalg.inv(matrix)
    is_inside = settings.keep == "inside"

    def keep(positions: NDArray[np.float64], progress: Progress) -> NDArray[np.bool_]:
        del progress
        with np.errstate(invalid="ignore"):
            local = positions @ to_box[:3, :3].T + to_box[:3, 3]
        inside = (local >= low).all(axis=1) & (local <= high).all(axis=1)
        return np.asarray(inside == is_inside)

    return Cleaning(objects, keep)
