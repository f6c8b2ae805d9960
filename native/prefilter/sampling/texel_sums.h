// SPDX-License-Identifier: GPL-3.0-or-later

// Weighted sums of texels, for groups of up to four channels.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
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

/// Converts the four bytes of a word, the lowest first.
inline Lanes lanes_of_bytes(std::uint32_t word) {
  using Bytes = Vector<std::uint8_t, 16>;
  using Words = Vector<std::int32_t, 4>;
  const auto bytes = std::bit_cast<Bytes>(Words{static_cast<std::int32_t>(word), 0, 0, 0});
  const Bytes zeros{};
  const Bytes wide =
      shuffle<0, 16, 16, 16, 1, 16, 16, 16, 2, 16, 16, 16, 3, 16, 16, 16>(bytes, zeros);
  return convert<Lanes>(std::bit_cast<Words>(wide));
}

inline Lanes load_lanes(const std::uint8_t* values) {
  std::uint32_t word;
  std::memcpy(&word, values, sizeof word);
  return lanes_of_bytes(word);
}

/// One or two channels.
template <int kCount>
struct FewChannels {
  std::array<float, kCount> values{};

  template <typename Value>
  static FewChannels load(const Value* texel) {
    FewChannels loaded;
    for (int c = 0; c < kCount; ++c) loaded.values[c] = static_cast<float>(texel[c]);
    return loaded;
  }
  void store(float* result) const { std::memcpy(result, values.data(), sizeof values); }

  FewChannels& operator+=(const FewChannels& other) {
    for (int c = 0; c < kCount; ++c) values[c] += other.values[c];
    return *this;
  }
  FewChannels& operator-=(const FewChannels& other) {
    for (int c = 0; c < kCount; ++c) values[c] -= other.values[c];
    return *this;
  }
  FewChannels operator*(float factor) const {
    FewChannels product;
    for (int c = 0; c < kCount; ++c) product.values[c] = values[c] * factor;
    return product;
  }
};

/// Three values, padded with 0.
inline Lanes load_three(const float* values) {
  return Lanes{values[0], values[1], values[2], 0.0F};
}

inline Lanes load_three(const std::uint8_t* values) {
  return lanes_of_bytes(values[0] | std::uint32_t{values[1]} << 8U |
                        std::uint32_t{values[2]} << 16U);
}

/// Three or four channels.
template <int kCount>
struct ManyChannels {
  Lanes values{};

  template <typename Value>
  static ManyChannels load(const Value* texel) {
    return {kCount == 4 ? load_lanes(texel) : load_three(texel)};
  }
  void store(float* result) const { std::memcpy(result, &values, kCount * sizeof(float)); }

  ManyChannels& operator+=(const ManyChannels& other) {
    values += other.values;
    return *this;
  }
  ManyChannels& operator-=(const ManyChannels& other) {
    values -= other.values;
    return *this;
  }
  ManyChannels operator*(float factor) const { return {values * all_lanes(factor)}; }
};

template <typename Channels>
inline Channels mix(const Channels& a, const Channels& b, float share) {
  Channels mixed = b;
  mixed -= a;
  mixed = mixed * share;
  mixed += a;
  return mixed;
}

/// Calls body<ManyChannels<4>>(channel) for each group of four channels, and once for the remaining
/// ones.
template <typename Body>
inline void for_channels(int channels, const Body& body) {
  int channel = 0;
  for (; channel + 4 <= channels; channel += 4) body.template operator()<ManyChannels<4>>(channel);
  switch (channels - channel) {
    case 3:
      body.template operator()<ManyChannels<3>>(channel);
      break;
    case 2:
      body.template operator()<FewChannels<2>>(channel);
      break;
    case 1:
      body.template operator()<FewChannels<1>>(channel);
      break;
    default:
      break;
  }
}

}  // namespace prefilter
