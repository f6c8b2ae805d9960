# SPDX-License-Identifier: GPL-3.0-or-later

"""Clouds to reconstruct, from arrays, scans in memory, files, or several of these."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias, TypeGuard, cast

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, progress_part
from .._border.arrays import as_array, as_floats, as_threads
from .alignment import ScanAlignment
from .choice import Choice
from .clouds import align_scans
from .directions import (
    GIVEN,
    OUTWARD,
    UP,
    VIEWPOINT,
    Orientation,
    Viewpoints,
    estimate_directed,
    orient_points,
)
from .normals import as_viewpoints, grid_normals, mask_unseen, mesh_normals
from .repairs import (
    CONTRADICTORY,
    MISSING,
    complete_normals,
    has_enough_normals,
    reorient_normals,
    without_direction,
)
from .scan import ScanPoints
from .scan_files import (
    is_from_above,
    is_ply,
    is_undirected,
    open_points,
    read_faces,
    read_points,
    read_range_grid,
)

Source: TypeAlias = str | os.PathLike[str] | ScanPoints
"""A file that `read_points` reads, or the scan that it returns."""

POINTS_A_SHARE = 1 << 26
"""Points of a source that are summed up as one unit of work, which machines can do in parallel."""

_LARGEST_VALUE = 1e30
_MAX_ALIGNMENT_POINTS = 1_000_000
"""Points per scan used for alignment, where the scan is not in memory anyway."""
_NormalsAndWeights: TypeAlias = tuple[npt.NDArray[np.float64], npt.NDArray[np.float32] | None]


@dataclass
class Cloud:
    """Points with normals.

    Attributes:
        points: The points for the native module.
        directions: Directions of normals, each once, in the order of the sources.
        is_prepared: Whether points were loaded or normals estimated, half of the whole work.
        alignment: Motions that aligned the scans; None where they were not aligned.
        has_given: Whether some of the normals were given.
        origin: Role of the origin where normals were estimated; see `guess_direction`.
        estimated: Number of given normals without a direction, which were estimated.
        is_reoriented: Whether given normals were reoriented as they contradicted each other.
        warnings: Oddities of files that were loaded; `points.warnings` has those of the others.
    """

    points: _native.PointSource
    directions: tuple[str, ...]
    is_prepared: bool = False
    alignment: ScanAlignment | None = None
    has_given: bool = False
    origin: str = "none"
    estimated: int = 0
    is_reoriented: bool = False
    warnings: tuple[str, ...] = ()

    @property
    def are_sides_known(self) -> bool:
        """Whether some normals are trusted to point out of the solid."""
        return any(direction != OUTWARD for direction in self.directions)

    def remaining_progress(self, progress: ProgressCallback | None) -> ProgressCallback | None:
        """Progress of the reconstruction that follows."""
        return progress_part(progress, 0.5, 1.0) if self.is_prepared else progress


def is_source(points: object) -> TypeGuard[Source]:
    return isinstance(points, str | os.PathLike | ScanPoints)


def sources_in(points: object) -> list[Source] | None:
    """The sources, for one or a list of them; None for anything else."""
    if is_source(points):
        return [points]
    if isinstance(points, list | tuple) and len(points) > 0 and all(map(is_source, points)):
        return list(points)
    return None


def array_cloud(
    points: npt.ArrayLike,
    normals: npt.ArrayLike | None,
    weights: npt.ArrayLike | None,
    attributes: npt.ArrayLike | None,
    orientation: Orientation,
    progress: ProgressCallback | None,
    threads: int,
    faults: frozenset[str] = frozenset(),
) -> Cloud:
    """Cloud from arrays; repairs the given faults of their normals.

    Raises ValueError for a wrong shape, type or value.
    """
    rows = _as_rows("points", points)
    own = None if normals is None else _as_rows("normals", normals)
    if own is not None and len(own) != len(rows):
        raise ValueError(f"normals: {len(own)} rows; {len(rows)} are needed, one for each point")
    scan = _Scan(
        None, None, ScanPoints(cast("Any", rows), own), faults=None if own is None else faults
    )
    scan.seen_from = orientation.viewpoints if len(orientation.viewpoints) else None
    half = progress_part(progress, 0.0, 0.5)
    if own is not None:
        scan.direction = orientation.for_given_normals()
        _repair_normals(scan, orientation, half, threads)
    if not scan.has_normals:
        _estimate([scan], orientation, half, threads)
    assert scan.loaded is not None
    given = cast("npt.NDArray[np.floating]", scan.loaded.normals)
    values = None
    if attributes is not None:
        values = as_floats("attributes", attributes, (len(rows), "n"), np.float32)
        _check_values("attributes", values, -_LARGEST_VALUE)
    counts = None
    if weights is not None:
        counts = as_floats("weights", weights, (len(rows),), np.float32)
        _check_values("weights", counts, 0.0)
    names = [] if values is None else [("", False)] * values.shape[1]
    source: _native.PointSource = _native.ArrayPoints(rows, given, counts, values, names, False)
    if scan.needs_orienting:
        source = orient_points(source, scan.direction, orientation.viewpoints)
    return Cloud(
        source,
        (scan.direction,),
        is_prepared=own is None or bool(faults),
        has_given=own is not None,
        origin=scan.origin,
        estimated=scan.estimated,
        is_reoriented=scan.axes is not None,
    )


def joined_cloud(
    sources: Sequence[Source],
    orientation: Orientation,
    progress: ProgressCallback | None,
    threads: int,
    choice: Choice | None = None,
    align: str | None = None,
    *,
    must_have_normals: bool = False,
    faults: frozenset[str] = frozenset(),
) -> Cloud:
    """Joins sources, or their chosen points, into one cloud with normals.

    Files with normals are read in chunks during the reconstruction. Sources without normals, and
    those with faulty ones, are loaded here. Their normals come from a scanner's grid or the faces
    in a PLY file, or are estimated: separately for each scan with a viewpoint, together for the
    others.

    Raises:
        ValueError: A source has no normals, and must have them.
    """
    # Unpacking reports no progress, but can be cancelled.
    scans = [_open_scan(source, choice, progress_part(progress, 0.0, 0.0)) for source in sources]
    _assign_viewpoints(scans, orientation.viewpoints)
    given = [scan for scan in scans if scan.has_normals]
    for scan in given:
        scan.faults = faults
    missing = [scan for scan in scans if not scan.has_normals or scan.faults]
    if missing and must_have_normals:
        raise ValueError(
            f"'{missing[0].path}' has no normals that are known to point outward; steps need them"
        )
    progress = progress_part(progress, 0.0, 0.5)
    for scan in given:
        scan.direction = orientation.for_given_normals()
    for k, scan in enumerate(missing):
        part = _share(progress_part(progress, 0.0, 0.6), k, len(missing))
        _load_normals(scan, orientation, part, threads)
    groups = _group_for_estimation([scan for scan in missing if not scan.has_normals])
    for k, group in enumerate(groups):
        part = _share(progress_part(progress, 0.6, 0.9), k, len(groups))
        _estimate(group, orientation, part, threads)
    alignment = None
    if align is not None and len(scans) > 1:
        constant = progress_part(progress, 0.9, 0.9)
        samples = [scan.alignment_points(constant) for scan in scans]
        last = progress_part(progress, 0.9, 1.0)
        alignment = align_scans(samples, against=cast("Any", align), progress=last, threads=threads)
    native = tuple(scan.native() for scan in scans)
    if alignment is not None:
        pairs = zip(native, alignment.matrices, strict=True)
        native = tuple(_native.MovedPoints(points, matrix) for points, matrix in pairs)
    joined = _native.JoinedPoints(native, POINTS_A_SHARE)
    return Cloud(
        native[0] if joined.share_count == 1 else joined,
        tuple(dict.fromkeys(scan.direction for scan in scans)),
        is_prepared=bool(missing) or alignment is not None,
        alignment=alignment,
        has_given=bool(given),
        origin=next((scan.origin for scan in scans if scan.origin != "none"), "none"),
        estimated=sum(scan.estimated for scan in scans),
        is_reoriented=any(scan.axes is not None for scan in scans),
        warnings=tuple(line for scan in scans if scan.loaded for line in scan.loaded.warnings),
    )


@dataclass
class _Scan:
    """A source whose normals are being prepared.

    Attributes:
        path: Path of its file, if it is a file.
        points: The opened file.
        loaded: Its points in memory.
        choice: Choice of points of the file; `loaded` is chosen already.
        is_from_above: See `ScanPoints`.
        seen_from: The user's viewpoint of the scan; see `Orientation`.
        direction: Direction of its normals, once known.
        needs_orienting: Whether its normals may still point elsewhere.
        faults: Known faults of its given normals; None where it has none.
        axes: Given normals that contradict each other, to be reoriented.
        origin: Role of the origin; see `guess_direction`.
        estimated: Number of given normals without a direction, which were estimated.
    """

    path: str | os.PathLike[str] | None
    points: _native.PointSource | None
    loaded: ScanPoints | None
    choice: Choice | None = None
    is_from_above: bool = False
    seen_from: Viewpoints | None = None
    direction: str = ""
    needs_orienting: bool = True
    faults: frozenset[str] | None = None
    axes: npt.NDArray[np.floating] | None = None
    origin: str = "none"
    estimated: int = 0

    @property
    def has_normals(self) -> bool:
        if self.loaded is not None:
            return self.loaded.normals is not None
        points = self.points
        return points is not None and points.has_normals and not is_undirected(points)

    @property
    def viewpoints(self) -> Viewpoints:
        """Positions of the scanner, from the user or else from the file; (0, 3) if unknown."""
        if self.seen_from is not None:
            return self.seen_from
        return as_viewpoints(None if self.loaded is None else self.loaded.viewpoint)

    def alignment_points(self, progress: ProgressCallback | None) -> ScanPoints:
        """Points with normals for alignment: the loaded ones, or a part of the file."""
        if self.loaded is not None and not (
            self.needs_orienting and self.direction in (UP, VIEWPOINT)
        ):
            return self.loaded
        positions, normals, *_ = _native.read_points(self.native(), _MAX_ALIGNMENT_POINTS, progress)
        return ScanPoints(positions, normals)

    def native(self) -> _native.PointSource:
        """The points for the native module."""
        points = self._native()
        if self.needs_orienting:
            points = orient_points(points, self.direction, self.viewpoints)
        return points

    def _native(self) -> _native.PointSource:
        if self.loaded is None:
            assert self.points is not None
            return self.points
        columns, names = [], []
        for name, values in self.loaded.attributes.items():
            columns.append(values)
            names.append((name, values.dtype == np.uint8))
        assert self.loaded.normals is not None
        return _native.ArrayPoints(
            self.loaded.positions,
            self.loaded.normals,
            self.loaded.weights,
            np.stack(columns, axis=1).astype(np.float32) if columns else None,
            names,
            self.points is None or self.points.is_double,
        )


def _open_scan(source: Source, choice: Choice | None, progress: ProgressCallback | None) -> _Scan:
    if not isinstance(source, ScanPoints):
        points = open_points(source, progress=progress)
        if choice is not None:
            points = choice.of_file(points, os.fsdecode(source))
        return _Scan(source, points, None, choice, is_from_above(source))
    rows = as_floats("positions", source.positions, ("points", 3), np.float64)
    normals = None if source.normals is None else _as_rows("normals", source.normals)
    if normals is not None and len(normals) != len(rows):
        raise ValueError(
            f"normals: {len(normals)} rows; {len(rows)} are needed, one for each point"
        )
    attributes = {
        name: _as_values(name, values, len(rows)) for name, values in source.attributes.items()
    }
    weights = source.weights
    if weights is not None:
        weights = as_floats("weights", weights, (len(rows),), np.float32)
    scan = replace(source, positions=rows, normals=normals, weights=weights, attributes=attributes)
    chosen = scan if choice is None else choice.of_scan(scan)
    return _Scan(None, None, chosen, is_from_above=source.is_from_above)


def _assign_viewpoints(scans: Sequence[_Scan], viewpoints: Viewpoints) -> None:
    """Assigns the user's viewpoints to scans: one for all, or one for each."""
    if len(viewpoints) not in (0, 1, len(scans)):
        raise ValueError(
            f"viewpoint: found {len(viewpoints)} for {len(scans)} sources; one for all or one for "
            "each is needed"
        )
    for k, scan in enumerate(scans if len(viewpoints) else ()):
        scan.seen_from = viewpoints[k : k + 1] if len(viewpoints) > 1 else viewpoints


