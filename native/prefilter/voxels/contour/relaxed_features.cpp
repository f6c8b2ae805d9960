// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/relaxed_features.h"

#include <algorithm>
#include <optional>

namespace prefilter {
namespace {

constexpr int kRelaxedFeaturesRings = 2;
constexpr int kSmoothings = 4;
constexpr int kTurnings = 8;

void sort_unique(std::vector<std::size_t>* values) {
  std::sort(values->begin(), values->end());
  values->erase(std::unique(values->begin(), values->end()), values->end());
}
}  // namespace

std::vector<std::size_t> relax_features(std::vector<std::size_t> moving, const LinkedLoops& loops,
                                        std::span<const std::uint8_t> is_sharp,
                                        const FeaturePlaces& places, const FeatureTurning& turning,
                                        std::vector<Feature>* features) {
  for (int ring = 0; ring < kRelaxedFeaturesRings; ++ring) {
    std::vector<std::size_t> wider = moving;
    for (const std::size_t i : moving) {
      const std::vector<std::size_t> others = loops.joined(i, is_sharp);
      wider.insert(wider.end(), others.begin(), others.end());
    }
    sort_unique(&wider);
    moving.swap(wider);
  }
  std::vector<Vector3> moved(moving.size());
  for (int step = 0; step < kSmoothings; ++step) {
    for (std::size_t m = 0; m < moving.size(); ++m) {
      const Feature& feature = (*features)[moving[m]];
      moved[m] = feature.position;
      const std::vector<std::size_t> others = loops.joined(moving[m], is_sharp);
      if (feature.is_corner || others.size() != 2) continue;
      const Vector3 middle =
          0.5 * ((*features)[others[0]].position + (*features)[others[1]].position);
      const std::optional<Vector3> found =
          places.place(0.5 * (feature.position + middle), feature.labels);
      if (found) moved[m] = *found;
    }
    for (std::size_t m = 0; m < moving.size(); ++m) (*features)[moving[m]].position = moved[m];
  }
  for (int step = 0; step < kTurnings; ++step) {
    for (const std::size_t i : moving) {
      const std::optional<Vector3> found = turning.place(i, *features);
      if (found) (*features)[i].position = *found;
    }
  }
  return moving;
}

}  // namespace prefilter
