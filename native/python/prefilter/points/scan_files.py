# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of points, as scanners and their programs write them."""

import os
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_int, as_progress, progress_part
from .._border.arrays import as_floats
from .._border.input import as_path
from .choice import Classes, as_choice
from .e57 import E57Reader
from .las import LasReader
from .packed import PACKED, unpacked
from .reader import PointReader
from .scan import ScanPoints

_READERS: dict[str, Callable[[str], PointReader]] = {
    ".las": LasReader,
    ".laz": LasReader,
    ".e57": E57Reader,
}
_FROM_ABOVE = frozenset({".las", ".laz"})
_PACKED_PLY = f".ply{PACKED}"
POINT_EXTENSIONS = (*_native.POINT_EXTENSIONS, _PACKED_PLY, *_READERS)
"""What the names of files of points end in."""

_UNLIMITED = 2**62


def read_points(
    path: str | os.PathLike[str],
    *,
    most: int | None = None,
    classes: Classes | None = None,
    returns: str = "all",
    box: npt.ArrayLike | None = None,
    progress: ProgressCallback | None = None,
) -> ScanPoints:
    """Reads the points of a file; its ending says of which format it is.

    .ply, .ply.gz, .pcd: nx, ny, nz (or normal_x and so on) are normals, confidence is the weight;
    all other numbers are attributes. Gaussian splats have the shortest axis of each as its normal,
    turned outward, and its opacity as its weight. VIEWPOINT of a .pcd file is the viewpoint, except
    for the origin in a cloud that is no image: it stands there, too, where nothing is known.
    .xyz, .xyzn, .pts, .asc, .txt, .csv: lines of x y z, and then a normal, a color, an intensity;
    which of these the columns are is told from the first thousands of lines, or by names in the
    first.
    .obj: vertices, with the file's normals where there are as many, and with colors behind x y z.
    .ptx: scans one after the other, with intensities and perhaps colors, placed by their matrices;
    the viewpoint of each point is that of its scan.
    .laz: needs the Python package lazrs, which the extension for Blender brings along.
    .e57: all scans are read, in the file's coordinates. The places of their poses are the
    viewpoint, and without a pose the origin of a scan that still is a scanner's grid.

    Colors are bytes, also of files that have 16 bits. What a class and returns are called is told
    by their names in any spelling: "classification", "return_number" and "number_of_returns".

    Args:
        path: Of the file.
        most: At most so many points are kept: each second one, or third, and so on, so that the
            rest never has to fit into memory. None keeps all. Of chosen points that is one of a
            power of two, as their number is not known before.
        classes: See `choose_points`, also for what follows: other points are left out.
        returns: See there.
        box: See there.
        progress: Called with the fraction done; returning False stops the work.

    Raises:
        ValueError: The extension is another, a value is not allowed, a package is missing, the
            file does not tell classes or returns, or it is damaged; the message names the line or
            the point.
        OSError: The file cannot be read.
        MemoryError: The points would not fit into memory.
        Cancelled: `progress` returned False.
    """
    limit = _UNLIMITED
    if most is not None:
        limit = as_int("most", most, "a whole number above 0 is needed")
        if limit <= 0:
            raise ValueError(f"most: {most}; a whole number above 0 is needed")
    choice = as_choice(classes, returns, box)
    source = open_points(path, progress=progress_part(progress, 0.0, 0.2))
    if choice is not None:
        source = choice.of_file(source, os.fsdecode(path))
    last = 0.5 if is_undirected(source) else 1.0
    try:
        positions, normals, weights, viewpoint, attributes, stride = _native.read_points(
            source, limit, progress_part(progress, 0.2, last)
        )
    except MemoryError as error:
        raise MemoryError(f"'{os.fsdecode(path)}': {_told(error)}") from error
    if is_undirected(source):
        rest = progress_part(progress, 0.5, 1.0)
        normals = _directed(positions, normals, rest)
    if viewpoint is None and source.viewpoint is not None:
        viewpoint = np.array(source.viewpoint)
    above = is_from_above(path)
    return ScanPoints(
        positions,
        normals,
        weights,
        attributes,
        viewpoint,
        stride,
        above,
        tuple(dict.fromkeys(source.warnings)),
    )


