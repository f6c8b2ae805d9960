# SPDX-License-Identifier: GPL-3.0-or-later

"""Scans: oriented points to closed surfaces."""

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    ProgressCallback,
    as_int,
    as_name,
    as_number,
    as_progress,
    progress_part,
)
from .._border.arrays import as_array, as_floats, as_threads
from .._border.output import as_target
from .normals import estimate_normals, grid_normals, mesh_normals
from .scan_files import ScanPoints, open_points, read_faces, read_points, read_range_grid

Mesh: TypeAlias = tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]
MeshWithAttributes: TypeAlias = tuple[
    npt.NDArray[np.float64], npt.NDArray[np.int32], npt.NDArray[np.float32]
]


_LARGEST_VALUE = 1e30


@dataclass
class ReconstructionReport:
    """What a reconstruction found.

    Attributes:
        points: That there were.
        dropped: Of these, how many were left out: not finite, without a normal, or of no weight.
        outliers: The share of the others, by weight, that was left out because it lies much thinner
            than most: from 0 to 1.
        vertices: Of the mesh.
        triangles: Of the mesh.
        is_flipped: Most normals point inward; the opposite ones were used.
        residual: The mean distance of the samples from the local surface, in finest cells.
        cell: The side of a finest cell, in the points' units.
        is_spilled: Temporary files were needed.
    """

    points: int = 0
    dropped: int = 0
    outliers: float = 0.0
    vertices: int = 0
    triangles: int = 0
    is_flipped: bool = False
    residual: float = 0.0
    cell: float = 0.0
    is_spilled: bool = False


