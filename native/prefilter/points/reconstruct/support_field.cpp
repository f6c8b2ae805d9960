// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/support_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {
namespace {

// Range of a cell's reach, in sides. The reach is the square root of the area per sample; it is
// clamped because scan lines are much denser along themselves than across.
constexpr double kMinReach = 0.75;
constexpr double kMaxReach = 1.5;

constexpr int kNearCells = 1;
constexpr double kNearDistance = 1.0;  // no further search below this distance
constexpr int kMiddleCells = 3;
constexpr double kMiddleDistance = kMiddleCells / kMaxReach;
constexpr int kExactCells = static_cast<int>(SupportField::kExact * kMaxReach);
constexpr int kFarCells = 8;
// Minimum cosine between a sample's normal and the surface's; samples below it are ignored. At a
// sharp edge the surface faces away from both sides.
constexpr double kMinFacingCosine = -0.25;
// Below this cosine, the distance is scaled up: a sheet turns around its rim within a cell or two,
// and would otherwise end folded.
constexpr double kFullFacingCosine = 0.7;
constexpr double kTurnedFactor = 2.0;
// Upper limit of a scaled distance, so that steps between two levels still count as filled holes.
constexpr double kMaxTurnedDistance = 3.0;
// Where the mean normal is shorter than this, normals cancel each other and match all directions.
constexpr double kMinAlignment = 0.5;

SupportCell support_of(const SampleCell& sum, int k, int finest, double unit_area,
                       double mean_weight) {
  const double side = std::ldexp(1.0, finest - k);
  const double spacing = std::sqrt(unit_area * mean_weight);
  SupportCell cell;
  cell.key = sum.key;
  const CellPosition at = cell_position(sum.key);
  for (std::size_t a = 0; a < 3; ++a) {
    const double within = static_cast<double>(sum.position[a] / sum.weight);
    cell.position[a] = static_cast<float>((at[a] + within) * side);
  }
  const Vector3 normal = {static_cast<double>(sum.normal[0]), static_cast<double>(sum.normal[1]),
                          static_cast<double>(sum.normal[2])};
  const double size = length(normal);
  if (size > kMinAlignment * static_cast<double>(sum.weight)) {
    for (std::size_t a = 0; a < 3; ++a) cell.normal[a] = static_cast<float>(normal[a] / size);
  }
  cell.reach =
      static_cast<float>(std::clamp(spacing, std::max(1.0, kMinReach * side), kMaxReach * side));
  cell.spacing = static_cast<float>(spacing);
  return cell;
}

double facing_of(const SupportCell& cell, const Vector3& normal) {
  const auto [x, y, z] = cell.normal;
  const bool has_normal = x != 0.0F || y != 0.0F || z != 0.0F;
  if (!has_normal || normal == Vector3{}) return 1.0;
  return static_cast<double>(x) * normal[0] + static_cast<double>(y) * normal[1] +
         static_cast<double>(z) * normal[2];
}

bool is_at(const SampleCell& cell, const HeightRange& heights) {
  return heights.holds(cell_position(cell.key)[2]);
}

// Appends the cells of one depth, at the given heights, whose samples count at this or a larger
// depth.
void add_crossed(const SampleSlab& slab, int k, const HeightRange& heights, int finest,
                 double mean_weight, std::vector<SupportCell>* cells) {
  const SampleLevel& level = slab.at(k);
  for (std::size_t i = 0; i < level.size(); ++i) {
    if (level.leaf[i] != k || !is_at(level.samples.cells[i], heights)) continue;
    const double unit_area = static_cast<double>(level.unit_area[i]);
    SupportCell cell = support_of(level.samples.cells[i], k, finest, unit_area, mean_weight);
    cell.reach = std::max(1.0F, cell.spacing);
    cells->push_back(cell);
  }
}

}  // namespace

