// SPDX-License-Identifier: GPL-3.0-or-later

// Checks by hashing whether edges are traversed equally often in both directions.
#pragma once

#include <algorithm>
#include <cstdint>

namespace prefilter {

/// Two pseudorandom numbers per edge, negated for descending vertex order. For balanced edges the
/// sums are 0; for others they are 0 with a probability of 2^-128.
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

  /// Sum over the edges of a triangle.
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
