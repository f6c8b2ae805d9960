// SPDX-License-Identifier: GPL-3.0-or-later

// Planar mode (Khronos Data Format 1.3, section 21.1.5): the least-squares plane of each channel,
// rounded, then improved by trying neighbors until none is better.
#include <algorithm>
#include <cmath>

#include "prefilter/textures/blocks/etc2_search.h"

namespace prefilter {
namespace {

constexpr int kEtc2PlaneSide = 4;
constexpr int kBits[] = {6, 7, 6};

/// A channel's values at the first texel, and one block width to the right and down.
using Corners = std::array<int, 3>;

struct ChannelPlane {
  Corners corners;
  int error;
};

int expand_plane(int value, int bits) { return value << (8 - bits) | value >> (2 * bits - 8); }

int error_of(const EtcTexels& texels, std::size_t channel, const Corners& corners) {
  const int bits = kBits[channel];
  const int first = expand_plane(corners[0], bits);
  const int right = expand_plane(corners[1], bits) - first;
  const int down = expand_plane(corners[2], bits) - first;
  int error = 0;
  for (int t = 0; t < EtcTexels::kCount; ++t) {
    const auto at = static_cast<std::size_t>(t);
    const int value = (4 * first + t / kEtc2PlaneSide * right + t % kEtc2PlaneSide * down + 2) >> 2;
    error += texels.weights[at] * square(std::clamp(value, 0, 255) - texels.colors[at][channel]);
  }
  return error;
}

/// Uses all texels; those beyond the edge repeat the ones inside.
Corners least_squares(const EtcTexels& texels, std::size_t channel) {
  constexpr double kMiddle = 1.5;
  constexpr double kSquares = 20.0;  // of the distances from the middle
  double mean = 0.0, right = 0.0, down = 0.0;
  for (int t = 0; t < EtcTexels::kCount; ++t) {
    const double value = texels.colors[static_cast<std::size_t>(t)][channel];
    mean += value / EtcTexels::kCount;
    right += (t / kEtc2PlaneSide - kMiddle) * value / kSquares;
    down += (t % kEtc2PlaneSide - kMiddle) * value / kSquares;
  }
  const double first = mean - kMiddle * (right + down);
  const int most = (1 << kBits[channel]) - 1;
  Corners corners{};
  const double values[] = {first, first + kEtc2PlaneSide * right, first + kEtc2PlaneSide * down};
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = static_cast<int>(std::floor(std::clamp(values[i], 0.0, 255.0) / 255 * most + 0.5));
  }
  return corners;
}

ChannelPlane search(const EtcTexels& texels, std::size_t channel, bool is_flat) {
  const int most = (1 << kBits[channel]) - 1;
  ChannelPlane best{least_squares(texels, channel), 0};
  best.error = error_of(texels, channel, best.corners);
  for (bool is_better = true; is_better;) {
    is_better = false;
    const Corners middle = best.corners;
    // Flat planes try only the first, middle and last neighbor, which change all corners equally.
    for (int neighbor = 0; neighbor < 27; neighbor += is_flat ? 13 : 1) {
      const Corners next{std::clamp(middle[0] + neighbor / 9 - 1, 0, most),
                         std::clamp(middle[1] + neighbor / 3 % 3 - 1, 0, most),
                         std::clamp(middle[2] + neighbor % 3 - 1, 0, most)};
      const int error = error_of(texels, channel, next);
      if (error >= best.error) continue;
      best = {next, error};
      is_better = true;
    }
  }
  return best;
}

std::uint64_t packed(const Corners& red, const Corners& green, const Corners& blue) {
  const auto at = [](int value, int place) { return static_cast<std::uint64_t>(value) << place; };
  const OverflowBits leaving = overflow_bits(blue[0] >> 3 & 3, blue[0] >> 1 & 3);
  std::uint64_t bits = at(red[0], 57) | at(green[0] >> 6, 56) | at(green[0] & 63, 49);
  bits |= bit_within(red[0] >> 2, (red[0] & 3) << 1 | green[0] >> 6) << 63;
  bits |= bit_within(green[0] >> 2 & 15, (green[0] & 3) << 1 | blue[0] >> 5) << 55;
  bits |= at(blue[0] >> 5, 48) | leaving.upper << 45 | at(blue[0] >> 3 & 3, 43);
  bits |= leaving.sign << 42 | at(blue[0] & 7, 39);
  bits |= at(red[1] >> 1, 34) | at(1, 33) | at(red[1] & 1, 32);
  bits |= at(green[1], 25) | at(blue[1], 19);
  return bits | at(red[2], 13) | at(green[2], 6) | at(blue[2], 0);
}

}  // namespace

EtcBlock search_etc_plane(const EtcTexels& texels) {
  const bool is_flat = std::all_of(texels.colors.begin(), texels.colors.end(),
                                   [&](const EtcColor& one) { return one == texels.colors[0]; });
  const ChannelPlane red = search(texels, 0, is_flat);
  const ChannelPlane green = search(texels, 1, is_flat);
  const ChannelPlane blue = search(texels, 2, is_flat);
  return {packed(red.corners, green.corners, blue.corners), red.error + green.error + blue.error};
}

}  // namespace prefilter
