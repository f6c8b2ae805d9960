# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of a scan in memory."""

from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arrays import as_floats

AttributeArray: TypeAlias = npt.NDArray[np.uint8 | np.float32]


@dataclass(frozen=True, eq=False)
class ScanPoints:
    """Points of a scan, with normals and other values.

    Attributes:
        positions: (n, 3). Values that are not finite in the file are not finite here.
        normals: (n, 3), of any length; None where the file has none.
        weights: (n,), how much each point counts (a scanner's confidence); None: all the same.
        attributes: Other values of the points, (n,) each, by their names in the file: uint8 where
            the file has bytes, else float32.
        viewpoint: Position of the scanner in the coordinates of the points, (3,), or one per point,
            (n, 3), if there are several; None where the file does not say.
        stride: Every how many points of the file one was read.
        is_from_above: Whether the scanner looked down, as for .las and .laz files.
        warnings: Oddities of the file; each warning names it.
    """

    positions: npt.NDArray[np.float64]
    normals: npt.NDArray[np.floating] | None = None
    weights: npt.NDArray[np.float32] | None = None
    attributes: dict[str, AttributeArray] = field(default_factory=dict)
    viewpoint: npt.NDArray[np.float64] | None = None
    stride: int = 1
    is_from_above: bool = False
    warnings: tuple[str, ...] = ()

    @property
    def colors(self) -> AttributeArray | None:
        """(n, 3), of the attributes red, green and blue; None where one is missing."""
        names = ("red", "green", "blue")
        if not all(name in self.attributes for name in names):
            return None
        return np.stack([self.attributes[name] for name in names], axis=1)

    def take(self, which: npt.NDArray[np.bool_ | np.integer]) -> "ScanPoints":
        """Selects points, with their normals and other values.

        Args:
            which: A mask, (n,) bool, or indices.
        """
        viewpoint = self.viewpoint
        return replace(
            self,
            positions=self.positions[which],
            normals=None if self.normals is None else self.normals[which],
            weights=None if self.weights is None else self.weights[which],
            attributes={name: values[which] for name, values in self.attributes.items()},
            viewpoint=viewpoint if viewpoint is None or viewpoint.ndim == 1 else viewpoint[which],
        )

    def moved(self, matrix: npt.ArrayLike) -> "ScanPoints":
        """Applies a rigid motion to the points, normals and viewpoints.

        Args:
            matrix: (4, 4), as `align_scans` returns them: a rotation and a translation.
        """
        motion = as_floats("matrix", matrix, (4, 4), np.float64)
        rotation = np.array(motion)
        rotation[:3, 3] = 0.0
        viewpoint = self.viewpoint
        return replace(
            self,
            positions=_native.moved(_rows(self.positions), motion),
            normals=None if self.normals is None else _native.moved(_rows(self.normals), rotation),
            viewpoint=None
            if viewpoint is None
            else _native.moved(_rows(np.atleast_2d(viewpoint)), motion).reshape(viewpoint.shape),
        )


def _rows(values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    return as_floats("positions", values, ("points", 3), np.float64)
