# SPDX-License-Identifier: GPL-3.0-or-later

"""Products and inverses of small matrices, with identical bits on every machine.

NumPy delegates to BLAS and LAPACK, whose order of summation depends on the processor.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def product(first: ArrayLike, second: ArrayLike) -> NDArray[np.float64]:
    """Returns a matrix product, summed in ascending order.

    Args:
        first: (..., n, k).
        second: (..., k, m); both are broadcast.
    """
    first, second = np.asarray(first, np.float64), np.asarray(second, np.float64)
    total: NDArray[np.float64] = first[..., :, :1] * second[..., :1, :]
    for i in range(1, first.shape[-1]):
        total = total + first[..., :, i : i + 1] * second[..., i : i + 1, :]
    return total


def inner(first: ArrayLike, second: ArrayLike) -> float:
    """Returns the inner product of two vectors."""
    pairs = zip(np.asarray(first).tolist(), np.asarray(second).tolist(), strict=True)
    return float(sum(a * b for a, b in pairs))


def inverse(matrix: ArrayLike) -> NDArray[np.float64]:
    """Returns the inverse of a regular (3, 3) matrix, by its adjugate."""
    rows = np.asarray(matrix, np.float64)
    adjugate = np.cross(rows[[1, 2, 0]], rows[[2, 0, 1]]).T
    return np.asarray(adjugate / inner(rows[0], adjugate[:, 0]), np.float64)
