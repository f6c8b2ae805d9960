// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/carried_depth.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter {
namespace {

// The finalizer of splitmix64: each bit depends on all.
std::uint64_t mixed(std::uint64_t bits) {
  bits ^= bits >> 30U;
  bits *= 0xbf58476d1ce4e5b9U;
  bits ^= bits >> 27U;
  bits *= 0x94d049bb133111ebU;
  return bits ^ bits >> 31U;
}

// Points whose neighbors are looked for: the median of so many is off by a hundredth of a level.
constexpr std::size_t kMostAsked = 4096;
// Enough that a scanner's lines count, few enough that they are on one sheet of the surface.
constexpr std::size_t kNeighbors = 16;
constexpr double kPi = 3.14159265358979323846;
// Of a cell of the finest depth; with fewer than one point a face the surface folds, with more
// detail is lost. In occupied cells that are about one and a half each, as Poisson reconstruction
// has it.
constexpr double kPointsPerFace = 1.0;

// Part of the surface: its area, and how many points there are in a unit of it.
struct Patch {
  double density = 0.0;
  double area = 0.0;
};

Patch patch_of(const Neighbors& found) {
  // A circle of the area that holds all but the point itself and the last, on average.
  const auto held = static_cast<double>(found.squares().size() - 1);
  Patch patch;
  patch.area = kPi * found.squares().back() / std::max(held - 1.0, 1.0);
  patch.density = 1.0 / patch.area;
  return patch;
}

// What half of the area is no denser than.
double median_density(std::vector<Patch>* patches) {
  std::sort(patches->begin(), patches->end(),
            [](const Patch& a, const Patch& b) { return a.density < b.density; });
  // Points that lie by themselves, outliers, would have more area than all the surface.
  constexpr double kLeastShare = 1.0 / 64.0;
  const double middle = (*patches)[patches->size() / 2].density;
  const auto first = std::find_if(patches->begin(), patches->end(), [&](const Patch& patch) {
    return patch.density >= kLeastShare * middle;
  });
  patches->erase(patches->begin(), first);
  double whole = 0.0;
  for (const Patch& patch : *patches) whole += patch.area;
  double below = 0.0;
  for (const Patch& patch : *patches) {
    below += patch.area;
    if (below >= 0.5 * whole) return patch.density;
  }
  return patches->back().density;
}

}  // namespace

ThinnedPoints::Entry ThinnedPoints::entry_of(const Vector3& position) {
  std::uint64_t number = 0;
  for (const double value : position) {
    // 0.0 and -0.0 are one place.
    number = mixed((number ^ std::bit_cast<std::uint64_t>(value + 0.0)) + 0x9e3779b97f4a7c15U);
  }
  return {number, position};
}

void ThinnedPoints::add(const std::vector<Entry>& entries) {
  for (const Entry& entry : entries) {
    if (keeps(entry)) entries_.push_back(entry);
  }
  if (entries_.size() >= 2 * kMost) thin();
}

void ThinnedPoints::thin() {
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.number, a.position) < std::tie(b.number, b.position);
  });
  const auto same = [](const Entry& a, const Entry& b) { return a.position == b.position; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), same), entries_.end());
  while (entries_.size() > kMost && largest_ > 0) {
    largest_ /= 2;
    share_ *= 2.0;
    const auto end = std::partition_point(entries_.begin(), entries_.end(),
                                          [&](const Entry& entry) { return keeps(entry); });
    entries_.erase(end, entries_.end());
  }
}

int carried_depth(const ThinnedPoints& points, const Box& box, const Progress& progress,
                  int threads) {
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  std::vector<Vector3> positions;
  positions.reserve(points.entries().size());
  for (const ThinnedPoints::Entry& entry : points.entries()) {
    if (box.squared_distance(entry.position) > 0.0) continue;
    Vector3 scaled;
    for (std::size_t a = 0; a < 3; ++a) scaled[a] = (entry.position[a] - box.low[a]) / longest;
    positions.push_back(scaled);
  }
  const NeighborSearch search(positions, progress.part(0.0, 0.5), threads);
  const std::size_t asked = std::min(kMostAsked, positions.size());
  std::vector<Patch> patches(asked);
  parallel_for(static_cast<std::int64_t>(asked), threads, progress.part(0.5, 1.0),
               [&](std::int64_t i) {
                 Neighbors found;
                 const auto k = static_cast<std::size_t>(i);
                 search.find(search.places()[k], kNeighbors + 1, &found);
                 patches[k] = patch_of(found);
               });
  const double density = points.share() * median_density(&patches);
  int depth = 1;
  while (depth < kMaxTreeDepth) {
    const double cube = cube_around(box, depth + 1).size(0) / longest;
    const double cell = std::ldexp(cube, -(depth + 1));
    if (!(density * cell * cell >= kPointsPerFace)) break;
    ++depth;
  }
  return depth;
}

}  // namespace prefilter
