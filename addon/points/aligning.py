# SPDX-License-Identifier: GPL-3.0-or-later

"""Alignment of scans in three steps: read from Blender, compute, write to Blender."""

from collections.abc import Sequence
from typing import Any, cast

import bpy
import numpy as np
import prefilter
from mathutils import Matrix
from numpy.typing import NDArray

from ..bridge.points import Points, read_points
from ..bridge.target_frame import find_object
from ..bridge.units import length
from ..core.jobs import Progress
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, counted, listed
from .choices import AlignSettings


class Alignment:
    """Aligns objects with points; all but the first move."""

    def __init__(
        self,
        objects: Sequence[bpy.types.Object],
        settings: AlignSettings,
        depsgraph: bpy.types.Depsgraph,
    ) -> None:
        """Copies the points of objects; raises ValueError if one has none."""
        check(settings)
        if len(objects) < 2:
            raise ValueError(Sentence("one object is selected that has points; two are needed"))
        self._settings = settings
        self._origin: NDArray[np.float64] = np.array(objects[0].matrix_world.translation)
        self._names = [obj.name for obj in objects]
        parts = read_points(objects, depsgraph, self._origin)
        self._scans = [_scan(name, parts) for name in self._names]
        self._alignment: prefilter.ScanAlignment | None = None

    def compute(self, progress: Progress) -> None:
        """Finds the motions.

        Raises:
            prefilter.Cancelled: `progress` returned False.
        """
        self._alignment = prefilter.align_scans(
            self._scans,
            against=cast("Any", self._settings.against),
            reach=self._settings.reach or None,
            progress=progress,
        )

    def write(self) -> Outcome:
        """Moves the objects.

        Raises:
            ValueError: An object is gone.
        """
        assert self._alignment is not None
        objects = [find_object(name) for name in self._names]
        to_world, from_world = Matrix.Translation(self._origin), Matrix.Translation(-self._origin)
        for obj, matrix in zip(objects[1:], self._alignment.matrices[1:], strict=True):
            obj.matrix_world = to_world @ Matrix(matrix.tolist()) @ from_world @ obj.matrix_world
        pairs = zip(self._names, self._alignment.pairs, strict=True)
        apart = [name for name, count in pairs if count == 0]
        warnings: list[str] = []
        if apart:
            text = "not near any other scan, or of another shape, and not moved: {}"
            warnings.append(Sentence(text, listed(apart)))
        before, after = length(self._alignment.before), length(self._alignment.after)
        return Outcome(
            Sentence(
                "Aligned {}: typically {} apart, before {}", counted(objects, "scan"), after, before
            ),
            objects=self._names,
            warnings=warnings,
        )

    def discard(self) -> None:
        """Releases the copied points."""
        self._scans.clear()


def _scan(name: str, parts: Sequence[Points]) -> "prefilter.ScanPoints":
    """Joins the points of an object, which may have several parts."""
    own = [part for part in parts if part.name == name]
    if not own:
        raise ValueError(Sentence("object {}: no points", listed([name])))
    normals = [part.normals for part in own if part.normals is not None]
    return prefilter.ScanPoints(
        np.concatenate([part.positions for part in own]),
        np.concatenate(normals) if len(normals) == len(own) else None,
    )
