# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of several scans as one cloud, and its surface."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge.layers import ATTRIBUTE, COLOR, NewLayer
from ..bridge.new_meshes import Contour
from ..bridge.place import Place
from ..bridge.points import Carried, Points
from ..bridge.units import length
from ..core.jobs import Progress, share
from ..core.jobs import parts as steps_of
from ..core.wording import amount
from .choices import ScanSettings

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32] | NDArray[np.int64]

CONFIDENCE = "confidence"
"""The attribute that says how much each point counts."""
_MEGABYTE = 1 << 20
_MOST_CORNERS = 2**31 - 1
_ESTIMATED = 0.3
"""What the progress is once normals are estimated."""
_FEW = 1e-3
"""The share of outliers that every scan may have."""
_ROUNDING = 1e-6
"""Of sizes that come in single precision, and of messages."""
_FILLED_IN = {"FLOAT": 0.0, "FLOAT_COLOR": 1.0, "BYTE_COLOR": 1.0}
"""What points have for an attribute that others have and they lack."""


@dataclass(frozen=True)
class Surface:
    """The surface of points.

    Attributes:
        positions: (n, 3) float64.
        triangles: (m, 3) int32 or int64.
        attributes: Those of the points, for the vertices.
        report: What the library says about it.
    """

    positions: FloatArray
    triangles: IntArray
    attributes: dict[str, Carried]
    report: "prefilter.ReconstructionReport"

    def contour(self, place: Place, source: Points, settings: ScanSettings) -> Contour:
        """Returns what becomes a mesh of an object.

        Args:
            place: Where the object is.
            source: What has its materials, and the names of its active colours.
            settings: How it is shaded.

        Raises:
            MemoryError: Blender has no numbers for so many triangles.
        """
        if 3 * len(self.triangles) > _MOST_CORNERS:
            raise MemoryError(
                f"{amount(len(self.triangles), 'triangle')} are more than Blender can take; use "
                f"fewer or larger cells, or write a file with the command reconstruct"
            )
        local, turned = place.localize(self.positions, self.triangles.astype(np.int32, copy=False))
        layers = [
            NewLayer(
                ATTRIBUTE if one.data_type == "FLOAT" else COLOR,
                name,
                one.data_type,
                "POINT",
                one.values,
            )
            for name, one in self.attributes.items()
        ]
        return Contour(
            local,
            turned,
            source.materials,
            layers=layers,
            active={COLOR: source.active_color},
            rendered={COLOR: source.render_color},
            sharp_angle=np.pi if settings.use_smooth_shading else None,
        )


def extent(positions: FloatArray) -> float:
    """Returns the longest side of the box around the points that are finite; 0 without any."""
    finite = positions[np.isfinite(positions).all(axis=1)]
    return float(np.ptp(finite, axis=0).max()) if len(finite) else 0.0


def reconstructed(parts: Sequence[Points], settings: ScanSettings, progress: Progress) -> Surface:
    """Returns the surface of points that are put together.

    Raises:
        ValueError: There is no surface, or cells are too small.
        MemoryError: It does not fit into memory.
        prefilter.Cancelled: `progress` has said so.
    """
    positions = np.concatenate([part.positions for part in parts])
    attributes = _joined_attributes(parts)
    if any(part.normals is None for part in parts):
        parts = _with_normals(parts, settings, share(progress, 0.0, _ESTIMATED))
        progress = share(progress, _ESTIMATED, 1.0)
    carried = [one.values for one in attributes.values()]
    report = prefilter.ReconstructionReport()
    found = prefilter.reconstruct(
        positions,
        np.concatenate([part.normals for part in parts if part.normals is not None]),
        depth=depth_of(extent(positions), settings),
        weights=_weights(attributes),
        attributes=np.concatenate(carried, axis=1) if carried else None,
        report=report,
        progress=progress,
        **options(settings),
    )
    vertices, triangles = found[:2]
    if len(triangles) == 0:
        reason = "Trim has left nothing of it" if settings.trim else "the points enclose nothing"
        raise ValueError(f"the result is empty: {reason}")
    return Surface(vertices, triangles, _split(attributes, found[2:]), report)


def options(settings: ScanSettings) -> dict[str, Any]:
    """Returns the settings that the library has too, but for the depth."""
    custom = settings.isovalue == "custom"
    return {
        "wavelet": settings.wavelet,
        "smooth": settings.use_smooth,
        "isovalue": settings.custom_isovalue if custom else settings.isovalue,
        "fit": settings.use_fit,
        "trim": settings.trim if settings.trim > 0.0 else None,
        "memory_limit": settings.memory_limit * _MEGABYTE or None,
        "threads": settings.threads,
    }


