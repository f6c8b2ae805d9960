// SPDX-License-Identifier: GPL-3.0-or-later

// Chooses the sharp loops that must change so that triangles do not intersect.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

/// A loop that has a triangle of an intersecting pair.
struct BlamedLoop {
  std::int32_t loop;
  std::size_t pair;

  bool operator<(const BlamedLoop& other) const {
    return loop != other.loop ? loop < other.loop : pair < other.pair;
  }
};

/// Greedy cover: chooses loops such that each pair has one, the loop with the most pairs first (the
/// first one in case of a tie), then the loop with the most remaining pairs, and so on.
std::vector<std::size_t> fewest_loops(std::vector<BlamedLoop> blamed, std::size_t pair_count);

}  // namespace prefilter
