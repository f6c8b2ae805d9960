# SPDX-License-Identifier: GPL-3.0-or-later

"""Scans: oriented points to surfaces."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal, TypeAlias, TypedDict, Unpack, cast, overload

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    as_int,
    as_name,
    as_number,
    as_one_of,
    as_progress,
    set_options,
)
from .._border.arrays import as_threads
from .._border.names import Direction, Returns, Wavelet
from ..files.replacing import recover
from ..files.staging import as_target
from .alignment import ScanAlignment
from .choice import Classes, as_choice
from .clouds import AGAINST, SCANS
from .directions import AUTO, OUTWARD, Wanted, as_wanted
from .repairs import CONTRADICTORY, run_until_sound
from .scan import AttributeArray
from .sources import Cloud, Source, array_cloud, joined_cloud, sources_in

_Positions: TypeAlias = npt.NDArray[np.float64]
_Triangles: TypeAlias = npt.NDArray[np.int32]
_Values: TypeAlias = npt.NDArray[np.float32]
_ByName: TypeAlias = dict[str, AttributeArray]
Support: TypeAlias = dict[str, npt.NDArray[np.float32]]
Mesh: TypeAlias = tuple[_Positions, _Triangles]
MeshWithAttributes: TypeAlias = tuple[_Positions, _Triangles, _Values | _ByName]
MeshWithSupport: TypeAlias = (
    tuple[_Positions, _Triangles, Support]
    | tuple[_Positions, _Triangles, _Values | _ByName, Support]
)

_MIB = 1 << 20
_MOST_MIB = 1 << 40
_NO_LIMIT = 2**64 - 1


@dataclass
class ReconstructionReport:
    """What a reconstruction found.

    Attributes:
        points: That there were.
        dropped: Of these, how many were left out, as they tell nothing.
        causes: The same by the first cause that holds: "not_finite", coordinates that are no
            numbers or beyond 1e300; "huge", coordinates from 1e30 on where those of most are not;
            "weightless", of no weight; "normalless", without a normal, where it was not estimated.
        phantoms: Positions, each with the number of its points, that were left out too: many more
            points are at exactly one position than at those around it, as where a scanner writes
            0, 0, 0 for no return.
        strays: How many of the others were left out, because they are at least about twice as far
            from the middle as the rest, and more than six standard deviations: one point in 100 000
            at most, and of 1000 or more up to 3.
        outliers: The share of the others, by weight, that was left out because it lies much thinner
            than most: from 0 to 1.
        vertices: Of the mesh.
        triangles: Of the mesh.
        estimated: How many given normals have no direction, and were estimated.
        contradiction: Of pairs of near points with given normals, the share whose normals are
            opposed without being on the two sides of a thin part: 0 to 1, about 1/2 where normals
            are reversed by chance.
        is_contradictory: That is over a fifth.
        is_reoriented: Given normals were turned for that: as those that are estimated point, along
            the given ones' lines where these agree with the points.
        origin: What the origin is to the points, where normals were estimated and nothing else said
            where they point: "scanner": they were seen from there, and normals point there;
            "either": a scanner in a room or the middle of an object, of which the latter was taken;
            "none".
        warnings: What is odd about the files; each names one.
        directions: Where normals point, each once, in the order of the sources: "given": as points
            have them; "up", "viewpoint", "outward": see `reconstruct`.
        is_flipped: Most normals pointed inward, and were to point outward; the opposite ones were
            used.
        is_room: Most normals point inward, and were kept: as where a scanner stood in a room.
        residual: The mean distance of the samples from the local surface, in finest cells.
        depth: Of the octree: the one that was given, or that the points carry.
        cell: The side of a finest cell, in the points' units.
        float_step: What single precision has rounded the coordinates to before they came here, far
            from the origin, in the points' units: points are merged, and surfaces get stairs. 0
            where that is less than a quarter of a cell.
        is_spilled: Temporary files were needed.
        cut: The share of the surface, by area, that was cut because no points support it: from 0
            to 1.
        islands: How many small parts were then left out.
        island_share: Their share of the surface.
        alignment: How scans were moved onto each other; None where they were not.
    """

    points: int = 0
    dropped: int = 0
    causes: dict[str, int] = field(default_factory=dict)
    phantoms: tuple[tuple[tuple[float, float, float], int], ...] = ()
    strays: int = 0
    outliers: float = 0.0
    vertices: int = 0
    triangles: int = 0
    estimated: int = 0
    contradiction: float = 0.0
    is_contradictory: bool = False
    is_reoriented: bool = False
    origin: str = "none"
    warnings: tuple[str, ...] = ()
    directions: tuple[str, ...] = ()
    is_flipped: bool = False
    is_room: bool = False
    residual: float = 0.0
    depth: int = 0
    cell: float = 0.0
    float_step: float = 0.0
    is_spilled: bool = False
    cut: float = 0.0
    islands: int = 0
    island_share: float = 0.0
    alignment: ScanAlignment | None = None


class _Choices(TypedDict, total=False):
    """What `reconstruct` takes by name, beside what its result's type depends on."""

    depth: int | None
    cell_size: float | None
    wavelet: Wavelet
    smooth: bool
    isovalue: str | float
    fit: bool
    watertight: bool
    trim: float | None
    adaptivity: float
    direction: Direction
    viewpoint: npt.ArrayLike | None
    weights: npt.ArrayLike | None
    classes: Classes | None
    returns: Returns
    box: npt.ArrayLike | None
    align: bool | str
    memory_limit: int | None
    report: ReconstructionReport | None
    progress: ProgressCallback | None
    threads: int