void add_support(const SampleSlab& slab, int k, const HeightRange& heights, int finest,
                 double mean_weight, std::vector<SupportCell>* cells) {
  const SampleLevel& level = slab.at(k);
  std::vector<SampleCell> sums;
  if (k < slab.depth()) {
    sums.resize(level.size());
    const SampleLevel& finer = slab.at(k + 1);
    for (std::size_t i = 0; i < finer.size(); ++i) {
      if (finer.leaf[i] == k) sums[finer.parents[i]].add(in_parent(finer.samples.cells[i]));
    }
  }
  for (std::size_t i = 0; i < level.size(); ++i) {
    const SampleCell& own = level.samples.cells[i];
    const bool counts = sums.empty() ? level.leaf[i] == k : sums[i].weight > 0.0F;
    if (!counts || !is_at(own, heights)) continue;
    if (!sums.empty()) sums[i].key = own.key;
    const double unit_area = static_cast<double>(level.unit_area[i]);
    cells->push_back(support_of(sums.empty() ? own : sums[i], k, finest, unit_area, mean_weight));
  }
}

SupportLevel::SupportLevel(int depth, const HeightRange& heights, std::vector<SupportCell> cells)
    : side_(1 << depth), low_(heights.low), high_(heights.high), cells_(std::move(cells)) {
  begin_rows();
}

void SupportLevel::begin_rows() {
  rows_.clear();
  if (cells_.empty()) return;
  const auto side = static_cast<std::size_t>(side_);
  const std::size_t count = side * static_cast<std::size_t>(high_ - low_);
  rows_.reserve(count + 1);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const CellPosition at = cell_position(cells_[i].key);
    const std::size_t row =
        static_cast<std::size_t>(at[2] - low_) * side + static_cast<std::size_t>(at[1]);
    while (rows_.size() <= row) rows_.push_back(static_cast<std::uint32_t>(i));
  }
  while (rows_.size() <= count) rows_.push_back(static_cast<std::uint32_t>(cells_.size()));
}

template <typename Visit>
void SupportLevel::for_near(const CellPosition& at, int reach, const Visit& visit) const {
  const auto side = static_cast<std::size_t>(side_);
  for (int z = std::max(at[2] - reach, low_); z <= std::min(at[2] + reach, high_ - 1); ++z) {
    for (int y = std::max(at[1] - reach, 0); y <= std::min(at[1] + reach, side_ - 1); ++y) {
      const std::size_t row =
          static_cast<std::size_t>(z - low_) * side + static_cast<std::size_t>(y);
      auto cell = cells_.begin() + rows_[row];
      const auto end = cells_.begin() + rows_[row + 1];
      if (cell == end) continue;
      const CellKey first = cell_key({std::max(at[0] - reach, 0), y, z});
      const CellKey last = cell_key({std::min(at[0] + reach, side_ - 1), y, z});
      if (end - cell > 8) {
        cell = std::lower_bound(cell, end, first,
                                [](const SupportCell& c, CellKey key) { return c.key < key; });
      }
      for (; cell != end && cell->key <= last; ++cell) {
        if (cell->key >= first) visit(*cell);
      }
    }
  }
}

void SupportLevel::lower_to_nearest(const OrientedPoint& point, double side, int reach,
                                    Support* best) const {
  if (cells_.empty()) return;
  CellPosition at;
  for (std::size_t a = 0; a < 3; ++a) {
    at[a] = static_cast<std::int32_t>(
        std::clamp(std::floor(point.position[a] / side), -64.0, 4096.0 + 64.0));
  }
  for_near(at, reach, [&](const SupportCell& cell) {
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = static_cast<double>(cell.position[a]) - point.position[a];
      squared += x * x;
    }
    const double distance = std::sqrt(squared) / static_cast<double>(cell.reach);
    if (distance < static_cast<double>(best->distance)) {
      const double facing = facing_of(cell, point.normal);
      if (facing < kMinFacingCosine) return;
      const double turned =
          (1.0 + kTurnedFactor * std::max(0.0, kFullFacingCosine - facing)) * distance;
      const double effective = std::max(distance, std::min(turned, kMaxTurnedDistance));
      if (effective >= static_cast<double>(best->distance)) return;
      *best = {static_cast<float>(effective), cell.spacing};
    }
  });
}

SupportField::SupportField(const Slabs& slabs, double sign, int s)
    : slabs_(slabs), sign_(sign), s_(s), crossed_(static_cast<std::size_t>(slabs.depth()) + 1) {
  for (int k = 0; k <= slabs.depth(); ++k) {
    levels_.push_back(level_of(k));
  }
}

