// SPDX-License-Identifier: GPL-3.0-or-later

// Coordinates along x and y, worked out together by the processor.
#pragma once

#include <cmath>
#include <cstdint>

#include "prefilter/base/vectors.h"

namespace prefilter {

using Pair = Vector<double, 2>;

inline Pair floor_pair(Pair values) { return Pair{std::floor(values[0]), std::floor(values[1])}; }

/// Whether both numbers lie from `low` to `high`.
inline bool is_between(Pair low, Pair values, Pair high) {
  const auto found = (values >= low) & (values <= high);
  return (found[0] & found[1]) != 0;
}

/// How far a texel lies from the first one of its level, where texels and rows are as far apart as
/// `pitches` says. Modulo 2^64, as addresses are added.
inline std::uintptr_t distance(Pair texel, Pair pitches) {
  const Pair parts = texel * pitches;
  return static_cast<std::uintptr_t>(static_cast<std::int64_t>(parts[0] + parts[1]));
}

}  // namespace prefilter
