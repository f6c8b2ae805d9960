// SPDX-License-Identifier: GPL-3.0-or-later

// Accumulates points into sums of samples per cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/float_steps.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/automatic_depth.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/sample_store.h"

namespace prefilter {

class NormalProbe;
class RepeatedPositions;

/// Extent and moments of a set of points.
struct CloudPart {
  Box box = kEmptyBox;
  std::size_t points = 0;
  double weight = 0.0;
  Vector3 mean{};
  Vector3 squares{};  // sums of squared distances from the mean, per axis

  void include(const Vector3& point, double point_weight);
  void include(const CloudPart& other);
};

/// Extent of a cloud, measured in a first pass over its points.
struct CloudExtent {
  CloudPart part;          // valid points
  CloudPart huge;          // points that are valid except for huge coordinates
  std::size_t points = 0;  // all points, including invalid ones
  DroppedPoints dropped;
  std::size_t strays = 0;  // dropped as far outliers
  FloatSteps steps;        // of the valid points

  /// Decides whether points with huge coordinates are valid; call after all points were measured.
  void settle_huge();
};

/// Reads the source once. If not null, `thinned` receives a subset of the valid points, and
/// `repeated` the positions that may hold many points. settle_huge() has not been called on the
/// result.
CloudExtent measure_cloud(PointSource* source, const Run& run, ThinnedPoints* thinned = nullptr,
                          RepeatedPositions* repeated = nullptr);

/// Reads the source again and accumulates all valid points into cells. The result does not depend
/// on the number of threads; with another order of the points it differs by rounding only. Joined
/// clouds are summed separately and then added in order, so that separate machines can do the
/// former. If not null, `probe` examines all points in the same pass.
void gather_samples(PointSource* source, const SampleGrid& grid, const Run& run, SampleStore* store,
                    NormalProbe* probe = nullptr);

/// Sorts the valid points of a batch by cell: entries hold the cell key and, in the lowest
/// kBatchBits bits, the point's index.
class PointOrder {
 public:
  static constexpr int kBatchBits = 17;  // bits of a point's index
  static constexpr std::size_t kMaxPoints = std::size_t{1} << kBatchBits;

  const std::vector<std::uint64_t>& sort(const PointBatch& batch, const SampleGrid& grid);

  static CellKey key(std::uint64_t entry) { return entry >> kBatchBits; }
  static std::size_t index(std::uint64_t entry) {
    return static_cast<std::size_t>(entry & (kMaxPoints - 1));
  }

 private:
  std::vector<std::uint64_t> order_;
  std::vector<std::uint64_t> other_;
};

/// Whether a point has a finite position, a positive weight and a normal.
bool is_valid_point(const PointBatch& batch, std::size_t i);

/// The point's weight; 1 where the batch has no weights.
double weight_of(const PointBatch& batch, std::size_t i);

/// A point's unit normal times its weight; zero for an invalid point.
std::array<float, 3> weighted_normal(const PointBatch& batch, std::size_t i);

}  // namespace prefilter
