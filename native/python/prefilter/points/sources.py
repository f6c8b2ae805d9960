# SPDX-License-Identifier: GPL-3.0-or-later

"""Where a surface's points come from: arrays, scans in memory, files, or several of these."""

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
    Viewpoints,
    Wanted,
    estimated,
    parts,
    turned,
)
from .normals import as_viewpoints, grid_normals, mesh_normals, seen_points
from .repairs import (
    CONTRADICTORY,
    MISSING,
    completed,
    has_enough,
    lacking,
    reoriented,
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
"""A file that `read_points` reads, or what it returns."""

POINTS_A_SHARE = 1 << 26
"""So many points of a source are summed up by themselves; machines can do that side by side."""

_LARGEST_VALUE = 1e30
_ENOUGH = 1_000_000
_Told: TypeAlias = tuple[npt.NDArray[np.float64], npt.NDArray[np.float32] | None]


@dataclass
class Cloud:
    """Points with normals.

    Attributes:
        points: For the native module.
        directions: Of normals: each once, in the order of the sources.
        is_read: Points had to be read into memory, or normals estimated, which is half of the work.
        alignment: How scans were moved onto each other; None where they were not.
        has_given: Some of the normals were given.
        origin: What the origin is to points whose normals were estimated; see `side_of`.
        estimated: How many normals were estimated, as the given ones have no direction.
        is_reoriented: Given normals were turned, as they contradicted each other.
        warnings: What is odd about files that have been read; the points know it of the others.
    """

    points: _native.PointSource
    directions: tuple[str, ...]
    is_read: bool = False
    alignment: ScanAlignment | None = None
    has_given: bool = False
    origin: str = "none"
    estimated: int = 0
    is_reoriented: bool = False
    warnings: tuple[str, ...] = ()

    @property
    def are_sides_known(self) -> bool:
        """Whether some normals point for sure to where there is nothing."""
        return any(direction != OUTWARD for direction in self.directions)

    def rest(self, progress: ProgressCallback | None) -> ProgressCallback | None:
        """What is told of the work that is left, of all that `progress` is told of."""
        return progress_part(progress, 0.5, 1.0) if self.is_read else progress


def is_source(points: object) -> TypeGuard[Source]:
    return isinstance(points, str | os.PathLike | ScanPoints)


def sources_in(points: object) -> list[Source] | None:
    """The sources that are given, one or a list of them; None for anything else."""
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
    wanted: Wanted,
    progress: ProgressCallback | None,
    threads: int,
    faults: frozenset[str] = frozenset(),
) -> Cloud:
    """Points from arrays, of whose normals faults are known.

    Raises ValueError for a shape, type or value that is wrong.
    """
    rows = _as_rows("points", points)
    own = None if normals is None else _as_rows("normals", normals)
    if own is not None and len(own) != len(rows):
        raise ValueError(f"normals: {len(own)} rows; {len(rows)} are needed, one for each point")
    scan = _Scan(
        None, None, ScanPoints(cast("Any", rows), own), faults=None if own is None else faults
    )
    scan.seen_from = wanted.viewpoints if len(wanted.viewpoints) else None
    half = progress_part(progress, 0.0, 0.5)
    if own is not None:
        scan.direction = wanted.of_given()
        _repair(scan, wanted, half, threads)
    if not scan.has_normals:
        _estimate([scan], wanted, half, threads)
    assert scan.read is not None
    given = cast("npt.NDArray[np.floating]", scan.read.normals)
    values = None
    if attributes is not None:
        values = as_floats("attributes", attributes, (len(rows), "n"), np.float32)
        _check_values("attributes", values, -_LARGEST_VALUE)
    counts = None
    if weights is not None:
        counts = as_floats("weights", weights, (len(rows),), np.float32)
        _check_values("weights", counts, 0.0)
    names = [] if values is None else [("", False)] * values.shape[1]
    points_of: _native.PointSource
    points_of = _native.ArrayPoints(rows, given, counts, values, names, False)
    if scan.is_to_be_turned:
        points_of = turned(points_of, scan.direction, wanted.viewpoints)
    return Cloud(
        points_of,
        (scan.direction,),
        is_read=own is None or bool(faults),
        has_given=own is not None,
        origin=scan.origin,
        estimated=scan.estimated,
        is_reoriented=scan.axes is not None,
    )


