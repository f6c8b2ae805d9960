"""What the nearest point of a surface has: its material and its colours."""

import numpy as np
from mathutils.bvhtree import BVHTree
from numpy.typing import NDArray

from ..jobs import Progress, go_on

_AT_ONCE = 1 << 14  # Points between two looks at whether to stop: about 0.1 s.


class NearestSurface:
    """Finds the points of a triangle mesh that are nearest to others; belongs to no thread."""

    def __init__(self, positions: NDArray[np.float64], triangles: NDArray[np.int32]) -> None:
        """Builds the tree.

        Args:
            positions: (n, 3).
            triangles: (m, 3), at least one.
        """
        # The tree keeps single floats: they get numbers about 1.
        self._low = positions.min(axis=0)
        self._scale = 1.0 / max(float((positions.max(axis=0) - self._low).max()), 1e-30)
        self._corners = self._scaled(positions)[triangles]
        self._tree = BVHTree.FromPolygons(
            self._scaled(positions).tolist(), triangles.tolist(), all_triangles=True
        )

    def find(
        self, points: NDArray[np.floating], progress: Progress
    ) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """Returns the nearest triangle of each point, and the weights of its corners there.

        Raises:
            prefilter.Cancelled: `progress` has said so.
        """
        found = np.zeros(len(points), np.int32)
        places = np.zeros((len(points), 3))
        for start in range(0, len(points), _AT_ONCE):
            go_on(progress, start / len(points))
            end = min(start + _AT_ONCE, len(points))
            rows = [self._tree.find_nearest(p) for p in self._scaled(points[start:end]).tolist()]
            found[start:end] = [row[2] for row in rows]
            places[start:end] = [row[0] for row in rows]
        return found, _corner_weights(self._corners[found], places)

    def _scaled(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        return (points - self._low) * self._scale


def _corner_weights(
    corners: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns barycentric coordinates of points on triangles; those of no area use corner 0."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, ac, ap = b - a, c - a, places - a
    dots = [
        np.einsum("ij,ij->i", u, v) for u, v in ((ab, ab), (ab, ac), (ac, ac), (ap, ab), (ap, ac))
    ]
    bb, bc, cc, pb, pc = dots
    area = bb * cc - bc * bc
    safe = np.where(area > 0, area, 1.0)
    weights = np.stack([np.zeros_like(area), cc * pb - bc * pc, bb * pc - bc * pb], axis=1)
    weights = np.clip(np.where(area[:, None] > 0, weights / safe[:, None], 0.0), 0.0, 1.0)
    weights[:, 0] = np.clip(1.0 - weights[:, 1] - weights[:, 2], 0.0, 1.0)
    return weights / weights.sum(axis=1, keepdims=True)
