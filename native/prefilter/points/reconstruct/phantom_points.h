// SPDX-License-Identifier: GPL-3.0-or-later

// How phantoms are found while points are measured, and left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/phantoms.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/carried_depth.h"

namespace prefilter {

/// Positions that may hold many points, collected batch by batch. A position is found for sure
/// where it holds `least()` points, in whichever batches these are.
class RepeatedPositions {
 public:
  /// The positions of a batch that it holds most often. Points that are not finite do not count.
  static std::vector<ThinnedPoints::Entry> of_batch(const PointBatch& batch);

  /// Adds what `of_batch` returned of a batch of so many points.
  void add(const std::vector<ThinnedPoints::Entry>& entries, std::size_t points);

  bool is_empty() const { return entries_.empty(); }
  std::size_t least() const { return least_; }
  /// By their numbers.
  const std::unordered_map<std::uint64_t, Vector3>& entries() const { return entries_; }

 private:
  std::unordered_map<std::uint64_t, Vector3> entries_;
  std::size_t least_ = 0;
};

/// The phantoms among these positions of a source, which is read again where there may be some: see
/// phantoms.h.
std::vector<PhantomPlace> find_phantoms(const RepeatedPositions& repeated, PointSource* source,
                                        const Progress& progress, int threads);

/// A source without the points at some positions.
class PointsWithout final : public ChangedPoints {
 public:
  PointsWithout(PointSource* source, const std::vector<PhantomPlace>& places);

  bool read(std::size_t most, PointBatch* batch) override;

 private:
  std::unordered_map<std::uint64_t, Vector3> left_out_;
};

}  // namespace prefilter
