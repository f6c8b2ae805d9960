# SPDX-License-Identifier: GPL-3.0-or-later

"""Affine matrices of drawings and fonts.

(a, b, c, d, e, f) maps (x, y) to (a x + c y + e, b x + d y + f).
"""

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Matrix: TypeAlias = tuple[float, float, float, float, float, float]
IDENTITY: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)


def compose(outer: Matrix, inner: Matrix) -> Matrix:
    """Returns the matrix that applies `inner`, then `outer`."""
    a, b, c, d, e, f = outer
    g, h, i, j, k, m = inner
    return (
        a * g + c * h,
        b * g + d * h,
        a * i + c * j,
        b * i + d * j,
        a * k + c * m + e,
        b * k + d * m + f,
    )


def translation(x: float, y: float) -> Matrix:
    """Returns the matrix that moves by (x, y)."""
    return (1.0, 0.0, 0.0, 1.0, x, y)


def determinant(matrix: Matrix) -> float:
    return matrix[0] * matrix[3] - matrix[1] * matrix[2]


def inverse(matrix: Matrix) -> Matrix:
    """Returns the inverse of a regular matrix."""
    a, b, c, d, e, f = matrix
    scale = 1.0 / determinant(matrix)
    a, b, c, d = d * scale, -b * scale, -c * scale, a * scale
    return (a, b, c, d, -(a * e + c * f), -(b * e + d * f))


def as_rows(matrix: Matrix) -> npt.NDArray[np.float64]:
    """Returns the matrix as an array (2, 3), as shapes take it."""
    a, b, c, d, e, f = matrix
    return np.array([[a, c, e], [b, d, f]])