def _group_for_estimation(scans: Sequence[_Scan]) -> list[list[_Scan]]:
    """Groups scans that may be parts of one surface, to estimate their normals together."""
    groups = [[scan] for scan in scans if len(scan.viewpoints)]
    for is_above in (True, False):
        unseen = [
            scan for scan in scans if not len(scan.viewpoints) and scan.is_from_above is is_above
        ]
        groups += [unseen] if unseen else []
    return groups


def _load_normals(
    scan: _Scan, orientation: Orientation, progress: ProgressCallback | None, threads: int
) -> None:
    """Loads a scan without normals or with faulty ones, and finds normals in its file."""
    if scan.path is None:
        _repair_normals(scan, orientation, progress, threads)
        return
    # Grids and faces index points of the whole file.
    read = read_points(scan.path, progress=progress_part(progress, 0.0, 0.3))
    if scan.seen_from is not None:
        read = replace(read, viewpoint=scan.seen_from[0])
    if scan.faults:
        scan.loaded = read
        _repair_normals(scan, orientation, progress_part(progress, 0.3, 0.6), threads)
        if scan.loaded.normals is not None:
            scan.loaded = scan.loaded if scan.choice is None else scan.choice.of_scan(scan.loaded)
            return
        read = scan.loaded
    from_grid = derived = None
    if read.normals is None:
        from_grid = _grid_normals(scan.path, read, progress_part(progress, 0.3, 0.6))
        derived = from_grid or _face_normals(scan.path, read, progress_part(progress, 0.6, 1.0))
    if derived is not None:
        normals, weights = derived
        read = replace(read, normals=normals, weights=weights)
    if read.normals is not None:
        # A scanner sees outsides. Faces and splats may be inside out.
        scan.direction = orientation.for_file_normals(OUTWARD if from_grid is None else VIEWPOINT)
        scan.needs_orienting = from_grid is None or scan.direction != VIEWPOINT
        scan.axes = None
    if scan.choice is not None:
        # `axes` are normals of the whole file, and have to follow the choice of points.
        axes = None if scan.axes is None else scan.choice.of_scan(replace(read, normals=scan.axes))
        scan.axes = None if axes is None else axes.normals
    scan.loaded = read if scan.choice is None else scan.choice.of_scan(read)


