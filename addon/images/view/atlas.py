# SPDX-License-Identifier: GPL-3.0-or-later

"""The levels of an image side by side in one texture, because Blender cannot upload mipmaps.

Level 0 is at (0, 0). The others follow along its longer side of s texels, level k from
s - (s >> (k - 1)) + k - 1 on: each has half the texels of the one before, rounded up.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...bridge.images import FloatArray

READ_TEXELS = """
ivec2 size_of(int level)
{
  return ivec2((size_0.x - 1) >> level, (size_0.y - 1) >> level) + 1;
}

vec4 texel_of(int level, ivec2 texel)
{
  ivec2 origin = ivec2(0);
  if (level > 0) {
    bool wide = size_0.x >= size_0.y;
    int side = wide ? size_0.x : size_0.y;
    int along = side - (side >> (level - 1)) + level - 1;
    origin = wide ? ivec2(along, size_0.y) : ivec2(size_0.x, along);
  }
  return texelFetch(atlas, origin + texel, 0);
}
"""
"""GLSL: reads the sampler `atlas`, where `size_0` is the size of level 0."""


def packed(levels: "Sequence[FloatArray]") -> "FloatArray":
    """Returns all levels in one array.

    Args:
        levels: (height, width, channels), each with half the sides of the one before, rounded up.
    """
    height, width, channels = levels[0].shape
    level_1 = levels[1].shape[:2] if len(levels) > 1 else (0, 0)
    is_wide = width >= height
    longer = max(width, height) + len(levels)
    size = (height + level_1[0], longer) if is_wide else (longer, width + level_1[1])
    atlas = np.zeros((*size, channels), np.float32)
    atlas[:height, :width] = levels[0]
    side = max(width, height)
    for number, level in enumerate(levels[1:], start=1):
        along = side - (side >> (number - 1)) + number - 1
        row, column = (height, along) if is_wide else (along, width)
        atlas[row : row + level.shape[0], column : column + level.shape[1]] = level
    return atlas
