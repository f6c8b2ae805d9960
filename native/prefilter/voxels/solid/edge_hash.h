// SPDX-License-Identifier: GPL-3.0-or-later

// Whether edges are run through as often one way as the other, by sums.
#pragma once

#include <algorithm>
#include <cstdint>

namespace prefilter {

/// Two numbers of an edge that are as good as drawn at random, negative for the way down. Those of
/// edges that are run through as often one way as the other sum up to 0, others with a chance of
/// 2^-128.
struct EdgeHash {
  std::uint64_t first = 0;
  std::uint64_t second = 0;

  static EdgeHash of(std::int64_t from, std::int64_t to) {
    if (from == to) return {};
    const auto low = static_cast<std::uint64_t>(std::min(from, to));
    const auto high = static_cast<std::uint64_t>(std::max(from, to));
    const std::uint64_t edge = (low << 32U) | high;
    const EdgeHash hash = {mixed(edge + 0x9E3779B97F4A7C15U), mixed(~edge)};
    return from < to ? hash : EdgeHash{0 - hash.first, 0 - hash.second};
  }

  /// The sum of a triangle's edges.
  static EdgeHash of(std::int64_t a, std::int64_t b, std::int64_t c) {
    EdgeHash sum = of(a, b);
    sum += of(b, c);
    sum += of(c, a);
    return sum;
  }

  EdgeHash& operator+=(const EdgeHash& other) {
    first += other.first;
    second += other.second;
    return *this;
  }

  bool is_zero() const { return first == 0 && second == 0; }

 private:
  static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31U);
  }
};

}  // namespace prefilter
