# SPDX-License-Identifier: GPL-3.0-or-later

"""Comparison of octrees."""

import numpy as np
import prefilter
from prefilter import _native


def octrees_are_same(first: prefilter.Octree, second: prefilter.Octree) -> bool:
    """Asserts that two trees are the same, bit for bit."""
    own, other = _native.levels_of(first), _native.levels_of(second)
    return (
        first.depth == second.depth
        and first.bounds == second.bounds
        and len(own) == len(other)
        and all(
            np.array_equal(a, b)
            for x, y in zip(own, other, strict=True)
            for a, b in zip(x, y, strict=True)
        )
    )
