// SPDX-License-Identifier: GPL-3.0-or-later

// How deep an octree the points of a cloud carry, from how far apart they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Some of the positions of a cloud, chosen by their coordinates alone: the same ones for any order
/// of the points, and for copies of them. Half of the positions are left out as often as it takes.
class ThinnedPoints {
 public:
  static constexpr std::size_t kMost = std::size_t{1} << 17;

  struct Entry {
    std::uint64_t number = 0;  // as good as random, of the position
    Vector3 position{};
  };

  static Entry entry_of(const Vector3& position);
  /// Whether an entry is among those that are kept so far.
  bool keeps(const Entry& entry) const { return entry.number <= largest_; }
  void add(const std::vector<Entry>& entries);
  /// Call once, after the last `add`.
  void finish() { thin(); }

  /// In the order of their numbers.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Of how many positions each is one.
  double share() const { return share_; }

 private:
  void thin();

  std::vector<Entry> entries_;
  std::uint64_t largest_ = std::numeric_limits<std::uint64_t>::max();
  double share_ = 1.0;
};

/// The greatest depth, 1 to kMaxTreeDepth, at which half of the surface in a box has a point for
/// each face of a finest cell, or more. How dense points are is told by the distance to the last of
/// several neighbors; as each then stands for a part of the surface, a dense part has no more say
/// than its size.
int carried_depth(const ThinnedPoints& points, const Box& box, const Progress& progress,
                  int threads);

}  // namespace prefilter