def depth_of(side: float, settings: ScanSettings) -> int:
    """Returns how often the cube is halved around points of that extent.

    Raises:
        ValueError: The voxel size makes too many cells.
    """
    if settings.resolution == "depth" or not side > 0.0:
        return settings.depth
    size = settings.voxel_size
    for depth in range(1, prefilter.MAX_DEPTH + 1):
        if _cell_of(side, depth) <= size * (1.0 + _ROUNDING):
            return depth
    least = _cell_of(side, prefilter.MAX_DEPTH)
    raise ValueError(
        f"Voxel Size: {size:g} makes more than {1 << prefilter.MAX_DEPTH} cells along an axis; use "
        f"{least:.3g} or more"
    )


def told(report: "prefilter.ReconstructionReport") -> str:
    """Returns numbers about a surface, in words."""
    return (
        f"{amount(report.points, 'point')} in cells of {length(report.cell)}: "
        f"{amount(report.triangles, 'triangle')}"
    )


def oddities(report: "prefilter.ReconstructionReport") -> list[str]:
    """Returns what is odd about the points, as warnings."""
    found = []
    if report.dropped:
        dropped = amount(report.dropped, "point")
        found.append(
            f"left out, as they have no normal, no finite position or no weight: {dropped}"
        )
    if report.outliers > _FEW:
        outliers = f"{100.0 * report.outliers:.2g} % of the points"
        found.append(f"left out, as they lie much thinner than the others: {outliers}")
    if report.is_flipped:
        found.append("most normals point inward; the opposite ones were used")
    return found


def _cell_of(side: float, depth: int) -> float:
    """Returns the side of a cell around points of that extent."""
    low, high = prefilter.cube_around(([0.0] * 3, [side] * 3), depth=depth)
    return float((high - low).max()) / (1 << depth)


def _with_normals(
    parts: Sequence[Points], settings: ScanSettings, progress: Progress
) -> list[Points]:
    """Estimates normals: for each scanner's place by itself, for the others together."""
    complete = list(parts)
    without = [i for i, part in enumerate(parts) if part.normals is None]
    seen = [[i] for i in without if parts[i].viewpoint is not None]
    unseen = [i for i in without if parts[i].viewpoint is None]
    groups = [*seen, *([unseen] if unseen else [])]
    for group, step in zip(groups, steps_of(progress, len(groups)), strict=True):
        estimated = prefilter.estimate_normals(
            np.concatenate([parts[i].positions for i in group]),
            viewpoint=parts[group[0]].viewpoint,
            progress=step,
            threads=settings.threads,
        )
        start = 0
        for i in group:
            end = start + len(parts[i].positions)
            complete[i] = replace(parts[i], normals=estimated[start:end])
            start = end
    return complete


def _weights(attributes: dict[str, Carried]) -> NDArray[np.float32] | None:
    confidence = attributes.get(CONFIDENCE)
    if confidence is None or confidence.data_type != "FLOAT":
        return None
    return confidence.values[:, 0]


def _joined_attributes(parts: Sequence[Points]) -> dict[str, Carried]:
    types: dict[str, Carried] = {}
    for part in parts:
        for name, one in part.attributes.items():
            types.setdefault(name, one)
    joined = {}
    for name, first in types.items():
        values = [_values_of(part, name, first) for part in parts]
        joined[name] = Carried(first.data_type, np.concatenate(values))
    return joined


def _values_of(part: Points, name: str, like: Carried) -> NDArray[np.float32]:
    found = part.attributes.get(name)
    width = like.values.shape[1]
    if found is not None and found.values.shape[1] == width:
        return found.values
    filler = 1.0 if name == CONFIDENCE else _FILLED_IN[like.data_type]
    return np.full((len(part.positions), width), filler, np.float32)


def _split(
    attributes: dict[str, Carried], found: Sequence[NDArray[np.float32]]
) -> dict[str, Carried]:
    """Returns the columns of what the library has carried, as attributes of the vertices."""
    if not attributes:
        return {}
    (columns,) = found
    split, start = {}, 0
    for name, one in attributes.items():
        end = start + one.values.shape[1]
        split[name] = Carried(one.data_type, columns[:, start:end])
        start = end
    return split
