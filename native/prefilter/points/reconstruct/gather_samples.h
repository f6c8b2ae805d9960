// SPDX-License-Identifier: GPL-3.0-or-later

// Points to sums of samples in cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/float_steps.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/carried_depth.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/sample_store.h"

namespace prefilter {

class NormalProbe;
class RepeatedPositions;

/// Where points are.
struct CloudPart {
  Box box = kEmptyBox;
  std::size_t points = 0;
  double weight = 0.0;
  Vector3 mean{};
  Vector3 squares{};  // of the distances from the mean along each axis, summed

  void include(const Vector3& point, double point_weight);
  void include(const CloudPart& other);
};

/// What a first look at a cloud finds.
struct CloudExtent {
  CloudPart part;          // of the points that count
  CloudPart huge;          // of those that would count, but have huge coordinates
  std::size_t points = 0;  // that there are
  DroppedPoints dropped;
  std::size_t strays = 0;  // that are far from all others
  FloatSteps steps;        // of the points that count

  /// Decides whether points with huge coordinates count, once all points have been looked at.
  void settle_huge();
};

/// Reads the source once. Where `some` is not null, it gets some of the points that count; and
/// `repeated` the positions at which there may be many. The extent is not settled yet.
CloudExtent measure_cloud(PointSource* source, const Progress& progress, int threads,
                          ThinnedPoints* some = nullptr, RepeatedPositions* repeated = nullptr);

/// Reads the source again, and puts all points that count into cells. The same to rounding for
/// points in any order, and to the last bit for any number of threads. Clouds that are joined are
/// summed up each by itself, so that machines may do that, and then one after the other. Where
/// `probe` is not null, it looks at all points on the way.
void gather_samples(PointSource* source, const SampleGrid& grid, const Progress& progress,
                    int threads, SampleStore* store, NormalProbe* probe = nullptr);

/// Of a batch, the points that count, in the order of their cells: keys and, in the lowest
/// kBatchBits bits, indices.
class PointOrder {
 public:
  static constexpr int kBatchBits = 17;
  static constexpr std::size_t kMostPoints = std::size_t{1} << kBatchBits;

  const std::vector<std::uint64_t>& sort(const PointBatch& batch, const SampleGrid& grid);

  static CellKey key(std::uint64_t entry) { return entry >> kBatchBits; }
  static std::size_t index(std::uint64_t entry) {
    return static_cast<std::size_t>(entry & (kMostPoints - 1));
  }

 private:
  std::vector<std::uint64_t> order_;
  std::vector<std::uint64_t> other_;
};

/// Whether a point of a batch counts.
bool does_count(const PointBatch& batch, std::size_t i);

/// 1, where a batch has no weights.
double weight_of(const PointBatch& batch, std::size_t i);

/// A point's normal, 1 long and times its weight; zero for one that does not count.
std::array<float, 3> weighted_normal(const PointBatch& batch, std::size_t i);

}  // namespace prefilter
