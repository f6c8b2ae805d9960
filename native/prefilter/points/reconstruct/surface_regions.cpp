// SPDX-License-Identifier: GPL-3.0-or-later

// Connected components with union-find and path halving (R. Tarjan, J. van Leeuwen, 1984).
#include "prefilter/points/reconstruct/surface_regions.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace prefilter {

std::int32_t SurfaceRegions::add_piece() {
  const auto piece = static_cast<std::int32_t>(regions_.size());
  regions_.push_back({piece});
  return piece;
}

std::int32_t SurfaceRegions::find_root(std::int32_t piece) {
  while (regions_[index(piece)].parent != piece) {
    std::int32_t& parent = regions_[index(piece)].parent;
    parent = regions_[index(parent)].parent;
    piece = parent;
  }
  return piece;
}

std::int32_t SurfaceRegions::unite(std::int32_t a, std::int32_t b) {
  // The earliest piece becomes the root, so that sums do not depend on the forest's shape.
  std::tie(a, b) = std::minmax({find_root(a), find_root(b)});
  if (a == b) return a;
  Region& into = regions_[index(a)];
  Region& from = regions_[index(b)];
  from.parent = a;
  into.area += from.area;
  into.patches += from.patches;
  into.farthest = std::max(into.farthest, from.farthest);
  return a;
}

void SurfaceRegions::add_area(std::int32_t piece, double area, double patches) {
  Region& region = regions_[index(find_root(piece))];
  region.area += area;
  region.patches += patches;
}

void SurfaceRegions::add_distance(std::int32_t piece, double distance) {
  double& farthest = regions_[index(find_root(piece))].farthest;
  farthest = std::max(farthest, distance);
}

void SurfaceRegions::add_borders(std::vector<std::pair<std::int32_t, std::int32_t>> near_and_far) {
  std::sort(near_and_far.begin(), near_and_far.end());
  const auto end = std::unique(near_and_far.begin(), near_and_far.end());
  borders_.insert(borders_.end(), near_and_far.begin(), end);
}

// Regions that fill a hole are as large as it is deep; folds with an unsupported back are smaller.
bool SurfaceRegions::is_cut_off(const Region& region, double hole) {
  return region.farthest > hole && (region.patches >= hole * hole || std::isinf(region.farthest));
}

TrimReport SurfaceRegions::decide(const TrimOptions& options) {
  TrimReport report;
  double all = 0.0;
  double cut = 0.0;
  fates_.assign(regions_.size(), Fate::kKept);
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const auto piece = static_cast<std::int32_t>(i);
    const Region& root = regions_[index(find_root(piece))];
    if (is_cut_off(root, options.hole)) fates_[i] = Fate::kCut;
    if (root.parent != piece) continue;
    all += root.area;
    if (fates_[i] == Fate::kCut) cut += root.area;
  }
  report.cut = all > 0.0 ? cut / all : 0.0;
  if (std::find(fates_.begin(), fates_.end(), Fate::kCut) == fates_.end()) return report;
  for (const auto& [near, far] : borders_) {
    if (fates_[index(far)] != Fate::kCut) unite(near, far);
  }
  find_islands(options, all, &report);
  return report;
}

void SurfaceRegions::find_islands(const TrimOptions& options, double all, TrimReport* report) {
  std::int32_t largest = -1;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const auto piece = static_cast<std::int32_t>(i);
    if (fates_[i] == Fate::kCut || regions_[i].parent != piece) continue;
    if (largest < 0 || regions_[i].patches > regions_[index(largest)].patches) largest = piece;
  }
  double gone = 0.0;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (fates_[i] == Fate::kCut) continue;
    const auto piece = static_cast<std::int32_t>(i);
    const std::int32_t root = find_root(piece);
    if (root == largest || regions_[index(root)].patches >= options.island) continue;
    fates_[i] = Fate::kIsland;
    if (root != piece) continue;
    ++report->islands;
    gone += regions_[i].area;
  }
  report->island = all > 0.0 ? gone / all : 0.0;
}

}  // namespace prefilter
