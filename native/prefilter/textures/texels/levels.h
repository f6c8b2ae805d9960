// SPDX-License-Identifier: GPL-3.0-or-later

// Sizes of the levels of a mipmap.
#pragma once

#include <algorithm>

namespace prefilter {

/// Texels along an axis at a level: halved per level, down to 1.
inline int level_size(int size, int level) { return std::max(1, size >> level); }

/// The number of levels of an image, from full size down to 1 x 1.
inline int full_level_count(int width, int height) {
  int count = 1;
  while ((std::max(width, height) >> count) > 0) ++count;
  return count;
}

}  // namespace prefilter
