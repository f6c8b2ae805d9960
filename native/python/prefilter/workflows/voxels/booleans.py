# SPDX-License-Identifier: GPL-3.0-or-later

"""Set operations on voxelized meshes in one grid."""

from collections.abc import Sequence
from functools import partial, reduce

import numpy as np

import prefilter

from ..progress import Progress
from ..wording import Sentence
from .grid import Box


def box(boxes: Sequence[Box], operation: str) -> Box:
    """Returns a box around the result, from the boxes of the operands.

    Raises:
        ValueError: The intersection of the boxes is empty.
    """
    if operation == "union":
        return (
            np.min([low for low, _ in boxes], axis=0),
            np.max([high for _, high in boxes], axis=0),
        )
    if operation == "difference":
        return boxes[0]
    low = np.max([low for low, _ in boxes], axis=0)
    high = np.min([high for _, high in boxes], axis=0)
    if np.any(low >= high):
        raise ValueError(Sentence("the objects have nothing in common"))
    return low, high


def combined(
    trees: Sequence[prefilter.Octree], operation: str, progress: Progress, threads: int
) -> prefilter.Octree:
    """Combines the first tree with the others, one after another."""
    combine = getattr(prefilter.Octree, operation)
    return reduce(partial(combine, progress=lambda _: progress(0.0), threads=threads), trees)
