# SPDX-License-Identifier: GPL-3.0-or-later

"""UDIM tiles: which part of surfaces lies in each."""

import numpy as np
import prefilter
from numpy.typing import NDArray

from .meshes import ImageSurfaces

FloatArray = NDArray[np.float64]


class TileSurfaces:
    """The parts of surfaces that lie in tiles; each is cut out once, whatever uses it."""

    def __init__(self) -> None:
        """Starts without any."""
        # With the surface, which keeps its identity from becoming another's.
        self._bounds: dict[int, tuple[prefilter.Surface, FloatArray, FloatArray]] = {}
        self._parts: dict[tuple[int, int], prefilter.Surface | None] = {}

    def inside(self, found: ImageSurfaces, number: int) -> ImageSurfaces:
        """Returns what lies in a tile, with the names of its objects, in the unit square."""
        inside = ImageSurfaces()
        for surface, name in zip(found.surfaces, found.objects, strict=True):
            part = self._part(surface, number)
            if part is not None:
                inside.surfaces.append(part)
                inside.objects.append(name)
        return inside

    def _part(self, surface: prefilter.Surface, number: int) -> prefilter.Surface | None:
        if id(surface) not in self._bounds:
            uvs = surface.uvs
            self._bounds[id(surface)] = surface, uvs.min(axis=(0, 1)), uvs.max(axis=(0, 1))
        _, low, high = self._bounds[id(surface)]
        corner = np.array(((number - 1001) % 10, (number - 1001) // 10))
        if np.any(high < corner) or np.any(low > corner + 1):
            return None
        key = id(surface), number
        if key not in self._parts:
            self._parts[key] = surface.udim_tile(number)
        return self._parts[key]