def _repair_normals(
    scan: _Scan, orientation: Orientation, progress: ProgressCallback | None, threads: int
) -> None:
    """Completes given normals in memory, or removes them if they have to be estimated."""
    read = scan.loaded
    if not scan.faults or read is None or read.normals is None:
        return
    given = read.normals
    if MISSING in scan.faults:
        lacks = without_direction(given)
        scan.estimated = int(np.count_nonzero(lacks))
        if not has_enough_normals(given):
            if orientation.direction == GIVEN:
                raise ValueError(
                    "direction: 'given', but normals are zero or no numbers; use another direction"
                )
            scan.loaded = replace(read, normals=None)
            return
        if lacks.any():
            given = _complete_normals(read.positions, given, orientation, progress, threads)
    if CONTRADICTORY in scan.faults:
        scan.axes = given
        scan.loaded = replace(read, normals=None)
    else:
        scan.loaded = replace(read, normals=given)


def _complete_normals(
    positions: npt.NDArray[np.floating],
    given: npt.NDArray[np.floating],
    orientation: Orientation,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float64]:
    """Derives missing normals from given ones; estimates them in parts without any."""
    seen = mask_unseen(np.asarray(positions, np.float64), None, as_threads(threads))
    normals = complete_normals(seen, given, progress_part(progress, 0.0, 0.8), threads)
    left = without_direction(normals) & np.isfinite(seen).all(axis=1)
    if left.any():
        progress = progress_part(progress, 0.8, 1.0)
        side = OUTWARD if orientation.direction == GIVEN else orientation.direction
        viewpoints = orientation.viewpoints
        viewpoints = viewpoints[left] if len(viewpoints) == len(left) > 1 else viewpoints
        normals[left] = estimate_directed(seen[left], side, viewpoints, progress, threads)
    return normals


