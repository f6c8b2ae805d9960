// SPDX-License-Identifier: GPL-3.0-or-later

// Which regions of a surface are cut, and which parts of the rest are islands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "prefilter/points/trim_surface.h"

namespace prefilter {

/// Regions of vertices that are all near samples, or all far from them. Each is known by the
/// numbers of the pieces that it was put together from.
class SurfaceRegions {
 public:
  std::int32_t make();
  /// Makes one region of two. Both are near, or both far.
  std::int32_t unite(std::int32_t a, std::int32_t b);
  /// Some surface of a region, as it is and in squared spacings.
  void add_area(std::int32_t piece, double area, double patches);
  /// A vertex of a region that is far; infinite: it is to be cut.
  void add_distance(std::int32_t piece, double distance);
  /// Triangles lie in both. The same pairs may come often.
  void add_borders(std::vector<std::pair<std::int32_t, std::int32_t>> near_and_far);

  /// Decides; call it once. No regions may come after.
  TrimReport decide(const TrimOptions& options);
  bool is_cut(std::int32_t piece) const { return fates_[index(piece)] == Fate::kCut; }
  bool is_kept(std::int32_t piece) const { return fates_[index(piece)] == Fate::kKept; }

 private:
  enum class Fate : std::uint8_t { kKept, kCut, kIsland };
  struct Region {
    std::int32_t parent;
    double area = 0.0;
    double patches = 0.0;
    double farthest = 0.0;
  };

  static std::size_t index(std::int32_t piece) { return static_cast<std::size_t>(piece); }
  std::int32_t find(std::int32_t piece);
  static bool is_cut_off(const Region& region, double hole);
  // Islands among what is left.
  void find_islands(const TrimOptions& options, double all, TrimReport* report);

  std::vector<Region> regions_;
  std::vector<std::pair<std::int32_t, std::int32_t>> borders_;
  std::vector<Fate> fates_;  // of all pieces
};

}  // namespace prefilter
