// SPDX-License-Identifier: GPL-3.0-or-later

// Views of image pyramids of either type, without copies.
#pragma once

#include <utility>
#include <vector>

#include "convert.h"
#include "prefilter/sampling/pyramid.h"

namespace prefilter::python {

/// Views of C-contiguous arrays of shape (height, width, channels), all of float32 or all of uint8,
/// with equal numbers of channels.
inline Pyramid pyramid_of(const std::vector<pybind11::array>& levels) {
  std::vector<PyramidLevel> views;
  for (const pybind11::array& level : levels) {
    views.push_back(
        {level.data(), static_cast<int>(level.shape(1)), static_cast<int>(level.shape(0))});
  }
  const auto channels = levels.empty() ? 1 : static_cast<int>(levels[0].shape(2));
  return {std::move(views), channels, !levels.empty() && levels[0].itemsize() == 1};
}

}  // namespace prefilter::python
