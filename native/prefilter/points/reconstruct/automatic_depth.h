// SPDX-License-Identifier: GPL-3.0-or-later

// Chooses the octree depth of a reconstruction from the density of the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// A subset of a cloud's positions. Membership depends on the coordinates alone, so it is the same
/// for any order of the points, and repeated positions count once. When the set grows too large,
/// half of the positions are dropped.
class ThinnedPoints {
 public:
  static constexpr std::size_t kMaxEntries = std::size_t{1} << 17;

  struct Entry {
    std::uint64_t hash = 0;  // hash of the position, uniformly distributed
    Vector3 position{};
  };

  static Entry entry_of(const Vector3& position);
  /// Whether an entry passes the current hash threshold.
  bool keeps(const Entry& entry) const { return entry.hash <= largest_; }
  void add(const std::vector<Entry>& entries);
  /// Call once, after the last `add`.
  void finish() { thin(); }

  /// Entries in order of their hashes.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Number of distinct positions in the cloud per entry, on average.
  double share() const { return share_; }

 private:
  void thin();

  std::vector<Entry> entries_;
  std::uint64_t largest_ = std::numeric_limits<std::uint64_t>::max();
  double share_ = 1.0;
};

/// The greatest depth, 1 to kMaxTreeDepth, at which at least half of the surface in the box has one
/// point or more per face of a finest cell. Density is estimated from the distance to the last of
/// several neighbors. Each point is weighted by the area that it represents, so dense parts of the
/// scan do not dominate.
int automatic_depth(const ThinnedPoints& points, const Box& box, const Run& run);

}  // namespace prefilter
