# SPDX-License-Identifier: GPL-3.0-or-later

"""Surfaces reconstructed from oriented points."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeAlias, cast

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
from .directions import AUTO, OUTWARD, Orientation, as_orientation
from .repairs import CONTRADICTORY, run_with_repairs
from .scan import AttributeArray
from .sources import Cloud, Source, array_cloud, joined_cloud, sources_in

_Positions: TypeAlias = npt.NDArray[np.float64]
_Triangles: TypeAlias = npt.NDArray[np.int32]
_Values: TypeAlias = npt.NDArray[np.float32]
_ByName: TypeAlias = dict[str, AttributeArray]
Support: TypeAlias = dict[str, npt.NDArray[np.float32]]

_MIB = 1 << 20
_MOST_MIB = 1 << 40
_NO_LIMIT = 2**64 - 1


@dataclass
class ReconstructionReport:
    """Findings of a reconstruction, for users.

    Attributes:
        points: Number of points read.
        dropped: Number of unusable points that were left out.
        causes: `dropped` by the first cause that applies: "not_finite", coordinates that are not
            numbers or exceed 1e300; "huge", coordinates from 1e30 on where most points have smaller
            ones; "weightless", zero weight; "normalless", no normal although none were estimated.
        phantoms: Positions that were left out because far more points share them exactly than lie
            around them, each with its number of points. Some scanners write 0, 0, 0 where nothing
            was returned.
        strays: Number of remaining points left out because they are at least about twice as far
            from the center as all others, and more than six standard deviations: at most one point
            in 100 000, or up to 3 of 1000 or more points.
        outliers: Share of the remaining points, by weight, left out because they lie in much
            sparser neighborhoods than most: 0 to 1.
        vertices: Number of vertices of the mesh.
        triangles: Number of triangles of the mesh.
        estimated: Number of given normals without a direction, which were estimated.
        contradiction: Share of pairs of neighboring points with given normals whose normals are
            opposed although the points are not on the two sides of a thin part: 0 to 1, about 1/2
            where normals are reversed at random.
        is_contradictory: Whether the contradiction exceeds a fifth.
        is_reoriented: Whether given normals were reoriented to match estimated ones because of the
            contradiction; they keep their axes where these agree with the points.
        origin: Role of the origin, where normals were estimated and nothing else shows their side:
            "scanner": the points were seen from there, and normals point there; "either": the
            scanner of a room or the center of an object, taken for the latter; "none".
        warnings: Oddities of the files; each warning names its file.
        directions: Directions of normals, each once, in the order of the sources: "given" where
            normals were kept; "up", "viewpoint", "outward": see `reconstruct`.
        is_flipped: Whether all normals were reversed, because most pointed inward and outward was
            asked for.
        is_room: Whether most normals point inward and were kept, as for a scanner inside a room.
        residual: Mean distance of the samples from the local surface, in finest cells.
        depth: Depth of the octree, as given or as derived from the points.
        cell: Side of a finest cell, in the points' units.
        float_step: Rounding step of coordinates that passed through single precision far from the
            origin before they came here, in the points' units. Such rounding merges points and
            gives surfaces stairs. 0 where it is less than a quarter of a cell.
        is_spilled: Whether temporary files were needed.
        cut: Share of the surface, by area, that was cut because no points support it: 0 to 1.
        islands: Number of small parts removed after the cut.
        island_share: Share of the surface, by area, in these parts.
        alignment: Motions that aligned the scans; None where they were not aligned.
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


