# SPDX-License-Identifier: GPL-3.0-or-later

"""Where a mesh is thinner than it was to be."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class ThinPlaces:
    """The triangles below which `voxelize` made a solid thicker, in ascending order.

    Lengths are cells. The thickness at a point is the diameter of the ball that touches the surface
    there from within, and what faces the other way.

    Attributes:
        triangles: (n,) int64: their numbers in the mesh.
        thickness: (n,) float64: of the solid where it is thinnest below each; 0 for sheets.
        made: (n,) float64: what it became there.
        areas: (n,) float64: of each triangle, as far as it is thin.
    """

    triangles: npt.NDArray[np.int64]
    thickness: npt.NDArray[np.float64]
    made: npt.NDArray[np.float64]
    areas: npt.NDArray[np.float64]

    def thickness_of(self, share: float = 1.0) -> float:
        """The thickness that this share of the thin area has at least, by triangles.

        Args:
            share: Above 0, up to 1; of 1 it is the smallest thickness, of 0.5 the median.

        Returns:
            In cells; infinity where nothing is thin.
        """
        return self._reached(self.thickness, share)

    def refinement(self, share: float = 1.0) -> float:
        """How many times smaller cells have to be for this share of the thin area to stay as it is.

        Args:
            share: Above 0, up to 1.

        Returns:
            1 where nothing is thin; infinity where sheets are more than the rest.
        """
        least = self._reached(self.thickness / self.made, share)
        return 1.0 if least == np.inf else (1.0 / least if least > 0.0 else np.inf)

    def _reached(self, values: npt.NDArray[np.float64], share: float) -> float:
        if not 0.0 < share <= 1.0:
            raise ValueError(f"share: {share!r}; a number above 0 and up to 1 is needed")
        if len(values) == 0:
            return np.inf
        order = np.argsort(values)[::-1]
        sums = np.cumsum(self.areas[order])
        place = np.searchsorted(sums, share * sums[-1] * (1 - 1e-12))
        return float(values[order[place]])
