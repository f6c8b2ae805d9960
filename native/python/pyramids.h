// SPDX-License-Identifier: GPL-3.0-or-later

// Levels in, of whichever type, without a copy.
#pragma once

#include <utility>
#include <vector>

#include "convert.h"
#include "prefilter/sampling/pyramid.h"

namespace prefilter::python {

/// A view of arrays of shape (height, width, channels), C-contiguous, all of float32 or all of
/// uint8, and all of as many channels.
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