class Reconstruction(tuple[Any, ...]):
    """A reconstructed surface; unpacks as (positions, triangles).

    Where `reconstruct` was called with `attributes`, these follow when unpacking, and then with
    `support=True` the support.

    Attributes:
        positions: (vertices, 3) float64.
        triangles: (triangles, 3) int32, counter-clockwise seen from outside.
        attributes: Attributes of the vertices: (vertices, n) float32 for an array of attributes;
            for files and scans an array per name, as in `ScanPoints`; None where there are none.
        support: Per-vertex support by the points; None unless asked for. "distance" (vertices,)
            float32: distance from the nearest points, in spacings of the points there, or in cells
            where these are larger. "density" (vertices,) float32: number of points per area.
        report: Findings of the reconstruction.
    """

    attributes: Any
    support: Support | None
    report: ReconstructionReport

    def __new__(
        cls,
        items: Iterable[Any],
        attributes: _Values | _ByName | None = None,
        support: Support | None = None,
        report: ReconstructionReport | None = None,
    ) -> "Reconstruction":
        """Takes the items to unpack, positions and triangles first, and the named results."""
        self = super().__new__(cls, items)
        self.attributes = attributes
        self.support = support
        self.report = report or ReconstructionReport()
        return self

    @property
    def positions(self) -> _Positions:
        return cast("_Positions", self[0])

    @property
    def triangles(self) -> _Triangles:
        return cast("_Triangles", self[1])


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
) -> Reconstruction:
    """Reconstructs the surface from which points with normals were sampled (chapter 4).

    The surface is an iso-surface of a function that is 1 inside and 0 outside; the function's
    wavelet coefficients are sums over the points (equation 4.2). Points that are not finite (or
    exceed 1e300) or have no weight are left out and counted, as are many points at one position;
    see `ReconstructionReport`. Points on a plane or a line enclose nothing: a closed mesh may then
    be a sheet without volume, with triangles without area.

    Args:
        points: (points, 3). Or a file that `read_points` reads, or `ScanPoints`, or a list of
            these, which are joined into one cloud: see `reconstruct_file`.
        normals: (points, 3), of any length, pointing out of the solid. None: estimated, or taken
            from the files and scans. Normals that are zero or not finite are estimated; normals
            that contradict each other over most of the surface are reoriented, unless `direction`
            says otherwise.
        depth: 1 to 12: the longest side of the cloud is 2^depth cells long, less a margin. None:
            the greatest depth at which half of the surface has a point per face of a cell.
        cell_size: Instead of a depth: the least depth at which cells are no larger than this.
        wavelet: "haar", or "d4": more points count for each value, so the function is smoother; it
            takes about three times as long.
        smooth: Whether the function is smoothed over neighboring cells (section 4.3.1).
        isovalue: "auto" or "mean": the mean of the function at the points. "half": 1/2. Or a
            number.
        fit: Whether vertices are moved onto the surface of the points around them.
        watertight: True: the surface is closed. False: the surface ends where the points do. It is
            cut where the distance to the nearest point exceeds 1.5 times the spacing of the points
            there (or 1.5 cells, if that is more); small separate parts are then removed. Holes up
            to 8 spacings wide are closed, and a cloud with points on all sides gets a closed
            surface.
        trim: Instead of that cut, with any `watertight`: removes triangles with a vertex farther
            than this from all points, in finest cells, above 0 and up to 1e6, whatever the spacing.
        adaptivity: How far enlarged triangles may deviate from the surface, in finest cells; 0: no
            triangle is enlarged. Remaining vertices keep their positions and attributes; detail of
            attributes between them, such as colors, is lost. Borders are kept, and with `support`
            also regions farther from all points than 1.5 times the spacing.
        direction: Where normals point. "given": as the points have them, whatever that encloses.
            "up": to larger z. "viewpoint": to the scanner, at `viewpoint` or where the file says,
            else at the origin. "outward": out of a closed surface: estimated normals agree with
            their neighbors, and all are reversed if most point inward. "auto": as given where
            points have normals; else to the viewpoint where it is known, or to the origin where the
            points were seen from there (see `estimate_normals`); else up for .las and .laz files
            and for height fields; else outward. The grid of a scanner in a PLY file faces the
            scanner.
        viewpoint: Position of the scanner, (3,), for each point, (points, 3), or for each of
            several sources, (sources, 3). Normals then point there.
        weights: (points,), how much each point counts, 0 to 1e30. None: all the same, or as files
            and scans say.
        attributes: (points, n), up to 1e30, interpolated at the vertices: colors, for example.
            True: those of files and scans, as the third item when the result is unpacked.
        support: Whether to measure each vertex's distance from the points and their density there,
            from which `trim` can cut the mesh later.
        classes: Classes of the points to use, for files and scans: see `choose_points`.
        returns: Returns of the points to use: see `choose_points`.
        box: Box of the points to use: see `choose_points`.
        align: Whether to move files and scans onto the first of them, as `align_scans` does.
            "scans" or "surface": against these; True is "scans".
        memory_limit: In MiB, beyond the arguments, the result and points without normals; above it
            temporary files are used. It holds within a tenth and 8 MiB. A limit that is too low is
            refused with the least possible one: the cells of a few layers of the octree, or with
            "d4" all cells of the surface. 0: that least limit. None: no limit.
        report: A report to fill in, which is then the result's `report`. None: a new one.
        progress: Called with the fraction done; returning False stops the work.
        threads: 0 means all processors. The result does not depend on it.

    Returns:
        A `Reconstruction`, which unpacks as (positions, triangles), followed by the attributes and
        the support if asked for. Unless `trim` was given, the mesh is two-manifold, and closed if
        it is watertight.

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
    orientation = as_orientation(direction, viewpoint)
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

    def build(faults: frozenset[str], progress: ProgressCallback | None) -> Cloud:
        if sources is not None:
            return joined_cloud(
                sources, orientation, progress, threads, choice, against, faults=faults
            )
        rows = cast("npt.ArrayLike", points)
        return array_cloud(
            rows, normals, weights, attributes, orientation, progress, threads, faults
        )

    def extract(cloud: Cloud, progress: ProgressCallback | None) -> tuple[Any, dict[str, Any]]:
        *mesh, findings = _native.reconstruct(cloud.points, options, as_progress(progress))
        return mesh, findings

    (positions, triangles, carried), findings, cloud = _run(
        build, extract, orientation, options, progress
    )
    report = report or ReconstructionReport()
    fill_in(report, findings, cloud)
    items = [positions, triangles]
    measures: Support | None = None
    if options.support:
        measures = {"distance": carried[:, -2].copy(), "density": carried[:, -1].copy()}
        carried = np.ascontiguousarray(carried[:, :-2])
    values: _Values | _ByName | None = None
    if sources is not None and attributes is not False:
        values = _columns(carried, cloud.points.attributes)
    elif attributes is not None and attributes is not False:
        values = carried
    if attributes is not None and attributes is not False:
        items.append(values)
    if measures is not None:
        items.append(measures)
    return Reconstruction(items, values, measures, report)


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
    """Reconstructs from files to a file; neither points nor mesh have to fit into memory.

    Attributes of the points become properties of the vertices, followed by "distance" and
    "density", the support that `reconstruct` returns. Several sources make one cloud, with the
    union of their attributes by name; a missing attribute is 0, or white for a color.

    Args:
        source: A file that `read_points` reads, or `ScanPoints`, or a list of these. Sources
            without normals are read into memory, and so are all where given normals are incomplete
            or contradict each other. Normals then come from the grid of a scanner or the faces in a
            PLY file, or are estimated: for each scan with a known viewpoint separately, for all
            others together.
        target: A .ply file: binary, in double precision where a source is. Temporary files are
            made in its folder.
        depth: As for `reconstruct`, like all that follow.
        cell_size: See `reconstruct`.
        wavelet: See `reconstruct`.
        smooth: See `reconstruct`.
        isovalue: See `reconstruct`.
        fit: See `reconstruct`.
        watertight: See `reconstruct`.
        trim: See `reconstruct`.
        adaptivity: See `reconstruct`.
        direction: See `reconstruct`.
        viewpoint: See `reconstruct`.
        classes: See `reconstruct`.
        returns: See `reconstruct`.
        box: See `reconstruct`.
        align: See `reconstruct`.
        memory_limit: See `reconstruct`.
        progress: Called with the fraction done; returning False stops the work, and an existing
            target is left unchanged.
        threads: See `reconstruct`.

    Raises:
        ValueError: As `reconstruct`; or a source is damaged, or the target is not a .ply file.
        OSError: A file cannot be read or written.
        MemoryError: Points have no normals, and would not fit into memory.
        Cancelled: `progress` returned False.
    """
    options = set_options(_native.ReconstructOptions(), CHECKS, locals())
    output = as_target(target)
    if output.suffix.lower() != ".ply":
        raise ValueError(f"target: '{os.fspath(target)}'; a name that ends in .ply is needed")
    options.folder = os.fsencode(output.parent)
    options.support = True
    orientation = as_orientation(direction, viewpoint)
    # Opening refuses anything that is neither a path nor a source.
    sources = sources_in(source) or [cast("Source", source)]
    choice = as_choice(classes, returns, box)
    against = _as_against(align)
    report = ReconstructionReport()
    recover(output.parent)

    def build(faults: frozenset[str], progress: ProgressCallback | None) -> Cloud:
        return joined_cloud(sources, orientation, progress, threads, choice, against, faults=faults)

    def write(cloud: Cloud, progress: ProgressCallback | None) -> tuple[None, dict[str, Any]]:
        path = os.fsencode(output)
        return None, _native.reconstruct_file(cloud.points, path, options, as_progress(progress))

    _, findings, cloud = _run(build, write, orientation, options, progress)
    fill_in(report, findings, cloud)
    return report


def _run(
    build: Callable[[frozenset[str], ProgressCallback | None], Cloud],
    extract: Callable[[Cloud, ProgressCallback | None], tuple[Any, dict[str, Any]]],
    orientation: Orientation,
    options: _native.ReconstructOptions,
    progress: ProgressCallback | None,
) -> tuple[Any, dict[str, Any], Cloud]:
    """Builds a cloud and extracts its surface, again after a repair if given normals are faulty."""

    contradiction = 0.0

    def run(
        faults: frozenset[str], is_checked: bool, progress: ProgressCallback | None
    ) -> tuple[tuple[Any, dict[str, Any], Cloud], dict[str, Any]]:
        keeps_sides = orientation.direction not in (AUTO, OUTWARD)
        cloud = build(faults - {CONTRADICTORY} if keeps_sides else faults, progress)
        options.are_sides_known = cloud.are_sides_known
        options.check_normals = is_checked and cloud.has_given
        mesh, findings = extract(cloud, cloud.remaining_progress(progress))
        nonlocal contradiction
        findings["contradiction"] = contradiction = max(contradiction, findings["contradiction"])
        findings["is_contradictory"] = CONTRADICTORY in faults
        return (mesh, findings, cloud), findings

    return run_with_repairs(run, progress)


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
    """Raises ValueError for arrays beside files and scans, which have their own."""
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
    """Vertex attributes by name, rounded to bytes where the points have bytes."""
    return {
        name: np.clip(np.rint(column), 0, 255).astype(np.uint8) if is_byte else column.copy()
        for (name, is_byte), column in zip(names, carried.T, strict=True)
    }


def _check_report(report: ReconstructionReport | None) -> None:
    if report is not None and not isinstance(report, ReconstructionReport):
        raise ValueError(f"report: {report!r}; a ReconstructionReport is needed, or None")


def fill_in(report: ReconstructionReport, findings: Mapping[str, object], cloud: Cloud) -> None:
    """Copies the findings of the native module and of the cloud into a report."""
    report.directions = cloud.directions
    report.alignment = cloud.alignment
    report.origin = cloud.origin
    report.estimated = cloud.estimated
    report.is_reoriented = cloud.is_reoriented
    for name, value in findings.items():
        if name != "normal_fault":
            setattr(report, name, value)
    report.phantoms = tuple(report.phantoms)
    report.warnings = tuple(dict.fromkeys((*cloud.warnings, *cloud.points.warnings)))
