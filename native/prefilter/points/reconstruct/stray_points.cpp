// SPDX-License-Identifier: GPL-3.0-or-later

// Points are counted by their distance from the mean, in bins of an eighth of an octave: a gap of
// an octave with few points beyond it ends the cloud. Strays move the mean, so it is done again
// without them until there are none.
#include "prefilter/points/reconstruct/stray_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "prefilter/points/reconstruct/point_batches.h"

namespace prefilter {
namespace {

// One point far away of n makes the largest distance as many standard deviations as the square root
// of n; what a scanner sees has about 2 to 4.
constexpr double kFarDeviations = 6.0;
constexpr int kMostRounds = 8;

// How many points may be strays.
std::size_t most_strays(std::size_t counted) {
  return std::max(counted / 100'000, std::min<std::size_t>(counted / 1000, 3));
}

bool may_have_strays(const CloudExtent& extent, std::size_t most) {
  if (most <= extent.strays) return false;
  const auto counted = static_cast<double>(extent.part.points);
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = std::max(extent.part.box.high[a] - extent.part.mean[a],
                                  extent.part.mean[a] - extent.part.box.low[a]);
    const double variance = extent.part.squares[a] / counted;
    // Squares of huge coordinates are no numbers, and tell nothing.
    if (!std::isfinite(variance) || reach > kFarDeviations * std::sqrt(variance)) return true;
  }
  return false;
}

// Bins of squared distances, four to an octave.
class Bins {
 public:
  // A gap of so many bins is a factor of 2 in distance.
  static constexpr std::size_t kGap = 8;

  explicit Bins(const CloudExtent& extent) : box_(extent.part.box), middle_(extent.part.mean) {
    double reach = 0.0;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      reach = std::max({reach, box_.high[i] - middle_[i], middle_[i] - box_.low[i]});
    }
    scale_ = 1.0 / reach;
  }

  bool holds(const Vector3& point) const { return box_.squared_distance(point) == 0.0; }

  std::size_t bin_of(const Vector3& point) const {
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double off = scale_ * (point[a] - middle_[a]);
      squared += off * off;
    }
    int exponent = 0;
    const double fraction = std::frexp(squared, &exponent);  // from 1/2 on, below 1
    if (!(squared > 0.0) || exponent < kLeastExponent) return 0;
    return static_cast<std::size_t>(4 * (exponent - kLeastExponent) +
                                    static_cast<int>(8.0 * fraction) - 4);
  }

  static constexpr std::size_t count() { return 4 * (kMostExponent - kLeastExponent + 1); }

 private:
  static constexpr int kLeastExponent = -60;
  static constexpr int kMostExponent = 3;  // of squares up to 3, which rounding may exceed

  Box box_;
  Vector3 middle_;
  double scale_;
};

// What is in each bin.
using Counts = std::vector<CloudPart>;

Counts count_points(PointSource* source, const Bins& bins, const Progress& progress, int threads) {
  Counts counts(Bins::count());
  for_batches<Counts>(
      source, progress, threads,
      [&](const PointBatch& batch, Counts* part) {
        part->assign(Bins::count(), {});
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
          if (!does_count(batch, i) || !bins.holds(batch.positions[i])) continue;
          (*part)[bins.bin_of(batch.positions[i])].include(batch.positions[i], weight_of(batch, i));
        }
      },
      [&](const Counts& part) {
        for (std::size_t b = 0; b < counts.size(); ++b) counts[b].include(part[b]);
      });
  return counts;
}

// The first bin of strays; none where there are none.
std::optional<std::size_t> first_stray(const Counts& counts, std::size_t most) {
  std::optional<std::size_t> found;
  std::size_t beyond = 0;
  std::size_t nearest = counts.size();  // of those beyond
  for (std::size_t b = counts.size(); b-- > 0;) {
    if (counts[b].points == 0) continue;
    if (nearest < counts.size() && nearest > b + Bins::kGap) found = nearest;
    beyond += counts[b].points;
    nearest = b;
    if (beyond > most) break;
  }
  return found;
}

}  // namespace

bool may_have_strays(const CloudExtent& extent) {
  return may_have_strays(extent, most_strays(extent.part.points));
}

void leave_out_strays(PointSource* source, const Progress& progress, int threads,
                      CloudExtent* extent) {
  const std::size_t most = most_strays(extent->part.points);
  for (int round = 0; round < kMostRounds && may_have_strays(*extent, most); ++round) {
    const Bins bins(*extent);
    const Counts counts = count_points(source, bins, progress, threads);
    const std::optional<std::size_t> first = first_stray(counts, most - extent->strays);
    if (!first) return;
    CloudPart near;
    for (std::size_t b = 0; b < *first; ++b) near.include(counts[b]);
    extent->strays += extent->part.points - near.points;
    extent->part = near;
  }
}

bool PointsWithin::read(std::size_t most, PointBatch* batch) {
  if (!source_->read(most, batch)) return false;
  for (std::size_t i = 0; i < batch->positions.size(); ++i) {
    if (box_.squared_distance(batch->positions[i]) == 0.0) continue;
    batch->weights.resize(batch->positions.size(), 1.0F);
    batch->weights[i] = 0.0F;
  }
  return true;
}

}  // namespace prefilter