def reconstruct(
    points: npt.ArrayLike,
    normals: npt.ArrayLike | None = None,
    *,
    depth: int = 9,
    wavelet: str = "haar",
    smooth: bool = True,
    isovalue: str | float = "auto",
    fit: bool = True,
    trim: float | None = None,
    weights: npt.ArrayLike | None = None,
    attributes: npt.ArrayLike | None = None,
    memory_limit: int | None = None,
    report: ReconstructionReport | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> Mesh | MeshWithAttributes:
    """The closed surface that points with normals were taken from (chapter 4).

    The surface is where a function that is 1 inside and 0 outside takes an iso-value; its wavelet
    coefficients are sums over the points (equation 4.2). Points that are not finite (or are beyond
    1e300), have no normal or no weight are left out and counted. Points on a plane or a line bound
    nothing: the mesh is closed all the same, but may be a sheet without volume, whose triangles may
    have no area; with `trim` it ends where the points do.

    Args:
        points: (points, 3).
        normals: (points, 3), outward, of any length. None: estimated.
        depth: 1 to 12: the longest side of the cloud is 2^depth cells long, less a margin.
        wavelet: "haar", or "d4": more points count for each value, so the function is smoother; it
            takes about three times as long.
        smooth: The function is smoothed over neighbouring cells (section 4.3.1).
        isovalue: "auto" and "mean": the function's mean at the points. "half": 1/2. Or a number.
        fit: Vertices are moved onto the surface of the points around them.
        trim: Leaves out what is farther from all points than so many finest cells, above 0 and up
            to 1e6, so that the surface may end where the points do. None: the surface is closed.
        weights: (points,), how much each counts; 0 to 1e30. None: all count the same.
        attributes: (points, n), carried over to the vertices: colours, for example. Up to 1e30.
        memory_limit: In bytes, above what is passed in and returned; beyond it temporary files are
            used. None: no limit. With "d4" the cells of the surface stay in memory all the same.
        report: Is filled in.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        Positions (vertices, 3) float64 and triangles (triangles, 3) int32, counter-clockwise seen
        from outside; with `attributes` also those of the vertices, (vertices, n) float32. Untrimmed
        the mesh is closed and two-manifold.

    Raises:
        ValueError: A shape, type or value is wrong; fewer than 3 points count; all coincide.
        MemoryError: The result would not fit into memory.
        OSError: A temporary file could not be written.
        Cancelled: `progress` returned False.
    """
    if report is not None and not isinstance(report, ReconstructionReport):
        raise ValueError(f"report: {report!r}; a ReconstructionReport is needed, or None")
    rows = _as_rows("points", points)
    count = len(rows)
    given: npt.NDArray[np.floating]
    if normals is None:
        given = estimate_normals(rows, progress=progress_part(progress, 0.0, 0.5), threads=threads)
        progress = progress_part(progress, 0.5, 1.0)
    else:
        given = _as_rows("normals", normals)
    if len(given) != count:
        raise ValueError(f"normals: {len(given)} rows; {count} are needed, one for each point")
    values = None
    if attributes is not None:
        values = as_floats("attributes", attributes, (count, "n"), np.float32)
        _check_values("attributes", values, -_LARGEST_VALUE)
    counts = None
    if weights is not None:
        counts = as_floats("weights", weights, (count,), np.float32)
        _check_values("weights", counts, 0.0)
    source = _native.ArrayPoints(
        rows,
        given,
        counts,
        values,
        [] if values is None else [("", False)] * values.shape[1],
    )
    options = _options(
        depth, wavelet, smooth, isovalue, fit, trim, memory_limit, "", progress, threads
    )
    positions, triangles, carried, found = _native.reconstruct(source, options)
    if report is not None:
        _fill_in(report, found)
    return (positions, triangles) if attributes is None else (positions, triangles, carried)


def reconstruct_file(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    *,
    depth: int = 9,
    wavelet: str = "haar",
    smooth: bool = True,
    isovalue: str | float = "auto",
    fit: bool = True,
    trim: float | None = None,
    memory_limit: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> ReconstructionReport:
    """`reconstruct` from file to file, of clouds and meshes that may be larger than memory.

    Attributes of the points become properties of the vertices.

    Args:
        source: A file that `read_points` reads. Where it has no normals all points are read; a
            scanner's grid or faces in a PLY file tell the normals, or else they are estimated.
        target: A .ply file: binary, in double precision where the source is. Temporary files are
            made in its folder.
        depth: And all others: as `reconstruct` has them.
        wavelet: See there.
        smooth: See there.
        isovalue: See there.
        fit: See there.
        trim: See there.
        memory_limit: See there.
        progress: Called with the fraction done; returning False stops the work, and leaves a file
            that was there before as it was.
        threads: 0 means all processors. The result does not depend on it.

    Raises:
        ValueError: As `reconstruct`; or the source is damaged, or the target's ending is another.
        OSError: A file cannot be read or written.
        MemoryError: The points have no normals, and would not fit into memory.
        Cancelled: `progress` returned False.
    """
    place = as_target(target)
    if place.suffix.lower() != ".ply":
        raise ValueError(f"target: '{os.fspath(target)}'; a name that ends in .ply is needed")
    points = open_points(source)
    are_sides_known = False
    if not points.has_normals:
        read = read_points(source, progress=progress_part(progress, 0.0, 0.1))
        seen = _grid_normals(source, read, progress_part(progress, 0.1, 0.2))
        told = seen or _face_normals(source, read, progress_part(progress, 0.2, 0.3))
        normals, weights = told or (
            estimate_normals(
                read.positions,
                viewpoint=read.viewpoint,
                progress=progress_part(progress, 0.3, 0.5),
                threads=threads,
            ),
            read.weights,
        )
        points = _with_normals(points, replace(read, weights=weights), normals)
        # A scanner sees outsides. Faces may be inside out.
        are_sides_known = seen is not None or (told is None and read.viewpoint is not None)
        progress = progress_part(progress, 0.5, 1.0)
    folder = str(place.parent)
    options = _options(
        depth,
        wavelet,
        smooth,
        isovalue,
        fit,
        trim,
        memory_limit,
        folder,
        progress,
        threads,
        are_sides_known,
    )
    report = ReconstructionReport()
    _fill_in(report, _native.reconstruct_file(points, os.fsencode(place), options))
    return report


def file_normals(
    path: str | os.PathLike[str], read: ScanPoints, *, progress: ProgressCallback | None = None
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float32] | None] | None:
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


_Told: TypeAlias = tuple[npt.NDArray[np.float64], npt.NDArray[np.float32] | None]


def _is_ply(path: str | os.PathLike[str]) -> bool:
    return Path(os.fsdecode(path)).suffix.lower() == ".ply"


def _grid_normals(
    path: str | os.PathLike[str], read: ScanPoints, progress: ProgressCallback | None
) -> _Told | None:
    first, rest = progress_part(progress, 0.0, 0.5), progress_part(progress, 0.5, 1.0)
    grid = read_range_grid(path, progress=first) if _is_ply(path) else None
    if grid is None:
        return None
    normals, sureness = grid_normals(read.positions, grid, viewpoint=read.viewpoint, progress=rest)
    return normals, sureness if read.weights is None else sureness * read.weights


def _face_normals(
    path: str | os.PathLike[str], read: ScanPoints, progress: ProgressCallback | None
) -> _Told | None:
    if not _is_ply(path):
        return None
    first, rest = progress_part(progress, 0.0, 0.5), progress_part(progress, 0.5, 1.0)
    triangles = read_faces(path, progress=first)
    # A few faces are no mesh of the points.
    if len(np.unique(triangles)) <= len(read.positions) / 2:
        return None
    return mesh_normals(read.positions, triangles, progress=rest), read.weights


def _options(
    depth: int,
    wavelet: str,
    smooth: bool,
    isovalue: str | float,
    fit: bool,
    trim: float | None,
    memory_limit: int | None,
    folder: str,
    progress: ProgressCallback | None,
    threads: int,
    are_sides_known: bool = False,
) -> _native.ReconstructOptions:
    level: str | float
    if isinstance(isovalue, str):
        level = as_name("isovalue", isovalue)
    else:
        level = as_number("isovalue", isovalue)
    limit = None
    if memory_limit is not None:
        is_count = isinstance(memory_limit, int | np.integer) and not isinstance(memory_limit, bool)
        if not is_count or memory_limit < 0:
            raise ValueError(
                f"memory_limit: {memory_limit!r}; a number of bytes from 0 is needed, or None"
            )
        limit = min(int(memory_limit), 2**62)
    return _native.ReconstructOptions(
        as_int("depth", depth, "a whole number from 1 to 12 is needed"),
        as_name("wavelet", wavelet),
        bool(smooth),
        level,
        are_sides_known,
        bool(fit),
        None if trim is None else as_number("trim", trim),
        limit,
        os.fsencode(folder),
        as_progress(progress),
        as_threads(threads),
    )


def _with_normals(
    points: _native.PointSource, read: ScanPoints, normals: npt.NDArray[np.float64]
) -> _native.ArrayPoints:
    names = points.attributes
    columns = [read.attributes[name] for name, _ in names]
    values = np.stack(columns, axis=1).astype(np.float32) if columns else None
    return _native.ArrayPoints(read.positions, normals, read.weights, values, names)


def _fill_in(report: ReconstructionReport, found: dict[str, float]) -> None:
    for name, value in found.items():
        setattr(report, name, value)


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
