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

/// Calls visit(key) for a cube and the 26 around it.
template <typename Visit>
void for_cubes_around(std::uint64_t key, const Visit& visit) {
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const std::int64_t step = (std::int64_t{x} * (std::int64_t{1} << 42)) +
                                  (std::int64_t{y} * (std::int64_t{1} << 21)) + z;
        visit(key + static_cast<std::uint64_t>(step));
      }
    }
  }
}

}  // namespace prefilter
