# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of points, as scanners and their programs write them."""

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import ProgressCallback, as_int, as_progress
from .._border.arrays import as_floats
from .._border.input import as_path
from .e57 import E57Reader
from .las import LasReader
from .reader import PointReader

_READERS: dict[str, Callable[[str], PointReader]] = {
    ".las": LasReader,
    ".laz": LasReader,
    ".e57": E57Reader,
}
_FROM_ABOVE = frozenset({".las", ".laz"})
POINT_EXTENSIONS = (*_native.POINT_EXTENSIONS, *_READERS)
"""What the names of files of points end in."""

_UNLIMITED = 2**62

AttributeArray: TypeAlias = npt.NDArray[np.uint8 | np.float32]


@dataclass(frozen=True, eq=False)
class ScanPoints:
    """Points of a scan, with what is known of them.

    Attributes:
        positions: (n, 3). A value that is not finite in the file is not finite here.
        normals: (n, 3), of any length; None where the file has none.
        weights: (n,), how much each point counts (a scanner's confidence); None: all the same.
        attributes: An (n,) array for each other value that the points have, by its name in the
            file: uint8 where the file has bytes, else float32.
        viewpoint: Where the scanner stood, (3,), in the coordinates of the points; or for each
            point, (n, 3), where these were seen from several places; None where the file does not
            say.
        stride: Of how many points of the file, in their order, one is here.
        is_from_above: A scanner looked down at them, as at those of .las and .laz files.
    """

    positions: npt.NDArray[np.float64]
    normals: npt.NDArray[np.floating] | None = None
    weights: npt.NDArray[np.float32] | None = None
    attributes: dict[str, AttributeArray] = field(default_factory=dict)
    viewpoint: npt.NDArray[np.float64] | None = None
    stride: int = 1
    is_from_above: bool = False

    @property
    def colors(self) -> AttributeArray | None:
        """(n, 3), of the attributes red, green and blue; None where one is missing."""
        names = ("red", "green", "blue")
        if not all(name in self.attributes for name in names):
            return None
        return np.stack([self.attributes[name] for name in names], axis=1)


def read_points(
    path: str | os.PathLike[str],
    *,
    most: int | None = None,
    progress: ProgressCallback | None = None,
) -> ScanPoints:
    """Reads the points of a file; its ending says of which format it is.

    .ply, .pcd: nx, ny, nz (or normal_x and so on) are normals, confidence is the weight; all other
    numbers are attributes. VIEWPOINT of a .pcd file is the viewpoint, except for the origin in a
    cloud that is no image: it stands there, too, where nothing is known.
    .xyz, .xyzn, .pts, .asc, .txt, .csv: lines of x y z, and then a normal, a color, an intensity;
    which of these the columns are is told from the first thousands of lines, or by names in the
    first.
    .ptx: scans one after the other, with intensities and perhaps colors, placed by their matrices;
    the viewpoint of each point is that of its scan.
    .las, .laz: need the Python package laspy; .laz also lazrs or laszip.
    .e57: needs the Python package pye57. All scans are read, in the file's coordinates; the places
    of their poses are the viewpoint.

    Args:
        path: Of the file.
        most: At most so many points are kept: each second one, or third, and so on, so that the
            rest never has to fit into memory. None keeps all.
        progress: Called with the fraction done; returning False stops the work.

    Raises:
        ValueError: The extension is another, `most` is not above 0, a package is missing, or the
            file is damaged; the message names the line or the point.
        OSError: The file cannot be read.
        MemoryError: The points would not fit into memory.
        Cancelled: `progress` returned False.
    """
    limit = _UNLIMITED
    if most is not None:
        limit = as_int("most", most, "a whole number above 0 is needed")
        if limit <= 0:
            raise ValueError(f"most: {most}; a whole number above 0 is needed")
    source = open_points(path)
    positions, normals, weights, viewpoint, attributes, stride = _native.read_points(
        source, limit, as_progress(progress)
    )
    if viewpoint is None and source.viewpoint is not None:
        viewpoint = np.array(source.viewpoint)
    above = is_from_above(path)
    return ScanPoints(positions, normals, weights, attributes, viewpoint, stride, above)


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


def open_points(path: str | os.PathLike[str]) -> _native.PointSource:
    """Opens a file for functions of the native module that read it piece by piece."""
    name = as_path(path)
    ending = os.path.splitext(name)[1].lower()
    if ending in _READERS:
        return _native.PointSource(_READERS[ending](name))
    if ending not in POINT_EXTENSIONS:
        raise ValueError(
            f"'{name}': unsupported extension '{ending}'; use {', '.join(POINT_EXTENSIONS)}"
        )
    return _native.open_points(os.fsencode(name))


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
    return _native.read_range_grid(os.fsencode(as_path(path)), as_progress(progress))


def read_faces(
    path: str | os.PathLike[str], *, progress: ProgressCallback | None = None
) -> npt.NDArray[np.int64]:
    """Reads the faces of a PLY file as (triangles, 3) indices of its points.

    Polygons become fans around their first corner; (0, 3) where there are no faces.

    Raises:
        ValueError: This is no PLY file, or it is damaged.
        OSError: The file cannot be read.
        Cancelled: `progress` returned False.
    """
    return _native.read_faces(os.fsencode(as_path(path)), as_progress(progress))
