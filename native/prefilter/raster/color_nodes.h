// SPDX-License-Identifier: GPL-3.0-or-later

// Colors on a cell as polynomials of degree 2, by what they are at nine places in it.
#pragma once

#include <array>
#include <cstddef>

#include "prefilter/raster/paint.h"

namespace prefilter {

/// Of 1, u, v, u^2, u v, v^2, in the coordinates from a cell's center.
using ColorPowers = std::array<double, 6>;

/// The exponents of u and v in ColorPowers.
inline constexpr std::array<std::array<int, 2>, 6> kColorExponents = {
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};

/// Where a color is told that is no polynomial: three points along each axis, by Gauss's rule.
inline constexpr std::size_t kColorNodes = 9;
/// Along an axis, from the cell's center, in cells. Those along x follow each other.
inline constexpr std::array<double, 3> kColorNodePlaces = {-0.38729833462074170, 0.0,
                                                           0.38729833462074170};
constexpr Point2 color_node(std::size_t index) {
  return {kColorNodePlaces[index % 3], kColorNodePlaces[index / 3]};
}
/// Adds what a value there is of the polynomial that is nearest in the mean square.
void add_color_node(std::size_t index, const ChannelValues& value, int channels,
                    std::array<ColorPowers, kMaxChannels>* powers);
/// The same of all of one channel.
ColorPowers powers_of_nodes(const std::array<double, kColorNodes>& values);

}  // namespace prefilter
