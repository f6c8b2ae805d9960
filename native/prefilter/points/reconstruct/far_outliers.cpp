// SPDX-License-Identifier: GPL-3.0-or-later

// Counts points by their distance from the mean, in bins of an eighth of an octave. A gap of an
// octave with few points beyond it ends the cloud. Far outliers move the mean, so this repeats
// without them until none are found.
#include "prefilter/points/reconstruct/far_outliers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "prefilter/points/reconstruct/point_batches.h"

namespace prefilter {
namespace {

// A single outlier among n points lies up to sqrt(n) standard deviations from the mean; scanned
// points lie within 2 to 4.
constexpr double kOutlierDeviations = 6.0;
constexpr int kMaxOutlierRounds = 8;

// Maximum number of far outliers.
std::size_t max_far_outliers(std::size_t counted) {
  return std::max(counted / 100'000, std::min<std::size_t>(counted / 1000, 3));
}

bool may_have_far_outliers(const CloudExtent& extent, std::size_t most) {
  if (most <= extent.strays) return false;
  const auto counted = static_cast<double>(extent.part.points);
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = std::max(extent.part.box.high[a] - extent.part.mean[a],
                                  extent.part.mean[a] - extent.part.box.low[a]);
    const double variance = extent.part.squares[a] / counted;
    // Squares of huge coordinates overflow, which allows no conclusion.
    if (!std::isfinite(variance) || reach > kOutlierDeviations * std::sqrt(variance)) return true;
  }
  return false;
}

// Bins of squared distances, four to an octave.
class DistanceBins {
 public:
  // Number of empty bins that correspond to a factor of 2 in distance.
  static constexpr std::size_t kGapBins = 8;

  explicit DistanceBins(const CloudExtent& extent)
      : box_(extent.part.box), middle_(extent.part.mean) {
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
    const double fraction = std::frexp(squared, &exponent);  // in [1/2, 1)
    if (!(squared > 0.0) || exponent < kMinExponent) return 0;
    return static_cast<std::size_t>(4 * (exponent - kMinExponent) +
                                    static_cast<int>(8.0 * fraction) - 4);
  }

  static constexpr std::size_t count() { return 4 * (kMaxExponent - kMinExponent + 1); }

 private:
  static constexpr int kMinExponent = -60;
  static constexpr int kMaxExponent = 3;  // squares are at most 3, or more by rounding

  Box box_;
  Vector3 middle_;
  double scale_;
};

// Extent of the points in each bin.
using Counts = std::vector<CloudPart>;

Counts count_points(PointSource* source, const DistanceBins& bins, const Run& run) {
  Counts counts(DistanceBins::count());
  for_batches<Counts>(
      source, run,
      [&](const PointBatch& batch, Counts* part) {
        part->assign(DistanceBins::count(), {});
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
          if (!is_valid_point(batch, i) || !bins.holds(batch.positions[i])) continue;
          (*part)[bins.bin_of(batch.positions[i])].include(batch.positions[i], weight_of(batch, i));
        }
      },
      [&](const Counts& part) {
        for (std::size_t b = 0; b < counts.size(); ++b) counts[b].include(part[b]);
      });
  return counts;
}

// The first bin of far outliers, if there are any.
std::optional<std::size_t> first_outlier_bin(const Counts& counts, std::size_t most) {
  std::optional<std::size_t> first;
  std::size_t beyond = 0;
  std::size_t nearest = counts.size();  // nearest occupied bin beyond b
  for (std::size_t b = counts.size(); b-- > 0;) {
    if (counts[b].points == 0) continue;
    if (nearest < counts.size() && nearest > b + DistanceBins::kGapBins) first = nearest;
    beyond += counts[b].points;
    nearest = b;
    if (beyond > most) break;
  }
  return first;
}

}  // namespace

bool may_have_far_outliers(const CloudExtent& extent) {
  return may_have_far_outliers(extent, max_far_outliers(extent.part.points));
}

void exclude_far_outliers(PointSource* source, const Run& run, CloudExtent* extent) {
  const std::size_t most = max_far_outliers(extent->part.points);
  for (int round = 0; round < kMaxOutlierRounds && may_have_far_outliers(*extent, most); ++round) {
    const DistanceBins bins(*extent);
    const Counts counts = count_points(source, bins, run);
    const std::optional<std::size_t> first = first_outlier_bin(counts, most - extent->strays);
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
