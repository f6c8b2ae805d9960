// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/sample_places.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {

/// Whether all values are finite and at least `low`. The loop has no early exit, so that it can be
/// vectorized.
bool are_finite(const double* values, std::size_t count, double low) {
  std::int64_t others = 0;
  for (std::size_t i = 0; i < count; ++i) {
    others |= static_cast<std::int64_t>(!(values[i] >= low));
    others |= static_cast<std::int64_t>(!(values[i] <= std::numeric_limits<double>::max()));
  }
  return others == 0;
}

}  // namespace

void check_coordinates(std::span<const TexturePlace> coordinates, std::size_t first) {
  const double* const values = reinterpret_cast<const double*>(coordinates.data());
  if (are_finite(values, 2 * coordinates.size(), std::numeric_limits<double>::lowest())) return;
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    for (const double coordinate : coordinates[i]) {
      if (std::isfinite(coordinate)) continue;
      throw_invalid("coordinates: found " + to_text(coordinate) + " in row " +
                    std::to_string(first + i) + "; finite numbers are needed");
    }
  }
}

void check_scales(std::span<const double> scales, std::size_t first) {
  if (are_finite(scales.data(), scales.size(), 0.0)) return;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    if (scales[i] >= 0.0 && std::isfinite(scales[i])) continue;
    throw_invalid("scales: found " + to_text(scales[i]) + " at " + std::to_string(first + i) +
                  "; finite numbers of at least 0 are needed");
  }
}

void check_scale_count(const SamplePlaces& places) {
  if (places.scales.size() == 1 || places.scales.size() == places.coordinates.size()) return;
  throw_invalid("scales: found " + std::to_string(places.scales.size()) + "; " +
                std::to_string(places.coordinates.size()) +
                ", as many as coordinates, or one are needed");
}

void check_places(const SamplePlaces& places) {
  check_scale_count(places);
  check_coordinates(places.coordinates);
  check_scales(places.scales);
}

void check_jacobians(std::span<const TextureJacobian> jacobians, std::size_t samples) {
  if (jacobians.size() != samples) {
    throw_invalid("jacobians: " + std::to_string(jacobians.size()) + " for " +
                  std::to_string(samples) + " samples; one for each is needed");
  }
  for (std::size_t i = 0; i < jacobians.size(); ++i) {
    for (const double value : jacobians[i]) {
      if (std::isfinite(value)) continue;
      throw_invalid("jacobians: found " + to_text(value) + " in that of sample " +
                    std::to_string(i) + "; finite numbers are needed");
    }
  }
}

}  // namespace prefilter
