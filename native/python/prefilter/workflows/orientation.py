# SPDX-License-Identifier: GPL-3.0-or-later

"""Orientation of pictures by EXIF."""

from typing import Any

from numpy.typing import NDArray


def turned(values: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Returns an upright picture, rows from the top, of one stored with an EXIF orientation."""
    if orientation in {5, 6, 7, 8}:
        values = values.swapaxes(0, 1)
    if orientation in {2, 3, 6, 7}:
        values = values[:, ::-1]
    if orientation in {3, 4, 7, 8}:
        values = values[::-1]
    return values
