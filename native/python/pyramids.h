// Levels in, of whichever type, without a copy.
#pragma once

#include <vector>

#include "convert.h"
#include "prefilter/sampling/pyramid.h"

namespace prefilter::python {

/// A view of arrays of shape (height, width, channels), C-contiguous, all of float32 or all of
/// uint8, and all of as many channels.
inline Pyramid pyramid_of(const std::vector<pybind11::array>& levels) {
  Pyramid pyramid;
  for (const pybind11::array& level : levels) {
    pyramid.bytes = level.itemsize() == 1;
    pyramid.channels = static_cast<int>(level.shape(2));
    pyramid.levels.push_back(
        {level.data(), static_cast<int>(level.shape(1)), static_cast<int>(level.shape(0))});
  }
  return pyramid;
}

}  // namespace prefilter::python
