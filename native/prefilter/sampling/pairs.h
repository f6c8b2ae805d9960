// SPDX-License-Identifier: GPL-3.0-or-later

// SIMD pairs of x and y coordinates.
#pragma once

#include <cmath>
#include <cstdint>

#include "prefilter/base/vectors.h"

namespace prefilter {

using Pair = Vector<double, 2>;

inline Pair floor_pair(Pair values) { return Pair{std::floor(values[0]), std::floor(values[1])}; }

/// Whether both values are from `low` to `high`.
inline bool is_between(Pair low, Pair values, Pair high) {
  const auto mask = (values >= low) & (values <= high);
  return (mask[0] & mask[1]) != 0;
}

/// Offset of a texel from the first one of its level, with `pitches` as the strides of texels and
/// rows. Modulo 2^64, like address arithmetic.
inline std::uintptr_t texel_offset(Pair texel, Pair pitches) {
  const Pair parts = texel * pitches;
  return static_cast<std::uintptr_t>(static_cast<std::int64_t>(parts[0] + parts[1]));
}

}  // namespace prefilter
