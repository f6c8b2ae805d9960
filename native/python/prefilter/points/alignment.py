# SPDX-License-Identifier: GPL-3.0-or-later

"""Alignment of scans to a surface of all of them."""

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
"""Number of surfaces that are reconstructed and aligned to."""


@dataclass(frozen=True, eq=False)
class ScanAlignment:
    """Motions that align scans.

    Attributes:
        matrices: (scans, 4, 4), one for `ScanPoints.moved` of each scan. The first scan stays.
        before: Median distance of points from the plane of the nearest point in another scan,
            over points with one within four point spacings.
        after: The same once all scans are moved.
        pairs: Number of sampled points of each scan that then have such a nearest point. A scan
            with 0 overlaps no other.
    """

    matrices: npt.NDArray[np.float64]
    before: float
    after: float
    pairs: tuple[int, ...]

    @classmethod
    def of(
        cls, result: tuple[npt.NDArray[np.float64], float, float, Sequence[int]]
    ) -> "ScanAlignment":
        """Wraps a result of the native module."""
        matrices, before, after, pairs = result
        return cls(matrices, before, after, tuple(pairs))


@dataclass(frozen=True, eq=False)
class SurfaceRounds:
    """Refinement of scans that are already aligned in pairs, so that noise averages out.

    Attributes:
        scans: The scans before any motion.
        prepared: Their points, with normals whose side is arbitrary.
        reach: See `align_scans`.
        iterations: See `align_scans`.
        threads: See `align_scans`.
    """

    scans: Sequence[ScanPoints]
    prepared: Sequence[Prepared]
    reach: float | None
    iterations: int
    threads: int

    def run(self, alignment: ScanAlignment, progress: ProgressCallback | None) -> ScanAlignment:
        """Refines the motions of the scans that overlap others.

        Raises:
            Cancelled: `progress` returned False.
        """
        chosen = [k for k, pairs in enumerate(alignment.pairs) if pairs > 0]
        if len(chosen) < 2:
            return alignment
        matrices = alignment.matrices.copy()
        sides = self._sides(chosen, matrices, progress_part(progress, 0.0, 0.2))
        for k in range(_ROUNDS):
            part = progress_part(progress, 0.2 + 0.35 * k, 0.55 + 0.35 * k)
            matrices[chosen] = self._round(sides, matrices[chosen], part)
        moved = [_moved(scan, matrix) for scan, matrix in zip(self.prepared, matrices, strict=True)]
        last = _native.align_scans(
            moved, self.reach, 1, progress_part(progress, 0.9, 1.0), self.threads
        )
        return ScanAlignment(matrices, alignment.before, last[1], tuple(last[3]))

    def _sides(
        self,
        chosen: Sequence[int],
        matrices: npt.NDArray[np.float64],
        progress: ProgressCallback | None,
    ) -> list[tuple[Prepared, bool]]:
        """Points with consistently oriented normals, and whether their side is known."""
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
            estimates = estimate_normals(rows, progress=progress, threads=self.threads)
            ends = np.cumsum([len(moved[k][0]) for k in apart])[:-1]
            toward |= dict(zip(apart, np.split(estimates, ends), strict=True))
        sides = []
        for k in chosen:
            positions, normals = self.prepared[k]
            oriented = _oriented(normals, moved[k][1], toward.get(k))
            sides.append(((positions, oriented), k not in apart))
        return sides

    def _round(
        self,
        scans: Sequence[tuple[Prepared, bool]],
        matrices: npt.NDArray[np.float64],
        progress: ProgressCallback | None,
    ) -> npt.NDArray[np.float64]:
        """Reconstructs a surface of all scans and aligns each to it; returns the new motions."""
        options = _native.ReconstructOptions()
        options.threads = self.threads
        options.are_sides_known = any(is_known for _, is_known in scans)
        points = tuple(
            _native.MovedPoints(_native.ArrayPoints(*scan, None, None, [], True), matrix)
            for (scan, _), matrix in zip(scans, matrices, strict=True)
        )
        positions, triangles, _, findings = _native.reconstruct(
            _native.JoinedPoints(points), options, as_progress(progress_part(progress, 0.0, 0.5))
        )
        if findings["is_flipped"]:
            triangles = np.ascontiguousarray(triangles[:, ::-1])
        return _native.align_to_surface(
            [scan for scan, _ in scans],
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


def _oriented(
    normals: npt.NDArray[np.float64],
    moved: npt.NDArray[np.float64],
    toward: npt.NDArray[np.float64] | None,
) -> npt.NDArray[np.float64]:
    """Reverses the normals that, once moved, point away from the directions `toward`."""
    if toward is None:
        return normals
    is_away = (moved * toward).sum(axis=1) < 0.0
    return np.where(is_away[:, None], -normals, normals)
