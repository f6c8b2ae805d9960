# SPDX-License-Identifier: GPL-3.0-or-later

"""The surface of scans, and what Blender shows of it."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge.layers import COLOR, NewLayer
from ..bridge.new_meshes import Contour
from ..bridge.place import Place
from ..bridge.solids import MaterialKey
from ..bridge.units import length
from ..core.jobs import Progress
from ..core.wording import Sentence, amount
from .choices import ScanSettings

_Attributes: TypeAlias = dict[str, NDArray[np.uint8 | np.float32]]
_MeshWithAttributes: TypeAlias = tuple[NDArray[np.float64], NDArray[np.int32], _Attributes]

_MOST_CORNERS = 2**31 - 1
_FEW = 1e-3
"""The share of outliers that every scan may have."""


@dataclass(frozen=True)
class Surface:
    """The surface of points.

    Attributes:
        positions: (n, 3) float64.
        triangles: (m, 3) int32.
        attributes: Those of the points, for the vertices.
        report: What the library says about it.
    """

    positions: NDArray[np.float64]
    triangles: NDArray[np.int32]
    attributes: _Attributes
    report: "prefilter.ReconstructionReport"


class Look(NamedTuple):
    """What a surface has besides where it is.

    Attributes:
        layers: Its attributes.
        active_color: The name of the active one of these; empty for none.
        render_color: The name of the one that renders use.
        materials: Those of the object's slots.
    """

    layers: Sequence[NewLayer]
    active_color: str
    render_color: str
    materials: Sequence[MaterialKey | None] = ()


def reconstructed(
    sources: Sequence["Path | prefilter.ScanPoints"], settings: ScanSettings, progress: Progress
) -> Surface:
    """Returns the surface of files or scans that are put together.

    Raises:
        ValueError: There is no surface, cells are too small, or a file is damaged.
        OSError: A file cannot be read.
        MemoryError: It does not fit into memory.
        prefilter.Cancelled: `progress` has said so.
    """
    report = prefilter.ReconstructionReport()
    with labeled():
        found = prefilter.reconstruct(
            list(sources), attributes=True, report=report, progress=progress, **options(settings)
        )
    positions, triangles, attributes = cast("_MeshWithAttributes", found)
    if len(triangles) == 0:
        if settings.trim:
            raise ValueError(Sentence("the result is empty: Trim has left nothing of it"))
        raise ValueError(Sentence("the result is empty: the points enclose nothing"))
    return Surface(positions, triangles, attributes, report)


@contextmanager
def labeled() -> Iterator[None]:
    """Calls the settings in messages what panels call them."""
    try:
        yield
    except ValueError as error:
        raise ValueError(str(error).replace("cell_size:", "Voxel Size:")) from error


def options(settings: ScanSettings) -> dict[str, Any]:
    """Returns the settings that the library has too."""
    custom = settings.isovalue == "custom"
    size = settings.voxel_size if settings.resolution == "size" else None
    return {
        "depth": settings.depth,
        "cell_size": size,
        "wavelet": settings.wavelet,
        "smooth": settings.use_smooth,
        "isovalue": settings.custom_isovalue if custom else settings.isovalue,
        "fit": settings.use_fit,
        "trim": settings.trim if settings.trim > 0.0 else None,
        "memory_limit": settings.memory_limit or None,
        "threads": settings.threads,
    }


def contour(surface: Surface, place: Place, look: Look, settings: ScanSettings) -> Contour:
    """Returns what becomes a mesh of an object.

    Raises:
        MemoryError: Blender has no numbers for so many triangles.
    """
    if 3 * len(surface.triangles) > _MOST_CORNERS:
        raise MemoryError(
            f"{amount(len(surface.triangles), 'triangle')} are more than Blender can take; use "
            f"fewer or larger cells, or write a file with the command reconstruct"
        )
    local, turned = place.localize(surface.positions, surface.triangles)
    return Contour(
        local,
        turned,
        look.materials,
        layers=look.layers,
        active={COLOR: look.active_color},
        rendered={COLOR: look.render_color},
        sharp_angle=np.pi if settings.use_smooth_shading else None,
        edges=prefilter.mesh_edges(local, turned, threads=settings.threads),
    )


def told(report: "prefilter.ReconstructionReport") -> str:
    """Returns numbers about a surface, in words."""
    points, triangles = amount(report.points, "point"), amount(report.triangles, "triangle")
    return Sentence("{} in cells of {}: {}", points, length(report.cell), triangles)


def oddities(report: "prefilter.ReconstructionReport") -> list[str]:
    """Returns what is odd about the points, as warnings."""
    found: list[str] = []
    if report.dropped:
        dropped = amount(report.dropped, "point")
        text = "left out, because they have no normal, no finite position or no weight: {}"
        found.append(Sentence(text, dropped))
    if report.outliers > _FEW:
        outliers = f"{100.0 * report.outliers:.2g} %"
        text = (
            "left out as outliers, because they are sampled much more sparsely than the rest: "
            "{} of the points"
        )
        found.append(Sentence(text, outliers))
    if report.is_flipped:
        found.append(Sentence("most normals point inward; all were flipped"))
    return found
