// SPDX-License-Identifier: GPL-3.0-or-later

// Decides which regions of a surface are cut, and which remaining parts are islands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "prefilter/points/trim_surface.h"

namespace prefilter {

/// Regions of vertices that are all near samples, or all far from them. A region consists of
/// pieces, and any of its pieces identifies it.
class SurfaceRegions {
 public:
  std::int32_t add_piece();
  /// Unites two regions, which must both be near or both be far; returns the united region.
  std::int32_t unite(std::int32_t a, std::int32_t b);
  /// Adds surface to a region: its area, and its area in squared spacings.
  void add_area(std::int32_t piece, double area, double patches);
  /// Adds the distance of a far vertex; infinity requests a cut.
  void add_distance(std::int32_t piece, double distance);
  /// Adds pairs of adjacent regions, in any order and with repetitions.
  void add_borders(std::vector<std::pair<std::int32_t, std::int32_t>> near_and_far);

  /// Decides; call once, after all regions have been added.
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
  std::int32_t find_root(std::int32_t piece);
  static bool is_cut_off(const Region& region, double hole);
  // Finds islands among the remaining regions.
  void find_islands(const TrimOptions& options, double all, TrimReport* report);

  std::vector<Region> regions_;
  std::vector<std::pair<std::int32_t, std::int32_t>> borders_;
  std::vector<Fate> fates_;  // of each piece
};

}  // namespace prefilter
