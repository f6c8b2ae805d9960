# SPDX-License-Identifier: GPL-3.0-or-later

"""Reconstructed surfaces of scans, converted to meshes for Blender."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import prefilter
from prefilter.workflows import points
from prefilter.workflows.points import directions, labeled, openings, options

from ..bridge.layers import ATTRIBUTE, COLOR, NewLayer
from ..bridge.new_meshes import Contour
from ..bridge.solids import MaterialKey
from ..bridge.target_frame import TargetFrame
from ..bridge.units import length
from ..core.jobs import Progress
from ..core.wording import amount
from .choices import ScanSettings

__all__ = (
    "Look",
    "contour",
    "directions",
    "labeled",
    "oddities",
    "openings",
    "options",
    "reconstruct",
    "summarize",
    "support_layers",
)

_MAX_CORNERS = 2**31 - 1


class Look(NamedTuple):
    """Attributes and materials of a surface.

    Attributes:
        layers: Its attributes.
        active_color: Name of the active color attribute; empty for none.
        render_color: Name of the color attribute used by renders.
        materials: Materials of the object's slots.
    """

    layers: Sequence[NewLayer]
    active_color: str
    render_color: str
    materials: Sequence[MaterialKey | None] = ()


def reconstruct(
    sources: Sequence["Path | prefilter.ScanPoints"],
    settings: ScanSettings,
    progress: Progress,
    viewpoint: Sequence[Sequence[float]] | None = None,
) -> "prefilter.Reconstruction":
    """Reconstructs the surface of files or scans, with attributes and support.

    For `viewpoint` see `prefilter.reconstruct`.

    Raises:
        ValueError: There is no surface, cells are too small, or a file is damaged.
        OSError: A file cannot be read.
        MemoryError: It does not fit into memory.
        prefilter.Cancelled: `progress` returned False.
    """
    with labeled():
        return prefilter.reconstruct(
            list(sources),
            support=True,
            viewpoint=viewpoint,
            progress=progress,
            **options(settings),
        )


def support_layers(surface: "prefilter.Reconstruction", taken: Collection[str]) -> list[NewLayer]:
    """Converts the support to attributes, for `prefilter.trim`; none if a name is taken."""
    support = surface.support or {}
    if not support.keys().isdisjoint(taken):
        return []
    return [
        NewLayer(ATTRIBUTE, name, "FLOAT", "POINT", values[:, None])
        for name, values in support.items()
    ]


def contour(
    surface: "prefilter.Reconstruction", frame: TargetFrame, look: Look, settings: ScanSettings
) -> Contour:
    """Converts a surface to the object's space, for a new mesh.

    Raises:
        MemoryError: There are more triangles than Blender can index.
    """
    if 3 * len(surface.triangles) > _MAX_CORNERS:
        raise MemoryError(
            f"{amount(len(surface.triangles), 'triangle')} are more than Blender can take; use "
            f"fewer or larger cells, or write a file with the command reconstruct"
        )
    local, triangles = frame.localize(surface.positions, surface.triangles)
    return Contour(
        local,
        triangles,
        look.materials,
        layers=look.layers,
        active={COLOR: look.active_color},
        rendered={COLOR: look.render_color},
        sharp_angle=np.pi if settings.use_smooth_shading else None,
        edges=prefilter.mesh_edges(local, triangles, threads=settings.threads),
    )


def summarize(report: "prefilter.ReconstructionReport") -> str:
    """Numbers about a surface as text, in the units of the scene."""
    return points.summary(report, length)


def oddities(
    report: "prefilter.ReconstructionReport", origin: Sequence[float] = (0.0, 0.0, 0.0)
) -> list[str]:
    """Warnings about the points, in the units of the scene.

    Args:
        report: Report of the reconstruction.
        origin: World position of the origin of the points' coordinates.
    """
    return points.point_warnings(report, length, origin)
