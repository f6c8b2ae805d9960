# SPDX-License-Identifier: GPL-3.0-or-later

"""Straight and associated alpha of (..., 4) texels; the fourth channel is unchanged."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float32]


def associated(texels: FloatArray) -> FloatArray:
    """Returns texels whose colors are multiplied by alpha."""
    return np.concatenate([texels[..., :3] * texels[..., 3:], texels[..., 3:]], axis=-1)


def unassociated(texels: FloatArray) -> FloatArray:
    """Returns texels whose colors are divided by alpha; unchanged where that is 0."""
    straight = texels.copy()
    alpha = texels[..., 3:]
    np.divide(texels[..., :3], alpha, out=straight[..., :3], where=alpha > 0)
    return straight


def at_most_opaque(texels: FloatArray) -> FloatArray:
    """Returns associated texels with alpha limited to 1, keeping their straight colors."""
    divisor: FloatArray = np.maximum(texels[..., 3:], 1.0)
    return texels / divisor
