# SPDX-License-Identifier: GPL-3.0-or-later

"""Places where a mesh was thinner than requested."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class ThinPlaces:
    """Triangles below which `voxelize` thickened a solid, in ascending order.

    Lengths are in cells. The thickness at a point is the diameter of the largest inner ball that
    touches the surface there and the opposite side.

    Attributes:
        triangles: (n,) int64: their indices in the mesh.
        thickness: (n,) float64: smallest thickness of the solid below each; 0 for sheets.
        made: (n,) float64: the thickness that it was given there.
        areas: (n,) float64: the thin area of each triangle.
    """

    triangles: npt.NDArray[np.int64]
    thickness: npt.NDArray[np.float64]
    made: npt.NDArray[np.float64]
    areas: npt.NDArray[np.float64]

    def thickness_of(self, share: float = 1.0) -> float:
        """The thickness that at least this share of the thin area has, by triangles.

        Args:
            share: Above 0, up to 1; 1 gives the smallest thickness, 0.5 the median.

        Returns:
            Cells; infinity if nothing is thin.
        """
        return self._quantile(self.thickness, share)

    def refinement(self, share: float = 1.0) -> float:
        """Factor by which cells must shrink so that this share of the thin area is unchanged.

        Args:
            share: Above 0, up to 1.

        Returns:
            1 if nothing is thin; infinity if sheets make up more than the rest.
        """
        least = self._quantile(self.thickness / self.made, share)
        return 1.0 if least == np.inf else (1.0 / least if least > 0.0 else np.inf)

    def _quantile(self, values: npt.NDArray[np.float64], share: float) -> float:
        if not 0.0 < share <= 1.0:
            raise ValueError(f"share: {share!r}; a number above 0 and up to 1 is needed")
        if len(values) == 0:
            return np.inf
        order = np.argsort(values)[::-1]
        sums = np.cumsum(self.areas[order])
        place = np.searchsorted(sums, share * sums[-1] * (1 - 1e-12))
        return float(values[order[place]])
