// SPDX-License-Identifier: GPL-3.0-or-later

// Keys of the cubes of a grid, for hash tables.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Key of the cube with side `side` that contains a point; distant points are clamped.
inline std::uint64_t cube_key(const Vector3& point, double side) {
  constexpr std::int64_t kBias = std::int64_t{1} << 20;
  std::uint64_t key = 0;
  for (const double x : point) {
    const double at = std::clamp(std::floor(x / side), -1e6, 1e6);
    key = (key << 21U) | static_cast<std::uint64_t>(static_cast<std::int64_t>(at) + kBias);
  }
  return key;
}

}  // namespace prefilter