def _estimate(
    group: Sequence[_Scan],
    orientation: Orientation,
    progress: ProgressCallback | None,
    threads: int,
) -> None:
    """Estimates the normals of one scan, or of several without a known viewpoint."""
    scans = [scan.loaded for scan in group if scan.loaded is not None]
    rows = np.concatenate([read.positions for read in scans])
    viewpoints = group[0].viewpoints
    first, last = progress_part(progress, 0.0, 0.05), progress_part(progress, 0.05, 1.0)
    direction, origin = orientation.for_missing_normals(
        rows, bool(len(viewpoints)), group[0].is_from_above, first, threads
    )
    normals = estimate_directed(rows, direction, viewpoints, last, threads)
    ends = np.cumsum([len(read.positions) for read in scans])[:-1]
    for scan, read, own in zip(group, scans, np.split(normals, ends), strict=True):
        oriented = own if scan.axes is None else reorient_normals(scan.axes, own)
        scan.loaded = replace(read, normals=oriented)
        scan.direction = direction
        scan.origin = origin
        scan.needs_orienting = False


def file_normals(
    path: str | os.PathLike[str], read: ScanPoints, *, progress: ProgressCallback | None = None
) -> _NormalsAndWeights | None:
    """Derives normals from a scanner's grid or the faces in a PLY file.

    Args:
        path: Path of the file.
        read: Its points, as `read_points` returns them.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        Normals, (points, 3), and weights, (points,) or None for equal weights. None if the file has
        neither grid nor faces; use `estimate_normals` then.

    Raises:
        ValueError: The file is damaged.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    return _grid_normals(path, read, progress_part(progress, 0.0, 0.7)) or _face_normals(
        path, read, progress_part(progress, 0.7, 1.0)
    )


def _share(progress: ProgressCallback | None, k: int, count: int) -> ProgressCallback | None:
    return progress_part(progress, k / count, (k + 1) / count)


def _grid_normals(
    path: str | os.PathLike[str], read: ScanPoints, progress: ProgressCallback | None
) -> _NormalsAndWeights | None:
    first, last = progress_part(progress, 0.0, 0.5), progress_part(progress, 0.5, 1.0)
    grid = read_range_grid(path, progress=first) if is_ply(path) else None
    if grid is None:
        return None
    normals, weights = grid_normals(read.positions, grid, viewpoint=read.viewpoint, progress=last)
    return normals, weights if read.weights is None else weights * read.weights


def _face_normals(
    path: str | os.PathLike[str], read: ScanPoints, progress: ProgressCallback | None
) -> _NormalsAndWeights | None:
    if not is_ply(path):
        return None
    first, last = progress_part(progress, 0.0, 0.5), progress_part(progress, 0.5, 1.0)
    triangles = read_faces(path, progress=first)
    # Ignore a few faces that do not form a mesh of the points.
    if len(np.unique(triangles)) <= len(read.positions) / 2:
        return None
    return mesh_normals(read.positions, triangles, progress=last), read.weights


def _as_values(name: str, values: npt.ArrayLike, count: int) -> npt.NDArray[np.uint8 | np.float32]:
    array = as_array(f"attributes: '{name}'", values)
    dtype = np.uint8 if array.dtype == np.uint8 else np.float32
    return as_floats(f"attributes: '{name}'", array, (count,), dtype)


def _as_rows(name: str, array: npt.ArrayLike) -> npt.NDArray[np.floating]:
    """Rows of three; float32 stays float32, everything else becomes float64."""
    rows = as_array(name, array)
    dtype = np.float32 if rows.dtype == np.float32 else np.float64
    return as_floats(name, rows, ("points", 3), dtype)


def _check_values(name: str, values: npt.NDArray[np.float32], low: float) -> None:
    """Refuses weights or attributes whose sums may not be finite."""
    is_bad = ~((values >= low) & (values <= _LARGEST_VALUE))
    if is_bad.any():
        index = tuple(np.argwhere(is_bad)[0])
        raise ValueError(
            f"{name}: point {index[0]} has {values[index]}; "
            f"numbers from {low:g} to {_LARGEST_VALUE:g} are needed"
        )
