#include "prefilter/sampling/sample_places.h"

#include <cmath>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {

void check_coordinates(std::span<const TexturePlace> coordinates, std::size_t first) {
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    for (const double coordinate : coordinates[i]) {
      if (std::isfinite(coordinate)) continue;
      throw_invalid("coordinates: found " + to_text(coordinate) + " in row " +
                    std::to_string(first + i) + "; finite numbers are needed");
    }
  }
}

void check_scales(std::span<const double> scales, std::size_t first) {
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
