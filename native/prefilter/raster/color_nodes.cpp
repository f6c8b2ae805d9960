// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/color_nodes.h"

namespace prefilter {
namespace {

constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

// What a value of 1 at a node adds to the powers: Legendre's polynomials, each over the integral of
// its square.
constexpr std::array<ColorPowers, kColorNodes> kTerms = [] {
  std::array<ColorPowers, kColorNodes> terms{};
  for (std::size_t i = 0; i < kColorNodes; ++i) {
    const auto [u, v] = color_node(i);
    const double weight = kWeights[i % 3] * kWeights[i / 3];
    const double uu = 180.0 * (u * u - 1.0 / 12.0);
    const double vv = 180.0 * (v * v - 1.0 / 12.0);
    terms[i] = {weight * (1.0 - (uu + vv) / 12.0),
                weight * 12.0 * u,
                weight * 12.0 * v,
                weight * uu,
                weight * 144.0 * u * v,
                weight * vv};
  }
  return terms;
}();

}  // namespace

void add_color_node(std::size_t index, const ChannelValues& value, int channels,
                    std::array<ColorPowers, kMaxChannels>* powers) {
  for (int c = 0; c < channels; ++c) {
    for (std::size_t k = 0; k < ColorPowers().size(); ++k) {
      (*powers)[c][k] += value[c] * kTerms[index][k];
    }
  }
}

ColorPowers powers_of_nodes(const std::array<double, kColorNodes>& values) {
  ColorPowers powers{};
  for (std::size_t i = 0; i < kColorNodes; ++i) {
    for (std::size_t k = 0; k < powers.size(); ++k) powers[k] += values[i] * kTerms[i][k];
  }
  return powers;
}

}  // namespace prefilter
