// SPDX-License-Identifier: GPL-3.0-or-later

// Code specialized for each number of channels, in pairs of channels.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "prefilter/base/double_pair.h"
#include "prefilter/base/image.h"
#include "prefilter/shapes/paint.h"

namespace prefilter {

/// Returns use(std::integral_constant<int, channels>).
template <typename Use>
auto with_channel_count(int channels, const Use& use) {
  static_assert(kMaxChannels == 4);
  if (channels == 1) return use(std::integral_constant<int, 1>());
  if (channels == 2) return use(std::integral_constant<int, 2>());
  if (channels == 3) return use(std::integral_constant<int, 3>());
  return use(std::integral_constant<int, 4>());
}

/// The channels of a value in pairs; an odd last one is paired with an unused value.
template <int C>
using ChannelPairs = std::array<DoublePair, (C + 1) / 2>;

template <int C>
ChannelPairs<C> channel_pairs(const ChannelValues& values) {
  ChannelPairs<C> pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = load_pair(values.data() + 2 * i);
  return pairs;
}

/// Adds value_of(i), pair i of C channels, to a pixel.
template <int C, typename ValueOf>
void add_pairs(const ValueOf& value_of, double* pixel) {
  for (std::size_t i = 0; i < C / 2; ++i) {
    store_pair(pixel + 2 * i, load_pair(pixel + 2 * i) + value_of(i));
  }
  if constexpr (C % 2 == 1) pixel[C - 1] += value_of(C / 2)[0];
}

}  // namespace prefilter
