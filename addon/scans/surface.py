# SPDX-License-Identifier: GPL-3.0-or-later

"""The surface of scans, and what Blender shows of it."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeAlias, cast

import numpy as np
import prefilter
from numpy.typing import NDArray
from prefilter.workflows import scans
from prefilter.workflows.scans import directions, labeled, openings, options

from ..bridge.layers import ATTRIBUTE, COLOR, NewLayer
from ..bridge.new_meshes import Contour
from ..bridge.place import Place
from ..bridge.solids import MaterialKey
from ..bridge.units import length
from ..core.jobs import Progress
from ..core.wording import amount
from .choices import ScanSettings

__all__ = (
    "Look",
    "Surface",
    "contour",
    "directions",
    "labeled",
    "oddities",
    "openings",
    "options",
    "reconstructed",
    "told",
)

_Attributes: TypeAlias = dict[str, NDArray[np.uint8 | np.float32]]
_Support: TypeAlias = dict[str, NDArray[np.float32]]
_MeshWithSupport: TypeAlias = tuple[NDArray[np.float64], NDArray[np.int32], _Attributes, _Support]

_MOST_CORNERS = 2**31 - 1


@dataclass(frozen=True)
class Surface:
    """The surface of points.

    Attributes:
        positions: (n, 3) float64.
        triangles: (m, 3) int32.
        attributes: Those of the points, for the vertices.
        report: What the library says about it.
        support: What `prefilter.trim` needs of the vertices, by the names of attributes.
    """

    positions: NDArray[np.float64]
    triangles: NDArray[np.int32]
    attributes: _Attributes
    report: "prefilter.ReconstructionReport"
    support: _Support

    def support_layers(self, taken: Collection[str]) -> list[NewLayer]:
        """Returns that as attributes; none where points have brought one of the names."""
        if not self.support.keys().isdisjoint(taken):
            return []
        return [
            NewLayer(ATTRIBUTE, name, "FLOAT", "POINT", values[:, None])
            for name, values in self.support.items()
        ]


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
    sources: Sequence["Path | prefilter.ScanPoints"],
    settings: ScanSettings,
    progress: Progress,
    viewpoint: Sequence[Sequence[float]] | None = None,
) -> Surface:
    """Returns the surface of files or scans that are put together.

    `viewpoint`: see `prefilter.reconstruct`.

    Raises:
        ValueError: There is no surface, cells are too small, or a file is damaged.
        OSError: A file cannot be read.
        MemoryError: It does not fit into memory.
        prefilter.Cancelled: `progress` has said so.
    """
    report = prefilter.ReconstructionReport()
    with labeled():
        found = prefilter.reconstruct(
            list(sources),
            attributes=True,
            support=True,
            viewpoint=viewpoint,
            report=report,
            progress=progress,
            **options(settings),
        )
    positions, triangles, attributes, support = cast("_MeshWithSupport", found)
    return Surface(positions, triangles, attributes, report, support)


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
    """Returns numbers about a surface, in words, in the units of the scene."""
    return scans.summary(report, length)


def oddities(
    report: "prefilter.ReconstructionReport", origin: Sequence[float] = (0.0, 0.0, 0.0)
) -> list[str]:
    """Returns what is odd about the points, as warnings, in the units of the scene.

    Args:
        report: About the surface.
        origin: Where the origin of the points' coordinates is.
    """
    return scans.point_warnings(report, length, origin)
