# SPDX-License-Identifier: GPL-3.0-or-later

"""Surfaces cut by UDIM tiles."""

import numpy as np
import prefilter
from numpy.typing import NDArray

from .meshes import ImageSurfaces

FloatArray = NDArray[np.float64]


class TileSurfaces:
    """Parts of surfaces in UDIM tiles; each part is cut out once, and cached."""

    def __init__(self) -> None:
        """Starts empty."""
        # By id; storing the surface, too, keeps the id from being reused.
        self._bounds: dict[int, tuple[prefilter.Surface, FloatArray, FloatArray]] = {}
        self._parts: dict[tuple[int, int], prefilter.Surface | None] = {}

    def inside(self, surfaces: ImageSurfaces, number: int) -> ImageSurfaces:
        """Returns the parts of surfaces in a tile, moved to the unit square."""
        inside = ImageSurfaces()
        for surface, name in zip(surfaces.surfaces, surfaces.objects, strict=True):
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
