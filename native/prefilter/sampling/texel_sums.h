// Weighted sums of texels.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "prefilter/base/lanes.h"

namespace prefilter {

inline Lanes all_lanes(float value) { return Lanes{value, value, value, value}; }

inline Lanes load_lanes(const float* values) {
  Lanes lanes;
  std::memcpy(&lanes, values, sizeof lanes);
  return lanes;
}

/// Four bytes as numbers.
inline Lanes load_lanes(const std::uint8_t* values) {
  using Bytes [[gnu::vector_size(16)]] = std::uint8_t;
  using Words [[gnu::vector_size(16)]] = std::int32_t;
  std::int32_t word;
  std::memcpy(&word, values, sizeof word);
  const auto bytes = reinterpret_cast<Bytes>(Words{word, 0, 0, 0});
  const Bytes zeros{};
  const Bytes wide = __builtin_shufflevector(bytes, zeros, 0, 16, 16, 16, 1, 16, 16, 16, 2, 16, 16,
                                             16, 3, 16, 16, 16);
  return __builtin_convertvector(reinterpret_cast<Words>(wide), Lanes);
}

}  // namespace prefilter
