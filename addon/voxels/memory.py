# SPDX-License-Identifier: GPL-3.0-or-later

"""How an object was made, which it remembers, so that it can be made again in place."""

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
class Request:
    """What to make again.

    Attributes:
        result: The object that gets it.
        source: What it was.
        operands: With what it is combined, if the settings are those of a boolean.
        settings: How.
        warnings: What is gone.
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
    """Keeps with an object how it was made.

    Args:
        made: The object.
        settings: How.
        operands: With what it was combined.
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
    """Keeps with an object which mesh was made."""
    made.prefilter_voxels.mesh = _checksum(made.data)


def is_changed(made: bpy.types.Object) -> bool:
    """Tells whether the mesh of an object has changed since that was made."""
    return bool(made.prefilter_voxels.mesh != _checksum(made.data))


def _checksum(mesh: bpy.types.Mesh) -> str:
    return f"{len(mesh.vertices)}:{zlib.crc32(attributes.positions(mesh).tobytes())}"


def cell_of(obj: bpy.types.Object | None) -> float:
    """Returns the side of the cells, in the world, that an object was made in; 0 if in none."""
    if obj is None:
        return 0.0
    matrix: NDArray[np.float64] = np.array(obj.matrix_world, np.float64)[:3, :3]
    return float(obj.prefilter_voxels.cell * abs(np.linalg.det(matrix)) ** (1.0 / 3.0))


def as_before(obj: bpy.types.Object | None, settings: BooleanSettings) -> BooleanSettings:
    """Returns settings with cells as large as those that an object was made in, if in any.

    Where there would be too many, the other resolution counts.
    """
    cell = cell_of(obj)
    if not (cell > 0.0 and settings.use_keep_resolution):
        return replace(settings, use_keep_resolution=False)
    return replace(settings, resolution="size", voxel_size=cell)


def made_of(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Returns the object that can be made again of an object: itself, or what is shown as it.

    Of an operand that is the object that was made last with it.
    """
    if obj is None:
        return None
    found = kept_sources.result_of(obj)
    if found is not None and found.prefilter_voxels.is_made and kept_sources.original_of(found):
        return found
    users = [
        outermost
        for other in (bpy.data.objects if obj.prefilter_voxels.is_operand else ())
        if any(one.obj == obj for one in other.prefilter_voxels.operands)
        and kept_sources.original_of(other) is not None
        and (outermost := _outermost(other)) is not None
    ]
    return max(users, key=lambda other: other.session_uid, default=None)


def chain(result: bpy.types.Object) -> list[bpy.types.Object]:
    """Returns an object that was made, and those before it that it was made of likewise.

    What was changed by hand since it was made is not made again, and nothing before it.
    """
    found = [result]
    while True:
        source = kept_sources.original_of(found[-1])
        is_made = source is not None and source.prefilter_voxels.is_made
        if not is_made or kept_sources.original_of(source) is None or is_changed(source):
            return found
        found.append(source)


def _outermost(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Returns the object that was made last of a copy; an object that is no copy is its own."""
    while obj is not None and obj.prefilter_made_of.is_copy:
        users = (other for other in bpy.data.objects if kept_sources.original_of(other) == obj)
        obj = next(users, None)
    return obj if obj is not None and obj.prefilter_voxels.is_made else None


def recall(result: bpy.types.Object) -> Request:
    """Returns how to make an object again.

    Raises:
        ValueError: What it was made of is gone.
    """
    kept, source = result.prefilter_voxels, kept_sources.original_of(result)
    if source is None:
        raise ValueError(Sentence("object '{}': what it was made of is gone", result.name))
    settings = kept.to_settings()
    if not isinstance(settings, BooleanSettings):
        return Request(result, source, [], settings, [])
    there = [one.obj for one in kept.operands]
    operands = [obj for obj in there if obj is not None and obj.users_collection]
    if not operands:
        text = "object '{}': the objects that it was combined with are gone"
        raise ValueError(Sentence(text, result.name))
    gone = len(there) - len(operands)
    warnings: list[str] = []
    if gone:
        text = "{} objects that it was combined with are gone"
        if gone == 1:
            text = "1 object that it was combined with is gone"
        warnings.append(Sentence(text, gone))
    return Request(result, source, operands, settings, warnings)