def joined_cloud(
    sources: Sequence[Source],
    wanted: Wanted,
    progress: ProgressCallback | None,
    threads: int,
    choice: Choice | None = None,
    align: str | None = None,
    *,
    must_have_normals: bool = False,
    faults: frozenset[str] = frozenset(),
) -> Cloud:
    """Several sources as one, with normals, of which only some points may be chosen.

    What has normals is read piece by piece, when the surface is made. All else is read into memory
    here: in a PLY file a scanner's grid or faces tell the normals, others are estimated, those seen
    from one place by themselves, and those seen from nobody knows where together. So is what has
    normals of which faults are known.

    Raises:
        ValueError: A source has no normals, and must have them.
    """
    # Nothing is told of unpacking, which may be stopped.
    scans = [_opened(source, choice, progress_part(progress, 0.0, 0.0)) for source in sources]
    _place_scanners(scans, wanted.viewpoints)
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
        scan.direction = wanted.of_given()
    for k, scan in enumerate(missing):
        own = _step(progress_part(progress, 0.0, 0.6), k, len(missing))
        _look_up_normals(scan, wanted, own, threads)
    groups = _estimated_together([scan for scan in missing if not scan.has_normals])
    for k, group in enumerate(groups):
        _estimate(group, wanted, _step(progress_part(progress, 0.6, 0.9), k, len(groups)), threads)
    alignment = None
    if align is not None and len(scans) > 1:
        # What has been read is passed as it is, of all else some points are enough.
        still = progress_part(progress, 0.9, 0.9)
        some = [scan.some_points(still) for scan in scans]
        last = progress_part(progress, 0.9, 1.0)
        alignment = align_scans(some, against=cast("Any", align), progress=last, threads=threads)
    native = tuple(scan.native() for scan in scans)
    if alignment is not None:
        pairs = zip(native, alignment.matrices, strict=True)
        native = tuple(_native.MovedPoints(points, matrix) for points, matrix in pairs)
    joined = _native.JoinedPoints(native, POINTS_A_SHARE)
    return Cloud(
        native[0] if joined.share_count == 1 else joined,
        tuple(dict.fromkeys(scan.direction for scan in scans)),
        is_read=bool(missing) or alignment is not None,
        alignment=alignment,
        has_given=bool(given),
        origin=next((scan.origin for scan in scans if scan.origin != "none"), "none"),
        estimated=sum(scan.estimated for scan in scans),
        is_reoriented=any(scan.axes is not None for scan in scans),
        warnings=tuple(line for scan in scans if scan.read for line in scan.read.warnings),
    )


@dataclass
class _Scan:
    """A source on its way to having normals.

    Attributes:
        path: Of its file, if it is one.
        points: The file, opened.
        read: What is in memory.
        choice: Which points of the file are used; those in memory are chosen already.
        is_from_above: See `ScanPoints`.
        seen_from: Where the user says that the scanner stood; see `Wanted`.
        direction: Of its normals, once that is known.
        is_to_be_turned: Its normals may have another one yet.
        faults: That its given normals are known to have; None where it has no given ones.
        axes: Given normals that contradict each other; None for others.
        origin: What the origin is to it; see `side_of`.
        estimated: How many normals were estimated, as the given ones have no direction.
    """

    path: str | os.PathLike[str] | None
    points: _native.PointSource | None
    read: ScanPoints | None
    choice: Choice | None = None
    is_from_above: bool = False
    seen_from: Viewpoints | None = None
    direction: str = ""
    is_to_be_turned: bool = True
    faults: frozenset[str] | None = None
    axes: npt.NDArray[np.floating] | None = None
    origin: str = "none"
    estimated: int = 0

    @property
    def has_normals(self) -> bool:
        if self.read is not None:
            return self.read.normals is not None
        points = self.points
        return points is not None and points.has_normals and not is_undirected(points)

    @property
    def viewpoints(self) -> Viewpoints:
        """Where the scanner stood, as the user or else what was read says; (0, 3) for nothing."""
        if self.seen_from is not None:
            return self.seen_from
        return as_viewpoints(None if self.read is None else self.read.viewpoint)

    def some_points(self, progress: ProgressCallback | None) -> ScanPoints:
        """Points with normals, at most as many as tell where the scan is."""
        if self.read is not None and not (
            self.is_to_be_turned and self.direction in (UP, VIEWPOINT)
        ):
            return self.read
        positions, normals, *_ = _native.read_points(self.native(), _ENOUGH, progress)
        return ScanPoints(positions, normals)

    def native(self) -> _native.PointSource:
        """The points for the native module."""
        own = self._native()
        return turned(own, self.direction, self.viewpoints) if self.is_to_be_turned else own

    def _native(self) -> _native.PointSource:
        if self.read is None:
            assert self.points is not None
            return self.points
        columns, names = [], []
        for name, values in self.read.attributes.items():
            columns.append(values)
            names.append((name, values.dtype == np.uint8))
        assert self.read.normals is not None
        return _native.ArrayPoints(
            self.read.positions,
            self.read.normals,
            self.read.weights,
            np.stack(columns, axis=1).astype(np.float32) if columns else None,
            names,
            self.points is None or self.points.is_double,
        )