def is_from_above(path: str | os.PathLike[str]) -> bool:
    """Whether a file is of a format in which mostly points are that were seen from the air."""
    return os.path.splitext(as_path(path))[1].lower() in _FROM_ABOVE


def float_step(positions: npt.ArrayLike) -> float:
    """What single precision has rounded coordinates to before they came here.

    Its numbers are a step apart that grows with their distance from 0: 1/2 for a northing of five
    million. Points that are nearer to each other than that are merged.

    Args:
        positions: (points, 3). Values that are not finite do not count.

    Returns:
        The largest step along an axis whose coordinates have been rounded, in their units; 0 where
        all have more digits than single precision, or need fewer.

    Raises:
        ValueError: The shape or type is wrong.
    """
    return _native.float_step(as_floats("positions", positions, ("points", 3), np.float64))


def _told(error: MemoryError) -> str:
    """What an error says, where it is not one of the system, which says nothing."""
    text = str(error)
    return "its points do not fit into memory" if not text or "bad_alloc" in text else text


def is_undirected(source: _native.PointSource) -> bool:
    """Whether points have normals that may point inward."""
    return source.has_normals and not source.are_normals_directed


def _directed(
    positions: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float32] | None,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32] | None:
    if normals is None or len(normals) == 0:
        return normals
    found = _native.directed_normals(positions, normals.astype(np.float64), progress, 0)
    return found.astype(np.float32)


def open_points(
    path: str | os.PathLike[str], *, progress: ProgressCallback | None = None
) -> _native.PointSource:
    """Opens a file for functions of the native module that read it piece by piece."""
    name = as_path(path)
    ending = point_extension(name)
    if ending in _READERS:
        return _native.PointSource(_READERS[ending](name))
    if ending == _PACKED_PLY:
        return _native.open_ply(unpacked(name, progress))
    if ending not in POINT_EXTENSIONS:
        raise ValueError(
            f"'{name}': unsupported extension '{ending}'; use {', '.join(POINT_EXTENSIONS)}"
        )
    return _native.open_points(os.fsencode(name))


def point_extension(path: str | os.PathLike[str]) -> str:
    """What the name of a file ends in, in lower case: with what comes before ".gz"."""
    stem, ending = os.path.splitext(os.fsdecode(path).lower())
    return os.path.splitext(stem)[1] + ending if ending == PACKED else ending


def is_ply(path: str | os.PathLike[str]) -> bool:
    """Whether a file is called a PLY file, perhaps packed."""
    return point_extension(path) in (".ply", _PACKED_PLY)


def read_range_grid(
    path: str | os.PathLike[str], *, progress: ProgressCallback | None = None
) -> npt.NDArray[np.int64] | None:
    """Reads the grid in which a scanner saw the points of a PLY file, its element "range_grid".

    Returns:
        (rows, columns) indices of points, -1 where the scanner saw nothing; None where the file has
        no grid.

    Raises:
        ValueError: This is no PLY file, or it is damaged.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    if point_extension(path) == _PACKED_PLY:
        file = unpacked(as_path(path), progress_part(progress, 0.0, 0.5))
        return _native.read_range_grid(file, progress_part(progress, 0.5, 1.0))
    return _native.read_range_grid(os.fsencode(as_path(path)), as_progress(progress))


def read_faces(
    path: str | os.PathLike[str], *, progress: ProgressCallback | None = None
) -> npt.NDArray[np.int64]:
    """Reads the faces of a PLY file as (triangles, 3) indices of its points.

    Polygons are triangulated, concave ones too; (0, 3) where there are no faces.

    Raises:
        ValueError: This is no PLY file, or it is damaged.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    if point_extension(path) == _PACKED_PLY:
        file = unpacked(as_path(path), progress_part(progress, 0.0, 0.5))
        return _native.read_faces(file, progress_part(progress, 0.5, 1.0))
    return _native.read_faces(os.fsencode(as_path(path)), as_progress(progress))
