// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/feature_turning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace prefilter {
namespace {

constexpr double kFarCells = 1.0;  // maximum distance of a feature from its loop
constexpr double kAbove = 0.05;  // cells; minimum height of a vertex over the side of its triangle
constexpr double kLeastAcross = 0.1;  // minimum slope of the edge relative to a side
constexpr double kGapShare = 0.45;    // maximum share of the way to the next vertex
constexpr double kMostAside = 0.2;  // cells; maximum distance of the found position from the target
}  // namespace

struct FeatureTurning::Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  // Excludes positions where `height`, which changes at a constant rate, is below `least`.
  void keep_above(double height, double rate, double least) {
    if (rate >= kLeastAcross) low = std::max(low, (least - height) / rate);
    if (rate <= -kLeastAcross) high = std::min(high, (least - height) / rate);
  }
  bool is_empty() const { return low > high; }
  Range within(const Range& other) const {
    return {std::max(low, other.low), std::min(high, other.high)};
  }
};

FeatureTurning::Range FeatureTurning::upright_range(std::size_t loop,
                                                    std::span<const Feature> features,
                                                    const Vector3& along) const {
  const Vector3& at = features[loop].position;
  const auto stay_above = [&](const Vector3& a, const Vector3& b, std::int32_t vertex,
                              Range* range) {
    const SourcePoint* sample = samples_.of(vertex);
    if (sample == nullptr) return;
    const Vector3 across = cross(sample->normal, b - a);
    const double side = length(across);
    if (!(side > 0.0)) return;
    const Vector3 up = ((turned_.contains(sample->label) ? -1.0 : 1.0) / side) * across;
    range->keep_above(dot(at - a, up), dot(along, up), kAbove * cell_);
  };
  const SharpLoop& corners = loops_.loops[loop];
  Range of_sides;
  Range of_joints;
  for (std::size_t k = 0; k < loops_.side_count(loop); ++k) {
    const Vector3& from = positions_[static_cast<std::size_t>(corners.from(k))];
    const Vector3& to = positions_[static_cast<std::size_t>(corners.to(k))];
    if (!loops_.is_joined(loop, k, is_sharp_)) {
      stay_above(from, to, corners.from(k), &of_sides);
      continue;
    }
    const auto other = static_cast<std::size_t>(loops_.sides[loop][k].other);
    stay_above(from, features[other].position, corners.from(k), &of_joints);
    stay_above(features[other].position, to, corners.to(k), &of_joints);
  }
  // Joined neighbors can move as well, so their limits are secondary.
  const Range all = of_sides.within(of_joints);
  return all.is_empty() ? of_sides : all;
}

std::optional<Vector3> FeatureTurning::place(std::size_t loop,
                                             std::span<const Feature> features) const {
  const Feature& feature = features[loop];
  const std::vector<std::size_t> others = loops_.joined(loop, is_sharp_);
  if (feature.is_corner || others.size() != 2) return std::nullopt;
  if (length(feature.position - feature.start) < kFarCells * cell_) return std::nullopt;
  const Vector3& last = features[others[0]].position;
  const Vector3& next = features[others[1]].position;
  const double gap = length(next - last);
  if (!(gap > kAbove * cell_)) return std::nullopt;
  const Vector3 along = (1.0 / gap) * (next - last);
  const Range range = upright_range(loop, features, along);
  if (range.is_empty() || (range.low <= 0.0 && range.high >= 0.0)) return std::nullopt;
  const Vector3& at = feature.position;
  const double way = std::clamp(range.low > 0.0 ? range.low : range.high,
                                kGapShare * std::min(0.0, dot(last - at, along)),
                                kGapShare * std::max(0.0, dot(next - at, along)));
  const Vector3 wanted = at + way * along;
  const std::optional<Vector3> found = places_.place(wanted, feature.labels);
  if (!found || length(*found - wanted) > kMostAside * cell_) return std::nullopt;
  return found;
}

}  // namespace prefilter
