# SPDX-License-Identifier: GPL-3.0-or-later

"""Set operations on what meshes fill, in one grid of cells."""

from collections.abc import Sequence
from functools import partial, reduce

import numpy as np

import prefilter

from ..progress import Progress
from ..wording import Sentence
from .grid import Box


def box(boxes: Sequence[Box], operation: str) -> Box:
    """Returns the box that holds the result, by those of the operands.

    Raises:
        ValueError: There is nothing that is in all of them.
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
    """Returns the first tree with the others, one after another.

    Args:
        trees: One or more, of one grid.
        operation: The method of `prefilter.Octree`.
        progress: Called now and then, with 0.
        threads: How many to use.
    """
    combine = getattr(prefilter.Octree, operation)
    return reduce(partial(combine, progress=lambda _: progress(0.0), threads=threads), trees)
