// SPDX-License-Identifier: GPL-3.0-or-later

// Which sharp loops have to change, for triangles not to intersect.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

/// A loop that has a triangle of a pair.
struct BlamedLoop {
  std::int32_t loop;
  std::size_t pair;

  bool operator<(const BlamedLoop& other) const {
    return loop != other.loop ? loop < other.loop : pair < other.pair;
  }
};

/// Loops so that each pair that any is blamed for has one of them: the one with the most pairs
/// first, of several the first, then the one with the most of those left, and so on.
std::vector<std::size_t> fewest_loops(std::vector<BlamedLoop> blamed, std::size_t pair_count);

}  // namespace prefilter