def _opened(source: Source, choice: Choice | None, progress: ProgressCallback | None) -> _Scan:
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
    checked = {name: _as_values(name, one, len(rows)) for name, one in source.attributes.items()}
    weights = source.weights
    if weights is not None:
        weights = as_floats("weights", weights, (len(rows),), np.float32)
    read = replace(source, positions=rows, normals=normals, weights=weights, attributes=checked)
    chosen = read if choice is None else choice.of_scan(read)
    return _Scan(None, None, chosen, is_from_above=source.is_from_above)


def _place_scanners(scans: Sequence[_Scan], viewpoints: Viewpoints) -> None:
    """Says of scans where the user says that scanners stood: one place for all, or one for each."""
    if len(viewpoints) not in (0, 1, len(scans)):
        raise ValueError(
            f"viewpoint: found {len(viewpoints)} for {len(scans)} sources; one for all or one for "
            "each is needed"
        )
    for k, scan in enumerate(scans if len(viewpoints) else ()):
        scan.seen_from = viewpoints[k : k + 1] if len(viewpoints) > 1 else viewpoints


def _estimated_together(scans: Sequence[_Scan]) -> list[list[_Scan]]:
    """Scans whose normals are estimated together: those that may be parts of one surface."""
    groups = [[scan] for scan in scans if len(scan.viewpoints)]
    for is_above in (True, False):
        unseen = [
            scan for scan in scans if not len(scan.viewpoints) and scan.is_from_above is is_above
        ]
        groups += [unseen] if unseen else []
    return groups


def _look_up_normals(
    scan: _Scan, wanted: Wanted, progress: ProgressCallback | None, threads: int
) -> None:
    """Reads a file that has no normals, or faulty ones, and what else in it may tell them."""
    if scan.path is None:
        _repair(scan, wanted, progress, threads)
        return
    # Grids and faces name points of the whole file.
    read = read_points(scan.path, progress=progress_part(progress, 0.0, 0.3))
    if scan.seen_from is not None:
        read = replace(read, viewpoint=scan.seen_from[0])
    if scan.faults:
        scan.read = read
        _repair(scan, wanted, progress_part(progress, 0.3, 0.6), threads)
        if scan.read.normals is not None:
            scan.read = scan.read if scan.choice is None else scan.choice.of_scan(scan.read)
            return
        read = scan.read
    seen = told = None
    if read.normals is None:
        seen = _grid_normals(scan.path, read, progress_part(progress, 0.3, 0.6))
        told = seen or _face_normals(scan.path, read, progress_part(progress, 0.6, 1.0))
    if told is not None:
        normals, weights = told
        read = replace(read, normals=normals, weights=weights)
    if read.normals is not None:
        # A scanner sees outsides. Faces, and splats, may be inside out.
        scan.direction = wanted.told(VIEWPOINT if seen is not None else OUTWARD)
        scan.is_to_be_turned = seen is None or scan.direction != VIEWPOINT
        scan.axes = None
    if scan.choice is not None:
        # Normals of the whole file are chosen with its points.
        axes = None if scan.axes is None else scan.choice.of_scan(replace(read, normals=scan.axes))
        scan.axes = None if axes is None else axes.normals
    scan.read = read if scan.choice is None else scan.choice.of_scan(read)


def _repair(scan: _Scan, wanted: Wanted, progress: ProgressCallback | None, threads: int) -> None:
    """Completes given normals in memory, or takes those away that are to be estimated."""
    read = scan.read
    if not scan.faults or read is None or read.normals is None:
        return
    given = read.normals
    if MISSING in scan.faults:
        lacks = lacking(given)
        scan.estimated = int(np.count_nonzero(lacks))
        if not has_enough(given):
            if wanted.direction == GIVEN:
                raise ValueError(
                    "direction: 'given', but normals are zero or no numbers; use another direction"
                )
            scan.read = replace(read, normals=None)
            return
        if lacks.any():
            given = _completed(read.positions, given, wanted, progress, threads)
    if CONTRADICTORY in scan.faults:
        scan.axes = given
        scan.read = replace(read, normals=None)
    else:
        scan.read = replace(read, normals=given)


