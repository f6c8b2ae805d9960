// SPDX-License-Identifier: GPL-3.0-or-later

// A pyramid extended beyond its edges by the wrap modes.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "prefilter/base/wrap.h"
#include "prefilter/sampling/pyramid.h"

namespace prefilter {

struct WrappedPyramid {
  Pyramid pyramid;
  WrapModes wrap;
  std::vector<std::byte> border;  // a texel of zeros

  WrappedPyramid(Pyramid pyramid_, const WrapModes& wrap_)
      : pyramid(std::move(pyramid_)), wrap(wrap_), border(pyramid.texel_size()) {}

  /// Address of the texel that (x, y) of a level reads, possibly outside of it.
  const void* texel(int level, int x, int y) const {
    const PyramidLevel& texels = pyramid.levels[level];
    const int column = texels.column_of(x, wrap.u);
    const int row = texels.row_of(y, wrap.v);
    if (column < 0 || row < 0) return border.data();
    return static_cast<const std::byte*>(texels.texels) +
           (static_cast<std::size_t>(row) * texels.width + column) * pyramid.texel_size();
  }
};

}  // namespace prefilter