double SupportField::side(int k) const { return std::ldexp(1.0, slabs_.depth() - k); }

HeightRange SupportField::heights_around(int k, int reach) const {
  const int shift = slabs_.depth() - k;
  const int low = (s_ * slabs_.height() >> shift) - reach;
  const int high = (((s_ + 1) * slabs_.height() - 1) >> shift) + reach + 1;
  return {std::max(low, 0), std::min(high, 1 << k)};
}

SupportLevel SupportField::level_of(int k) const {
  const HeightRange heights = heights_around(k, kExactCells);
  std::vector<SupportCell> cells;
  if (k < slabs_.top()) {
    add_support(slabs_.whole, k, heights, slabs_.depth(), slabs_.mean_weight, &cells);
  } else if (slabs_.is_sparse(k)) {
    const int height = 1 << (k - slabs_.top());
    const int end = std::min((heights.high - 1) / height + 1, slabs_.count());
    for (int t = heights.low / height; t < end; ++t) {
      for (const SupportCell& cell : slabs_.sparse(t, k)) {
        if (heights.holds(cell_position(cell.key)[2])) cells.push_back(cell);
      }
    }
  } else {
    for (int t = s_ - 1; t <= s_ + 1; ++t) {
      if (slabs_.samples(t) == nullptr) continue;
      add_support(*slabs_.samples(t), k, heights, slabs_.depth(), slabs_.mean_weight, &cells);
    }
  }
  return {k, heights, std::move(cells)};
}

SupportLevel SupportField::crossed_level_of(int k) const {
  const HeightRange heights = heights_around(k, kFarCells);
  std::vector<SupportCell> cells;
  if (k <= slabs_.top()) {
    add_crossed(slabs_.whole, k, heights, slabs_.depth(), slabs_.mean_weight, &cells);
  } else {
    for (int t = s_ - 1; t <= s_ + 1; ++t) {
      if (slabs_.samples(t) == nullptr) continue;
      add_crossed(*slabs_.samples(t), k, heights, slabs_.depth(), slabs_.mean_weight, &cells);
    }
  }
  return {k, heights, std::move(cells)};
}

Support SupportField::at(OrientedPoint point, int k) {
  const double size = length(point.normal);
  point.normal = (size > 0.0 ? sign_ / size : 0.0) * point.normal;
  constexpr float kNone = std::numeric_limits<float>::max();
  Support best = {kNone, 1.0F};
  const auto depth = static_cast<std::size_t>(std::clamp(k, 0, slabs_.depth()));
  levels_[depth].lower_to_nearest(point, side(static_cast<int>(depth)), kNearCells, &best);
  if (static_cast<double>(best.distance) <= kNearDistance) return best;
  constexpr std::pair<int, double> kReaches[] = {{kMiddleCells, kMiddleDistance},
                                                 {kExactCells, kExact}};
  for (const auto& [cells, sufficient] : kReaches) {
    for (int j = slabs_.depth(); j >= 0; --j) {
      levels_[static_cast<std::size_t>(j)].lower_to_nearest(point, side(j), cells, &best);
    }
    if (static_cast<double>(best.distance) <= sufficient) return best;
  }
  const Support far = far_support(point);
  return best.distance < far.distance ? best : far;
}

// Searches coarser cells that are small against the distance. Nothing is nearer than kExact
// reaches, so the result is clamped to that: a cell's mean may lie in a hole.
Support SupportField::far_support(const OrientedPoint& point) {
  constexpr float kMost = 1e6F;  // distance if no sample is near
  for (int k = slabs_.depth(); k >= 0; --k) {
    std::optional<SupportLevel>& level = crossed_[static_cast<std::size_t>(k)];
    if (!level) level = crossed_level_of(k);
    Support best = {kMost, 1.0F};
    level->lower_to_nearest(point, side(k), kFarCells, &best);
    if (best.distance < kMost) {
      best.distance = std::max(best.distance, static_cast<float>(kExact));
      return best;
    }
  }
  return {kMost, 1.0F};
}

}  // namespace prefilter
