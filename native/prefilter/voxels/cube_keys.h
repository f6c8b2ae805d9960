// SPDX-License-Identifier: GPL-3.0-or-later

// Numbers of the cubes of a grid, for tables of those that hold something.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// That of the cube of this side which holds a point; far away the last ones.
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