def _completed(
    positions: npt.NDArray[np.floating],
    given: npt.NDArray[np.floating],
    wanted: Wanted,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float64]:
    """Given normals, and those that follow from them; or, in parts without any, estimated ones."""
    seen = seen_points(np.asarray(positions, np.float64), None, as_threads(threads))
    found = completed(seen, given, progress_part(progress, 0.0, 0.8), threads)
    left = lacking(found) & np.isfinite(seen).all(axis=1)
    if left.any():
        rest = progress_part(progress, 0.8, 1.0)
        side = OUTWARD if wanted.direction == GIVEN else wanted.direction
        places = wanted.viewpoints
        places = places[left] if len(places) == len(left) > 1 else places
        found[left] = estimated(seen[left], side, places, rest, threads)
    return found


def _estimate(
    group: Sequence[_Scan], wanted: Wanted, progress: ProgressCallback | None, threads: int
) -> None:
    """Estimates the normals of one scan, or of several that no viewpoint is known of."""
    scans = [scan.read for scan in group if scan.read is not None]
    rows = np.concatenate([read.positions for read in scans])
    viewpoints = group[0].viewpoints
    first, rest = parts(progress)
    direction, origin = wanted.of_missing(
        rows, bool(len(viewpoints)), group[0].is_from_above, first, threads
    )
    normals = estimated(rows, direction, viewpoints, rest, threads)
    ends = np.cumsum([len(read.positions) for read in scans])[:-1]
    for scan, read, own in zip(group, scans, np.split(normals, ends), strict=True):
        found = own if scan.axes is None else reoriented(scan.axes, own)
        scan.read = replace(read, normals=found)
        scan.direction = direction
        scan.origin = origin
        scan.is_to_be_turned = False


def file_normals(
    path: str | os.PathLike[str], read: ScanPoints, *, progress: ProgressCallback | None = None
) -> _Told | None:
    """What a file without normals tells of them besides the positions of its points.

    In a PLY file that is a scanner's grid, or faces of the points.

    Args:
        path: Of the file.
        read: Its points, as `read_points` returns them.
        progress: Called with the fraction done; returning False stops the work.

    Returns:
        Normals, (points, 3), and how much each point counts, (points,) or None: all the same. None
        where the file tells nothing; `estimate_normals` does without.

    Raises:
        ValueError: The file is damaged.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    return _grid_normals(path, read, progress_part(progress, 0.0, 0.7)) or _face_normals(
        path, read, progress_part(progress, 0.7, 1.0)
    )


def _step(progress: ProgressCallback | None, k: int, count: int) -> ProgressCallback | None:
    return progress_part(progress, k / count, (k + 1) / count)


def _grid_normals(
    path: str | os.PathLike[str], read: ScanPoints, progress: ProgressCallback | None
) -> _Told | None:
    first, rest = progress_part(progress, 0.0, 0.5), progress_part(progress, 0.5, 1.0)
    grid = read_range_grid(path, progress=first) if is_ply(path) else None
    if grid is None:
        return None
    normals, sureness = grid_normals(read.positions, grid, viewpoint=read.viewpoint, progress=rest)
    return normals, sureness if read.weights is None else sureness * read.weights


def _face_normals(
    path: str | os.PathLike[str], read: ScanPoints, progress: ProgressCallback | None
) -> _Told | None:
    if not is_ply(path):
        return None
    first, rest = progress_part(progress, 0.0, 0.5), progress_part(progress, 0.5, 1.0)
    triangles = read_faces(path, progress=first)
    # A few faces are no mesh of the points.
    if len(np.unique(triangles)) <= len(read.positions) / 2:
        return None
    return mesh_normals(read.positions, triangles, progress=rest), read.weights


def _as_values(name: str, values: npt.ArrayLike, count: int) -> npt.NDArray[np.uint8 | np.float32]:
    found = as_array(f"attributes: '{name}'", values)
    dtype = np.uint8 if found.dtype == np.uint8 else np.float32
    return as_floats(f"attributes: '{name}'", found, (count,), dtype)


def _as_rows(name: str, array: npt.ArrayLike) -> npt.NDArray[np.floating]:
    """Rows of three, float32 or float64 as they are."""
    found = as_array(name, array)
    dtype = np.float32 if found.dtype == np.float32 else np.float64
    return as_floats(name, found, ("points", 3), dtype)


def _check_values(name: str, values: npt.NDArray[np.float32], low: float) -> None:
    """Rows, one for each point: weights or attributes, of which sums have to be finite."""
    is_bad = ~((values >= low) & (values <= _LARGEST_VALUE))
    if is_bad.any():
        place = tuple(np.argwhere(is_bad)[0])
        raise ValueError(
            f"{name}: point {place[0]} has {values[place]}; "
            f"numbers from {low:g} to {_LARGEST_VALUE:g} are needed"
        )
