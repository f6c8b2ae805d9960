// SPDX-License-Identifier: GPL-3.0-or-later

// Positions and widths of samples in an image.
#pragma once

#include <array>
#include <span>

namespace prefilter {

/// A position in an image: (u, v), from 0 to 1 over its sides.
using TexturePlace = std::array<double, 2>;

/// [[dx/di, dx/dj], [dy/di, dy/dj]]: derivatives of the position (x, y), in texels of level 0, by
/// the pixel coordinates i, j.
using TextureJacobian = std::array<double, 4>;

struct SamplePlaces {
  std::span<const TexturePlace> coordinates;
  // Widths of the filter's unit in texels of level 0: one for all samples, or one each.
  std::span<const double> scales;

  double scale(std::size_t sample) const { return scales[scales.size() == 1 ? 0 : sample]; }
};

// These throw Error. `first` is the index of the first sample, for error messages.

/// Throws Error unless all coordinates are finite.
void check_coordinates(std::span<const TexturePlace> coordinates, std::size_t first = 0);

/// Throws Error unless all scales are finite and nonnegative.
void check_scales(std::span<const double> scales, std::size_t first = 0);

/// Throws Error unless there is one scale, or one for each sample.
void check_scale_count(const SamplePlaces& places);

/// Performs all of the checks above.
void check_places(const SamplePlaces& places);

/// Throws Error unless there is a finite Jacobian for each sample.
void check_jacobians(std::span<const TextureJacobian> jacobians, std::size_t samples);

}  // namespace prefilter
