# SPDX-License-Identifier: GPL-3.0-or-later

"""Recipes of results, stored with them: settings and operands, for updates."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ..bridge import attributes, kept_sources
from ..core.options import declared
from ..core.wording import Sentence
from .choices import BooleanSettings, VoxelizeSettings, VoxelSettings


@dataclass(frozen=True)
class Recipe:
    """How to make a result again.

    Attributes:
        result: The object that gets the result.
        source: The original object.
        operands: The objects to combine it with, for a boolean.
        settings: The settings.
        warnings: Warnings about operands that are gone.
    """

    result: bpy.types.Object
    source: bpy.types.Object
    operands: list[bpy.types.Object]
    settings: VoxelizeSettings | BooleanSettings
    warnings: list[str]


def remember(
    made: bpy.types.Object,
    settings: VoxelSettings,
    operands: Sequence[bpy.types.Object],
    cell: float,
) -> None:
    """Stores an object's recipe with it.

    Args:
        made: The object.
        settings: The settings it was made with.
        operands: The objects it was combined with.
        cell: The side of a cell in its own space.
    """
    kept = made.prefilter_voxels
    for name, _, option in declared(type(settings)):
        if option.label and name in kept.bl_rna.properties and name != "operands":
            setattr(kept, name, getattr(settings, name))
    kept.operands.clear()
    for obj in operands:
        kept.operands.add().obj = obj
        obj.prefilter_voxels.is_operand = True
    kept.is_boolean = isinstance(settings, BooleanSettings)
    kept.cell = cell
    kept.is_made = True
    remember_mesh(made)


def remember_mesh(made: bpy.types.Object) -> None:
    """Stores a checksum of an object's mesh with it."""
    made.prefilter_voxels.mesh = _checksum(made.data)


def is_changed(made: bpy.types.Object) -> bool:
    """Whether the mesh of an object has changed since it was made."""
    return bool(made.prefilter_voxels.mesh != _checksum(made.data))


def _checksum(mesh: bpy.types.Mesh) -> str:
    return f"{len(mesh.vertices)}:{zlib.crc32(attributes.positions(mesh).tobytes())}"


def cell_of(obj: bpy.types.Object | None) -> float:
    """Side, in world space, of the cells that an object was made with; 0 without a recipe."""
    if obj is None:
        return 0.0
    matrix: NDArray[np.float64] = np.array(obj.matrix_world, np.float64)[:3, :3]
    return float(obj.prefilter_voxels.cell * abs(np.linalg.det(matrix)) ** (1.0 / 3.0))


def with_same_cells(obj: bpy.types.Object | None, settings: BooleanSettings) -> BooleanSettings:
    """Changes the resolution to the cells that an object was made with, if it has any.

    If there would be too many cells, the boolean falls back to the depth.
    """
    cell = cell_of(obj)
    if not (cell > 0.0 and settings.use_keep_resolution):
        return replace(settings, use_keep_resolution=False)
    return replace(settings, resolution="size", voxel_size=cell)


def updatable_result(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Finds the result to update for an object: itself, or the result whose source it is.

    For an operand that is the last result made with it.
    """
    if obj is None:
        return None
    result = kept_sources.result_of(obj)
    if result is not None and result.prefilter_voxels.is_made and kept_sources.original_of(result):
        return result
    users = [
        outermost
        for other in (bpy.data.objects if obj.prefilter_voxels.is_operand else ())
        if any(entry.obj == obj for entry in other.prefilter_voxels.operands)
        and kept_sources.original_of(other) is not None
        and (outermost := _outermost(other)) is not None
    ]
    return max(users, key=lambda other: other.session_uid, default=None)


def chain(result: bpy.types.Object) -> list[bpy.types.Object]:
    """Returns a result, and before it the results that it was made of, latest first.

    The chain ends before a result that was edited manually since it was made.
    """
    results = [result]
    while True:
        source = kept_sources.original_of(results[-1])
        is_made = source is not None and source.prefilter_voxels.is_made
        if not is_made or kept_sources.original_of(source) is None or is_changed(source):
            return results
        results.append(source)


def _outermost(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Last result made of a copied source, or the object itself if it is no copy."""
    while obj is not None and obj.prefilter_made_of.is_copy:
        users = (other for other in bpy.data.objects if kept_sources.original_of(other) == obj)
        obj = next(users, None)
    return obj if obj is not None and obj.prefilter_voxels.is_made else None


def recall(result: bpy.types.Object) -> Recipe:
    """Returns the recipe of an object.

    Raises:
        ValueError: Its source or all operands are gone.
    """
    kept, source = result.prefilter_voxels, kept_sources.original_of(result)
    if source is None:
        raise ValueError(Sentence("object '{}': its source is gone", result.name))
    settings = kept.to_settings()
    if not isinstance(settings, BooleanSettings):
        return Recipe(result, source, [], settings, [])
    stored = [entry.obj for entry in kept.operands]
    operands = [obj for obj in stored if obj is not None and obj.users_collection]
    if not operands:
        text = "object '{}': the objects that it was combined with are gone"
        raise ValueError(Sentence(text, result.name))
    gone = len(stored) - len(operands)
    warnings: list[str] = []
    if gone:
        text = "{} objects that it was combined with are gone"
        if gone == 1:
            text = "1 object that it was combined with is gone"
        warnings.append(Sentence(text, gone))
    return Recipe(result, source, operands, settings, warnings)
