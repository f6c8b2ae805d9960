# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading of point files."""

import gzip
import os
import zlib
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_int, as_progress, progress_part
from .._border.arrays import as_floats
from .._border.input import as_path, open_file
from .choice import Classes, as_choice
from .e57 import E57Reader
from .extensions import POINT_EXTENSIONS
from .las import LasReader
from .reader import PointReader
from .scan import ScanPoints

_READERS: dict[str, Callable[[str], PointReader]] = {
    ".las": LasReader,
    ".laz": LasReader,
    ".e57": E57Reader,
}
_FROM_ABOVE = frozenset({".las", ".laz"})
_GZIP = ".gz"
_GZIP_CHUNK_SIZE = 1 << 20
_PACKED_PLY = f".ply{_GZIP}"
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
    """Reads the points of a file, in the format of its extension.

    .ply, .ply.gz, .pcd: nx, ny, nz (or normal_x and so on) are normals, confidence is the weight;
    all other numbers are attributes. The normal of a Gaussian splat is its shortest axis, turned
    outward, its weight its opacity. VIEWPOINT of a .pcd file is the viewpoint, except for the
    origin if the points are not an image: programs also write it for an unknown viewpoint.
    .xyz, .xyzn, .pts, .asc, .txt, .csv: lines of x y z, followed by a normal, a color, an
    intensity. The meaning of columns is inferred from the first thousands of lines, or from names
    in the first line.
    .obj: vertices, with the file's normals if there are as many, and with colors after x y z.
    .ptx: consecutive scans, with intensities and perhaps colors, placed by their matrices; the
    viewpoint of each point is that of its scan.
    .laz: needs the Python package lazrs, which is part of the Blender extension.
    .e57: all scans, in the file's coordinates. The viewpoints are the positions of their poses, or
    the origin for a scan without a pose that still is a scanner's grid.

    Colors are bytes, also for files with 16 bits. The attributes "classification", "return_number"
    and "number_of_returns" have these names for any spelling in the file.

    Args:
        path: Path of the file.
        most: Greatest number of points to keep: every second, third or so on is kept while reading,
            so that the file need not fit into memory. None keeps all. If points are chosen, so
            that their number is not known before, every 2nd, 4th, 8th or so on is kept.
        classes: Classes of the points to keep, as for `choose_points`.
        returns: Returns to keep, as for `choose_points`.
        box: Box of the points to keep, as for `choose_points`.
        progress: Called with the fraction done; returning False stops the work.

    Raises:
        ValueError: The extension is unknown, a value is not allowed, a package is missing, the file
            lacks the classes or returns, or it is damaged; the message names the line or the point.
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
        raise MemoryError(f"'{os.fsdecode(path)}': {_reason(error)}") from error
    if is_undirected(source):
        normals = _directed(positions, normals, progress_part(progress, 0.5, 1.0))
    if viewpoint is None and source.viewpoint is not None:
        viewpoint = np.array(source.viewpoint)
    return ScanPoints(
        positions,
        normals,
        weights,
        attributes,
        viewpoint,
        stride,
        is_from_above(path),
        tuple(dict.fromkeys(source.warnings)),
    )


def is_from_above(path: str | os.PathLike[str]) -> bool:
    """Whether a file has a format that is mostly used for airborne scans."""
    return os.path.splitext(as_path(path))[1].lower() in _FROM_ABOVE


def float_step(positions: npt.ArrayLike) -> float:
    """Detects coordinates that passed through single precision; returns the rounding step.

    The step between single-precision numbers grows with their distance from 0: it is 1/2 for a
    northing of five million. Points that are nearer to each other than the step are merged.

    Args:
        positions: (points, 3). Values that are not finite do not count.

    Returns:
        The largest step along an axis with rounded coordinates, in their units; 0 where coordinates
        on all axes have more digits than single precision, or need fewer.

    Raises:
        ValueError: The shape or type is wrong.
    """
    return _native.float_step(as_floats("positions", positions, ("points", 3), np.float64))


def _reason(error: MemoryError) -> str:
    """Message of an error, with a general one in place of the system's empty messages."""
    text = str(error)
    return "its points do not fit into memory" if not text or "bad_alloc" in text else text


def is_undirected(source: _native.PointSource) -> bool:
    """Whether points have normals whose side is arbitrary."""
    return source.has_normals and not source.are_normals_directed


def _directed(
    positions: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float32] | None,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32] | None:
    if normals is None or len(normals) == 0:
        return normals
    directed = _native.directed_normals(positions, normals.astype(np.float64), progress, 0)
    return directed.astype(np.float32)


def open_points(
    path: str | os.PathLike[str], *, progress: ProgressCallback | None = None
) -> _native.PointSource:
    """Opens a file for functions of the native module that read it in chunks."""
    name = as_path(path)
    extension = point_extension(name)
    if extension in _READERS:
        return _native.PointSource(_READERS[extension](name))
    if extension == _PACKED_PLY:
        return _native.open_ply(_unpack(name, progress))
    if extension not in POINT_EXTENSIONS:
        raise ValueError(
            f"'{name}': unsupported extension '{extension}'; use {', '.join(POINT_EXTENSIONS)}"
        )
    return _native.open_points(os.fsencode(name))


def _unpack(path: str, progress: ProgressCallback | None) -> _native.UnpackedFile:
    """Unpacks a gzip file into a temporary file, which is deleted with the returned object.

    Raises:
        ValueError: The file is damaged, or not a gzip file.
        OSError: A file cannot be read or written.
        Cancelled: `progress` returned False.
    """
    progress = as_progress(progress)
    target = _native.UnpackedFile(path)
    with open_file(path) as packed:
        size = max(packed.seek(0, 2), 1)
        packed.seek(0)
        with gzip.GzipFile(fileobj=packed) as source:
            while True:
                try:
                    data = source.read(_GZIP_CHUNK_SIZE)
                except (EOFError, zlib.error, gzip.BadGzipFile) as error:
                    raise ValueError(f"'{path}' cannot be unpacked by gzip: {error}") from error
                if not data:
                    return target
                target.write(data)
                if progress is not None and progress(packed.tell() / size) is False:
                    raise _native.Cancelled


def point_extension(path: str | os.PathLike[str]) -> str:
    """Extension of a file name, in lower case; two parts for ".gz", as in ".ply.gz"."""
    stem, extension = os.path.splitext(os.fsdecode(path).lower())
    return os.path.splitext(stem)[1] + extension if extension == _GZIP else extension


def is_ply(path: str | os.PathLike[str]) -> bool:
    """Whether the extension is that of a PLY file, packed or not."""
    return point_extension(path) in (".ply", _PACKED_PLY)


def read_range_grid(
    path: str | os.PathLike[str], *, progress: ProgressCallback | None = None
) -> npt.NDArray[np.int64] | None:
    """Reads a scanner's grid of points from a PLY file, its element "range_grid".

    Returns:
        (rows, columns) indices of points, -1 where the scanner saw nothing; None where the file has
        no grid.

    Raises:
        ValueError: This is no PLY file, or it is damaged.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    if point_extension(path) == _PACKED_PLY:
        file = _unpack(as_path(path), progress_part(progress, 0.0, 0.5))
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
        file = _unpack(as_path(path), progress_part(progress, 0.0, 0.5))
        return _native.read_faces(file, progress_part(progress, 0.5, 1.0))
    return _native.read_faces(os.fsencode(as_path(path)), as_progress(progress))
