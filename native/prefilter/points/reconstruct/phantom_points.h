// SPDX-License-Identifier: GPL-3.0-or-later

// Finds phantoms while points are measured, and excludes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/phantoms.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/automatic_depth.h"

namespace prefilter {

/// Positions that may hold many points, collected batch by batch. Every position that holds at
/// least `least()` points is included.
class RepeatedPositions {
 public:
  /// The most frequent positions of a batch. Points that are not finite are ignored.
  static std::vector<ThinnedPoints::Entry> of_batch(const PointBatch& batch);

  /// Adds the result of of_batch for a batch of `points` points.
  void add(const std::vector<ThinnedPoints::Entry>& entries, std::size_t points);

  bool is_empty() const { return entries_.empty(); }
  std::size_t least() const { return least_; }
  /// Positions by their hashes.
  const std::unordered_map<std::uint64_t, Vector3>& entries() const { return entries_; }

 private:
  std::unordered_map<std::uint64_t, Vector3> entries_;
  std::size_t least_ = 0;
};

/// The phantoms among the repeated positions of a source, which is read again if there are any;
/// phantoms.h defines phantoms.
std::vector<PhantomPlace> find_phantoms(const RepeatedPositions& repeated, PointSource* source,
                                        const Run& run);

/// A source without the points at given positions.
class PointsWithout final : public ChangedPoints {
 public:
  PointsWithout(PointSource* source, const std::vector<PhantomPlace>& places);

  bool read(std::size_t most, PointBatch* batch) override;

 private:
  std::unordered_map<std::uint64_t, Vector3> left_out_;
};

}  // namespace prefilter
