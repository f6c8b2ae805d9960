// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/measured_cloud.h"

#include <numeric>
#include <utility>

#include "prefilter/points/reconstruct/reconstruct_checks.h"

namespace prefilter {
namespace {

// Estimating normals requires all points in memory. In clouds larger than this, up to one in a
// thousand points may lack a normal and is dropped instead.
constexpr std::size_t kManyPoints = 10'000'000;
constexpr std::size_t kPointsPerMissing = 1000;

}  // namespace

MeasuredCloud::MeasuredCloud(PointSource* source, bool collects_thinned, const Run& run)
    : points_(source) {
  RepeatedPositions repeated;
  const auto measure = [&](const Run& part, RepeatedPositions* all) {
    thinned_ = ThinnedPoints();
    extent_ = measure_cloud(points_, part, collects_thinned ? &thinned_ : nullptr, all);
  };
  const Stages stages(run, {8, 1, 1});
  measure(stages[0], &repeated);
  phantoms_ = find_phantoms(repeated, source, stages[1]);
  if (!phantoms_.empty()) {
    points_ = &real_.emplace(source, phantoms_);
    measure(stages[2], nullptr);
  }
  extent_.settle_huge();
}

bool MeasuredCloud::lacks_normals() const {
  const std::size_t missing = extent_.dropped.normalless;
  return missing > 0 &&
         (extent_.points < kManyPoints || missing > extent_.points / kPointsPerMissing);
}

void MeasuredCloud::exclude_outliers(const Run& run) {
  check_cloud(extent_);
  exclude_far_outliers(points_, run, &extent_);
  if (extent_.strays == 0 && extent_.dropped.huge == 0) return;
  points_ = &near_.emplace(points_, extent_.part.box);
}

std::size_t MeasuredCloud::phantom_points() const {
  return std::accumulate(
      phantoms_.begin(), phantoms_.end(), std::size_t{0},
      [](std::size_t sum, const PhantomPlace& place) { return sum + place.points; });
}

}  // namespace prefilter