@overload
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    attributes: Literal[False] | None = None,
    support: Literal[False] = False,
    **choices: Unpack[_Choices],
) -> Mesh: ...
@overload
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    attributes: Literal[False] | None = None,
    support: Literal[True],
    **choices: Unpack[_Choices],
) -> tuple[_Positions, _Triangles, Support]: ...
@overload
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    attributes: Literal[True],
    support: Literal[False] = False,
    **choices: Unpack[_Choices],
) -> tuple[_Positions, _Triangles, _ByName]: ...
@overload
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    attributes: Literal[True],
    support: Literal[True],
    **choices: Unpack[_Choices],
) -> tuple[_Positions, _Triangles, _ByName, Support]: ...
@overload
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    attributes: npt.NDArray[Any] | Sequence[Any],
    support: Literal[False] = False,
    **choices: Unpack[_Choices],
) -> tuple[_Positions, _Triangles, _Values]: ...
@overload
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    attributes: npt.NDArray[Any] | Sequence[Any],
    support: Literal[True],
    **choices: Unpack[_Choices],
) -> tuple[_Positions, _Triangles, _Values, Support]: ...
@overload
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    attributes: npt.ArrayLike | bool | None = None,
    support: bool = False,
    **choices: Unpack[_Choices],
) -> Mesh | MeshWithAttributes | MeshWithSupport: ...
def reconstruct(
    points: npt.ArrayLike | Source | Sequence[Source],
    normals: npt.ArrayLike | None = None,
    *,
    depth: int | None = None,
    cell_size: float | None = None,
    wavelet: Wavelet = "haar",
    smooth: bool = True,
    isovalue: str | float = "auto",
    fit: bool = True,
    watertight: bool = False,
    trim: float | None = None,
    adaptivity: float = 0.0,
    direction: Direction = "auto",
    viewpoint: npt.ArrayLike | None = None,
    weights: npt.ArrayLike | None = None,
    attributes: npt.ArrayLike | bool | None = None,
    support: bool = False,
    classes: Classes | None = None,
    returns: Returns = "all",
    box: npt.ArrayLike | None = None,
    align: bool | str = False,
    memory_limit: int | None = None,
    report: ReconstructionReport | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> Mesh | MeshWithAttributes | MeshWithSupport:
    """The surface that points with normals were taken from (chapter 4).

    The surface is where a function that is 1 inside and 0 outside takes an iso-value; its wavelet
    coefficients are sums over the points (equation 4.2). Points that are not finite (or are beyond
    1e300), or have no weight, are left out and counted, as are many at one position; see
    `ReconstructionReport`. Points on a plane or a line bound nothing: a closed mesh may be a sheet
    without volume, whose triangles may have no area.

    Args:
        points: (points, 3). Or a file that `read_points` reads, or `ScanPoints`, or a list of
            these, which are put together as one cloud: see `reconstruct_file`.
        normals: (points, 3), of any length: to where there is nothing. None: estimated, or those of
            files and scans. Those that are zero or no numbers are estimated; where they contradict
            each other over most of the surface, they are turned, unless `direction` says otherwise.
        depth: 1 to 12: the longest side of the cloud is 2^depth cells long, less a margin. None:
            the greatest at which half of the surface has a point for each face of a cell, or more.
        cell_size: In place of a depth: the least one at which cells have no longer sides.
        wavelet: "haar", or "d4": more points count for each value, so the function is smoother; it
            takes about three times as long.
        smooth: The function is smoothed over neighboring cells (section 4.3.1).
        isovalue: "auto" and "mean": the function's mean at the points. "half": 1/2. Or a number.
        fit: Vertices are moved onto the surface of the points around them.
        watertight: The surface is closed. False: it is open where the points are: what is farther
            from all of them than 1.5 times their spacing there, or 1.5 cells where that is more, is
            cut, and then parts that are small beside the spacing go. Holes that are up to 8
            spacings wide are closed all the same, and a cloud that has points all around has a
            closed surface.
        trim: In place of that, whatever `watertight` says: leaves out triangles with a vertex that
            is farther from all points than so many finest cells, above 0 and up to 1e6, however far
            points are from one another.
        adaptivity: How far triangles that are made larger may leave the surface, in finest cells;
            0: none is. Vertices that stay keep their places and attributes; what others had between
            them, such as colors, is lost. Borders stay as they are; and, with `support`, so does
            what is farther from all points than 1.5 times their spacing.
        direction: Where normals point. "given": as points have them, whatever that encloses. "up":
            to where z is larger. "viewpoint": to where the scanner stood, as `viewpoint` or the
            file says, or else to the origin. "outward": as those of a closed surface: those that
            are estimated agree with those around them, and all are reversed if most point inward.
            "auto": as given where points have normals; else to the viewpoint where that is known,
            or to the origin where that is what the points were seen from (see `estimate_normals`);
            else up for .las and .laz files, and for height fields (see `estimate_normals`); else
            outward. A scanner's grid in a PLY file faces the scanner.
        viewpoint: Where the scanner stood, (3,); or one place for each point, (points, 3), or for
            each of several sources, (sources, 3). Normals then point there.
        weights: (points,), how much each counts; 0 to 1e30. None: all count the same, or as files
            and scans say.
        attributes: (points, n), carried over to the vertices: colors, for example. Up to 1e30.
            True: those of files and scans.
        support: Tells of each vertex how far it is from the points, and how dense these are there,
            so that `trim` can cut the mesh elsewhere.
        classes: Which points of files and scans to use, as `choose_points` has it; also what
            follows.
        returns: See there.
        box: See there.
        align: Files and scans are moved onto the first of them, as by `align_scans`. "scans" and
            "surface": against these; True is "scans".
        memory_limit: In MiB, above what is passed in and returned, points without normals among
            that; beyond it temporary files are used. It holds within a tenth and 8 MiB. What is
            less than needed is refused, with the least that would do: the cells of a few layers of
            the octree, with "d4" all cells of the surface. 0: that least. None: no limit.
        report: Is filled in.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        Positions (vertices, 3) float64 and triangles (triangles, 3) int32, counter-clockwise seen
        from outside. With `attributes` also those of the vertices: (vertices, n) float32, or for
        files and scans an array for each name, as `ScanPoints` has them. With `support` also a
        dictionary: "distance" (vertices,) float32, from the nearest points in spacings of those
        around, or in cells where these are larger; and "density" (vertices,) float32, the points to
        an area. Unless `trim` was given, the mesh is two-manifold, and closed if it is watertight.

    Raises:
        ValueError: A shape, type or value is wrong; fewer than 3 points count; all coincide; an
            iso-value or a trim leaves nothing; no point is near the surface; the memory limit is
            too low.
        MemoryError: The result would not fit into memory.
        OSError: A file cannot be read, or a temporary one not written.
        Cancelled: `progress` returned False.
    """
    options = set_options(_native.ReconstructOptions(), CHECKS, locals())
    options.support = bool(support)
    _check_report(report)
    wanted = as_wanted(direction, viewpoint)
    choice = as_choice(classes, returns, box)
    against = _as_against(align)
    sources = sources_in(points)
    if sources is None:
        if choice is not None or against is not None:
            raise ValueError(
                "classes, returns, box, align: given beside arrays; they are for files and scans"
            )
    else:
        _check_sources(normals, weights, attributes)

    def build(faults: frozenset[str], told: ProgressCallback | None) -> Cloud:
        if sources is not None:
            return joined_cloud(sources, wanted, told, threads, choice, against, faults=faults)
        rows = cast("npt.ArrayLike", points)
        return array_cloud(rows, normals, weights, attributes, wanted, told, threads, faults)

    def make(cloud: Cloud, told: ProgressCallback | None) -> tuple[Any, dict[str, Any]]:
        *mesh, found = _native.reconstruct(cloud.points, options, as_progress(told))
        return mesh, found

    (positions, triangles, carried), found, cloud = _made(build, make, wanted, options, progress)
    fill_in(report, found, cloud)
    told: Support = {}
    if options.support:
        told = {"distance": carried[:, -2].copy(), "density": carried[:, -1].copy()}
        carried = np.ascontiguousarray(carried[:, :-2])
    if attributes is None or attributes is False:
        return (positions, triangles, told) if support else (positions, triangles)
    by_name = None if sources is None else _columns(carried, cloud.points.attributes)
    kept = carried if by_name is None else by_name
    return (positions, triangles, kept, told) if support else (positions, triangles, kept)


def reconstruct_file(
    source: Source | Sequence[Source],
    target: str | os.PathLike[str],
    *,
    depth: int | None = None,
    cell_size: float | None = None,
    wavelet: Wavelet = "haar",
    smooth: bool = True,
    isovalue: str | float = "auto",
    fit: bool = True,
    watertight: bool = False,
    trim: float | None = None,
    adaptivity: float = 0.0,
    direction: Direction = "auto",
    viewpoint: npt.ArrayLike | None = None,
    classes: Classes | None = None,
    returns: Returns = "all",
    box: npt.ArrayLike | None = None,
    align: bool | str = False,
    memory_limit: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> ReconstructionReport:
    """`reconstruct` from files to a file, of clouds and meshes that may be larger than memory.

    Attributes of the points become properties of the vertices; "distance" and "density" follow,
    as `reconstruct` has them with `support`. Several sources make one cloud,
    which has all attributes that one of them has, by name; points of the others have 0 for it, or
    white for a color.

    Args:
        source: A file that `read_points` reads, or `ScanPoints`, or a list of these. The points of
            those that have no normals are read into memory, and all points where given normals are
            missing in part or contradict each other; a scanner's grid or faces in a PLY file
            tell the normals, or else they are estimated: of scans that were seen from a known place
            each by itself, of all others together.
        target: A .ply file: binary, in double precision where a source is. Temporary files are
            made in its folder.
        depth: And all options that follow, but for `progress`: as `reconstruct` has them.
        cell_size: See there.
        wavelet: See there.
        smooth: See there.
        isovalue: See there.
        fit: See there.
        watertight: See there.
        trim: See there.
        adaptivity: See there.
        direction: See there.
        viewpoint: See there.
        classes: See there.
        returns: See there.
        box: See there.
        align: See there.
        memory_limit: See there.
        progress: Called with the fraction done; returning False stops the work, and leaves a file
            that was there before as it was.
        threads: See there.

    Raises:
        ValueError: As `reconstruct`; or a source is damaged, or the target's ending is another.
        OSError: A file cannot be read or written.
        MemoryError: Points have no normals, and would not fit into memory.
        Cancelled: `progress` returned False.
    """
    options = set_options(_native.ReconstructOptions(), CHECKS, locals())
    place = as_target(target)
    if place.suffix.lower() != ".ply":
        raise ValueError(f"target: '{os.fspath(target)}'; a name that ends in .ply is needed")
    options.folder = os.fsencode(place.parent)
    options.support = True
    # What is no list of sources is refused as a path.
    wanted = as_wanted(direction, viewpoint)
    sources = sources_in(source) or [cast("Source", source)]
    choice = as_choice(classes, returns, box)
    against = _as_against(align)
    report = ReconstructionReport()
    recover(place.parent)

    def build(faults: frozenset[str], told: ProgressCallback | None) -> Cloud:
        return joined_cloud(sources, wanted, told, threads, choice, against, faults=faults)

    def make(cloud: Cloud, told: ProgressCallback | None) -> tuple[None, dict[str, Any]]:
        target_name = os.fsencode(place)
        found = _native.reconstruct_file(cloud.points, target_name, options, as_progress(told))
        return None, found

    _, found, cloud = _made(build, make, wanted, options, progress)
    fill_in(report, found, cloud)
    return report


def _made(
    build: Callable[[frozenset[str], ProgressCallback | None], Cloud],
    make: Callable[[Cloud, ProgressCallback | None], tuple[Any, dict[str, Any]]],
    wanted: Wanted,
    options: _native.ReconstructOptions,
    progress: ProgressCallback | None,
) -> tuple[Any, dict[str, Any], Cloud]:
    """Builds a cloud and makes its surface; both again where given normals have faults."""

    contradiction = 0.0

    def run(
        faults: frozenset[str], is_checked: bool, told: ProgressCallback | None
    ) -> tuple[tuple[Any, dict[str, Any], Cloud], dict[str, Any]]:
        is_kept = wanted.direction not in (AUTO, OUTWARD)
        cloud = build(faults - {CONTRADICTORY} if is_kept else faults, told)
        options.are_sides_known = cloud.are_sides_known
        options.check_normals = is_checked and cloud.has_given
        mesh, found = make(cloud, cloud.rest(told))
        nonlocal contradiction
        found["contradiction"] = contradiction = max(contradiction, found["contradiction"])
        found["is_contradictory"] = CONTRADICTORY in faults
        return (mesh, found, cloud), found

    return run_until_sound(run, progress)


def _as_against(align: bool | str) -> str | None:
    if isinstance(align, str):
        return as_one_of("align", align, AGAINST)
    return SCANS if align else None


def _as_isovalue(isovalue: str | float) -> str | float:
    if isinstance(isovalue, str):
        return as_name("isovalue", isovalue)
    return as_number("isovalue", isovalue)


def _as_number_or_none(argument: str, number: float | None) -> float | None:
    return None if number is None else as_number(argument, number)


def _as_depth(depth: int | None) -> int | None:
    return (
        None if depth is None else as_int("depth", depth, "a whole number from 1 to 12 is needed")
    )


def _as_bytes(memory_limit: int | None) -> int:
    if memory_limit is None:
        return _NO_LIMIT
    is_count = isinstance(memory_limit, int | np.integer) and not isinstance(memory_limit, bool)
    if not is_count or memory_limit < 0:
        raise ValueError(
            f"memory_limit: {memory_limit!r}; a number of MiB from 0 is needed, or None"
        )
    return min(int(memory_limit), _MOST_MIB) * _MIB


CHECKS: dict[str, Check] = {
    "depth": _as_depth,
    "cell_size": partial(_as_number_or_none, "cell_size"),
    "wavelet": partial(as_name, "wavelet"),
    "smooth": bool,
    "isovalue": _as_isovalue,
    "fit": bool,
    "watertight": bool,
    "trim": partial(_as_number_or_none, "trim"),
    "adaptivity": partial(as_number, "adaptivity"),
    "memory_limit": _as_bytes,
    "threads": as_threads,
}


def _check_sources(normals: object, weights: object, attributes: object) -> None:
    """Refuses arrays beside files and scans, which have their own."""
    for name, value in (("normals", normals), ("weights", weights)):
        if value is not None:
            raise ValueError(
                f"{name}: given beside files or scans, which have their own; None is needed"
            )
    if attributes is not None and not isinstance(attributes, bool):
        raise ValueError(
            "attributes: given beside files or scans, which have their own; True or None is needed"
        )


def _columns(
    carried: npt.NDArray[np.float32], names: Sequence[tuple[str, bool]]
) -> dict[str, AttributeArray]:
    """The attributes of vertices by name: rounded to bytes where the points have bytes."""
    return {
        name: np.clip(np.rint(column), 0, 255).astype(np.uint8) if is_byte else column.copy()
        for (name, is_byte), column in zip(names, carried.T, strict=True)
    }


def _check_report(report: ReconstructionReport | None) -> None:
    if report is not None and not isinstance(report, ReconstructionReport):
        raise ValueError(f"report: {report!r}; a ReconstructionReport is needed, or None")


def fill_in(report: ReconstructionReport | None, found: Mapping[str, object], cloud: Cloud) -> None:
    if report is None:
        return
    report.directions = cloud.directions
    report.alignment = cloud.alignment
    report.origin = cloud.origin
    report.estimated = cloud.estimated
    report.is_reoriented = cloud.is_reoriented
    for name, value in found.items():
        if name != "normal_fault":
            setattr(report, name, value)
    report.phantoms = tuple(report.phantoms)
    report.warnings = tuple(dict.fromkeys((*cloud.warnings, *cloud.points.warnings)))
