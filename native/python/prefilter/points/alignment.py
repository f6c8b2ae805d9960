# SPDX-License-Identifier: GPL-3.0-or-later

"""Scans moved onto a surface of all of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_progress, progress_part
from .normals import as_viewpoints, estimate_normals
from .scan import ScanPoints

Prepared: TypeAlias = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]
"""Positions and normals."""

_ROUNDS = 2
"""So many surfaces are made."""


@dataclass(frozen=True, eq=False)
class ScanAlignment:
    """How scans are moved onto each other.

    Attributes:
        matrices: (scans, 4, 4): `ScanPoints.moved` takes one. The first scan stays.
        before: The median distance of points from the planes of those nearest to them in other
            scans, within four times as far as points are apart.
        after: The same with all scans moved.
        pairs: How many points of each scan, of those looked at, have such a one afterward. A scan
            with 0 overlaps no other.
    """

    matrices: npt.NDArray[np.float64]
    before: float
    after: float
    pairs: tuple[int, ...]

    @classmethod
    def of(
        cls, found: tuple[npt.NDArray[np.float64], float, float, Sequence[int]]
    ) -> "ScanAlignment":
        """What the native module has found."""
        matrices, before, after, pairs = found
        return cls(matrices, before, after, tuple(pairs))


@dataclass(frozen=True, eq=False)
class SurfaceRounds:
    """Scans that are in place, but for what noise does to pairs of them.

    Attributes:
        scans: As they came.
        prepared: Their points, with normals that may point to either side.
        reach: See `align_scans`.
        iterations: See there.
        threads: See there.
    """

    scans: Sequence[ScanPoints]
    prepared: Sequence[Prepared]
    reach: float | None
    iterations: int
    threads: int

    def run(self, found: ScanAlignment, progress: ProgressCallback | None) -> ScanAlignment:
        """Moves on the scans that overlap others.

        Raises:
            Cancelled: `progress` returned False.
        """
        chosen = [k for k, pairs in enumerate(found.pairs) if pairs > 0]
        if len(chosen) < 2:
            return found
        matrices = found.matrices.copy()
        sides = self._sides(chosen, matrices, progress_part(progress, 0.0, 0.2))
        for k in range(_ROUNDS):
            part = progress_part(progress, 0.2 + 0.35 * k, 0.55 + 0.35 * k)
            matrices[chosen] = self._round(sides, matrices[chosen], part)
        moved = [_moved(one, matrix) for one, matrix in zip(self.prepared, matrices, strict=True)]
        last = _native.align_scans(
            moved, self.reach, 1, progress_part(progress, 0.9, 1.0), self.threads
        )
        return ScanAlignment(matrices, found.before, last[1], tuple(last[3]))

    def _sides(
        self,
        chosen: Sequence[int],
        matrices: npt.NDArray[np.float64],
        progress: ProgressCallback | None,
    ) -> list[tuple[Prepared, bool]]:
        """The points with normals that agree, and whether the side they point to is known."""
        moved = {k: _moved(self.prepared[k], matrices[k]) for k in chosen}
        toward: dict[int, npt.NDArray[np.float64]] = {}
        apart: list[int] = []
        for k in chosen:
            viewpoints = as_viewpoints(self.scans[k].moved(matrices[k]).viewpoint)
            if self.scans[k].normals is None and len(viewpoints):
                toward[k] = viewpoints - moved[k][0]
            elif self.scans[k].normals is None:
                apart.append(k)
        if apart:
            rows = np.concatenate([moved[k][0] for k in apart])
            together = estimate_normals(rows, progress=progress, threads=self.threads)
            ends = np.cumsum([len(moved[k][0]) for k in apart])[:-1]
            toward |= dict(zip(apart, np.split(together, ends), strict=True))
        sides = []
        for k in chosen:
            positions, normals = self.prepared[k]
            turned = _turned(normals, moved[k][1], toward.get(k))
            sides.append(((positions, turned), k not in apart))
        return sides

    def _round(
        self,
        scans: Sequence[tuple[Prepared, bool]],
        matrices: npt.NDArray[np.float64],
        progress: ProgressCallback | None,
    ) -> npt.NDArray[np.float64]:
        """The motions of scans onto a surface of all, from those that they have."""
        options = _native.ReconstructOptions()
        options.threads = self.threads
        options.are_sides_known = any(is_known for _, is_known in scans)
        points = tuple(
            _native.MovedPoints(_native.ArrayPoints(*one, None, None, [], True), matrix)
            for (one, _), matrix in zip(scans, matrices, strict=True)
        )
        positions, triangles, _, told = _native.reconstruct(
            _native.JoinedPoints(points), options, as_progress(progress_part(progress, 0.0, 0.5))
        )
        if told["is_flipped"]:
            triangles = np.ascontiguousarray(triangles[:, ::-1])
        return _native.align_to_surface(
            [one for one, _ in scans],
            list(matrices),
            positions,
            triangles,
            self.reach,
            self.iterations,
            as_progress(progress_part(progress, 0.5, 1.0)),
            self.threads,
        )[0]


def _moved(scan: Prepared, matrix: npt.NDArray[np.float64]) -> Prepared:
    moved = ScanPoints(*scan).moved(matrix)
    assert moved.normals is not None
    return moved.positions, np.asarray(moved.normals, np.float64)


def _turned(
    normals: npt.NDArray[np.float64],
    moved: npt.NDArray[np.float64],
    toward: npt.NDArray[np.float64] | None,
) -> npt.NDArray[np.float64]:
    """Normals of which those are reversed that, moved, do not point toward a direction."""
    if toward is None:
        return normals
    is_away = (moved * toward).sum(axis=1) < 0.0
    return np.where(is_away[:, None], -normals, normals)
