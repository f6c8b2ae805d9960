# SPDX-License-Identifier: GPL-3.0-or-later

"""Scans moved onto each other, in three steps: read from Blender, compute, write to Blender."""

from collections.abc import Sequence
from typing import Any, cast

import bpy
import numpy as np
import prefilter
from mathutils import Matrix
from numpy.typing import NDArray

from ..bridge.place import still_there
from ..bridge.points import Points, read_points
from ..bridge.units import length
from ..core.jobs import Progress
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, counted, listed
from .choices import AlignSettings


class Alignment:
    """Objects with points, all but the first of which move onto the others."""

    def __init__(
        self,
        objects: Sequence[bpy.types.Object],
        settings: AlignSettings,
        depsgraph: bpy.types.Depsgraph,
    ) -> None:
        """Copies the points of objects; raises ValueError where one has none."""
        check(settings)
        if len(objects) < 2:
            raise ValueError(Sentence("one object is selected that has points; two are needed"))
        self._settings = settings
        self._origin: NDArray[np.float64] = np.array(objects[0].matrix_world.translation)
        self._names = [obj.name for obj in objects]
        read = read_points(objects, depsgraph, self._origin)
        self._scans = [_scan(name, read) for name in self._names]
        self._found: prefilter.ScanAlignment | None = None

    def compute(self, progress: Progress) -> None:
        """Finds the motions.

        Raises:
            prefilter.Cancelled: `progress` has said so.
        """
        self._found = prefilter.align_scans(
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
        assert self._found is not None
        objects = [still_there(name) for name in self._names]
        there, back = Matrix.Translation(self._origin), Matrix.Translation(-self._origin)
        for obj, matrix in zip(objects[1:], self._found.matrices[1:], strict=True):
            obj.matrix_world = there @ Matrix(matrix.tolist()) @ back @ obj.matrix_world
        apart = [
            name for name, pairs in zip(self._names, self._found.pairs, strict=True) if pairs == 0
        ]
        warnings: list[str] = []
        if apart:
            text = "not near any other scan, or of another shape, and not moved: {}"
            warnings.append(Sentence(text, listed(apart)))
        before, after = length(self._found.before), length(self._found.after)
        return Outcome(
            Sentence(
                "Aligned {}: typically {} apart, before {}", counted(objects, "scan"), after, before
            ),
            objects=self._names,
            warnings=warnings,
        )

    def discard(self) -> None:
        """Lets go of what was read."""
        self._scans.clear()


def _scan(name: str, read: Sequence[Points]) -> "prefilter.ScanPoints":
    """Returns the points of an object, which may have several parts."""
    own = [one for one in read if one.name == name]
    if not own:
        raise ValueError(Sentence("object {}: no points", listed([name])))
    normals = [one.normals for one in own if one.normals is not None]
    return prefilter.ScanPoints(
        np.concatenate([one.positions for one in own]),
        np.concatenate(normals) if len(normals) == len(own) else None,
    )
