// SPDX-License-Identifier: GPL-3.0-or-later

// Where and how wide samples of an image are.
#pragma once

#include <array>
#include <span>

namespace prefilter {

/// A place in an image: u, v, which span it from 0 to 1.
using TexturePlace = std::array<double, 2>;

/// [[dx/di, dx/dj], [dy/di, dy/dj]]: how texels x, y of level 0 change with pixels i, j.
using TextureJacobian = std::array<double, 4>;

struct SamplePlaces {
  std::span<const TexturePlace> coordinates;
  // The width of the filter's unit in texels of level 0: one for all samples, or one each.
  std::span<const double> scales;

  double scale(std::size_t sample) const { return scales[scales.size() == 1 ? 0 : sample]; }
};

// These throw Error. `first` is the number of the first sample, which messages count from.

/// Unless all coordinates are finite.
void check_coordinates(std::span<const TexturePlace> coordinates, std::size_t first = 0);

/// Unless all scales are finite, and none is negative.
void check_scales(std::span<const double> scales, std::size_t first = 0);

/// Unless there is one scale, or one for each sample.
void check_scale_count(const SamplePlaces& places);

/// All of these.
void check_places(const SamplePlaces& places);

/// Unless there is a Jacobian for each sample, and all are finite.
void check_jacobians(std::span<const TextureJacobian> jacobians, std::size_t samples);

}  // namespace prefilter
