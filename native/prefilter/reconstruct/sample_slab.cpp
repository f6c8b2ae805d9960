// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/sample_slab.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "prefilter/base/elementary.h"
#include "prefilter/base/geometry.h"
#include "prefilter/base/radix_sort.h"

namespace prefilter {
namespace {

constexpr int kIndexBits = 64 - kKeyBits;
constexpr int kNeighborsOfSurface = 3;
constexpr int kAreaSteps = 2;
// Cells this large always count, so that there is one where every sample does.
constexpr int kCoarsestLeaf = 2;

SampleLevel coarser(SampleLevel* level, std::size_t attribute_count) {
  const std::vector<SampleCell>& cells = level->samples.cells;
  std::vector<std::uint64_t> order;
  order.reserve(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellPosition at = cell_position(cells[i].key);
    order.push_back((cell_key({at[0] / 2, at[1] / 2, at[2] / 2}) << kIndexBits) | i);
  }
  std::vector<std::uint64_t> other;
  radix_sort(&order, kIndexBits, 64, &other);
  SampleLevel result;
  level->parents.resize(cells.size());
  for (const std::uint64_t entry : order) {
    const auto i = static_cast<std::size_t>(entry & ((std::uint64_t{1} << kIndexBits) - 1));
    const SampleCell moved = in_parent(cells[i]);
    SampleCells& parents = result.samples;
    if (parents.cells.empty() || parents.cells.back().key != moved.key) {
      parents.cells.emplace_back();
      parents.cells.back().key = moved.key;
      parents.attributes.resize(parents.attributes.size() + attribute_count);
    }
    parents.cells.back().add(moved);
    float* const sums = parents.attributes.data() + parents.attributes.size() - attribute_count;
    for (std::size_t k = 0; k < attribute_count; ++k) {
      sums[k] += level->samples.attributes[i * attribute_count + k];
    }
    level->parents[i] = static_cast<std::uint32_t>(parents.cells.size() - 1);
  }
  return result;
}

// Of the cells, those with enough neighbors. As keys are in row-major order, so are the nine rows
// around them: one cursor for each goes through all keys once.
void mark_met(const std::vector<CellKey>& keys, SampleLevel* level) {
  std::array<CellKey, 9> rows;
  for (std::size_t r = 0; r < 9; ++r) {
    rows[r] = ((CellKey{r / 3} << kRowShift) + r % 3) << kRowShift;
  }
  constexpr CellKey kBack = ((CellKey{1} << kRowShift) + 1) << kRowShift;
  std::array<std::size_t, 9> cursors{};
  level->is_met.resize(level->size());
  for (std::size_t i = 0; i < level->size(); ++i) {
    const CellKey key = level->samples.cells[i].key;
    int found = -1;  // itself
    for (std::size_t r = 0; r < 9; ++r) {
      const CellKey middle = key + rows[r] - kBack;
      std::size_t& cursor = cursors[r];
      while (cursor < keys.size() && keys[cursor] + 1 < middle) ++cursor;
      for (std::size_t j = cursor; j < keys.size() && keys[j] <= middle + 1; ++j) ++found;
    }
    level->is_met[i] = found >= kNeighborsOfSurface ? 1 : 0;
  }
}

// Of the cells that the surface meets, the share in which there are samples, from their mean
// number where there are some. With rho samples per cell that is met, whose share of the surface is
// spread evenly between 0 and twice its mean, that share is 1 - (1 - exp(-2 rho)) / (2 rho).
double share_hit(double samples_per_cell) {
  constexpr double kLeast = 0.3;
  double rho = samples_per_cell;
  for (int i = 0; i < 30; ++i) {
    const double share = 1.0 + elementary::expm1(-2.0 * rho) / (2.0 * rho);
    if (share < kLeast) return kLeast;
    rho = samples_per_cell * share;
  }
  return rho / samples_per_cell;
}

// Of the surface in a cell, in sides of the cell squared, if it is met as often as cells are on
// average.
double area_in(const SampleCell& cell) {
  Vector3 n;
  for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<double>(cell.normal[a]);
  const double sum = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  const double length = std::sqrt(dot(n, n));
  // Normals that cancel each other tell nothing: the mean over all directions.
  if (!(length > 0.2 * static_cast<double>(cell.weight))) return 1.0 / 1.5;
  return length / sum;
}

struct Extent {
  double area = 0.0;
  double weight = 0.0;
  double cells = 0.0;
};

}  // namespace

SampleSlab make_sample_slab(SampleCells finest, int depth, int top, std::size_t attribute_count) {
  SampleSlab slab;
  slab.top = top;
  slab.levels.resize(static_cast<std::size_t>(depth - top + 1));
  slab.at(depth).samples = std::move(finest);
  for (int k = depth; k > top; --k) slab.at(k - 1) = coarser(&slab.at(k), attribute_count);
  return slab;
}

std::vector<CellKey> keys_with_layers(const SampleLevel* below, const SampleLevel& level,
                                      const SampleLevel* above) {
  std::vector<CellKey> keys;
  if (below != nullptr && below->size() > 0) {
    const std::vector<SampleCell>& cells = below->samples.cells;
    const int last = cell_position(cells.back().key)[2];
    auto first = cells.end();
    while (first != cells.begin() && cell_position(std::prev(first)->key)[2] == last) --first;
    for (; first != cells.end(); ++first) keys.push_back(first->key);
  }
  for (const SampleCell& cell : level.samples.cells) keys.push_back(cell.key);
  if (above != nullptr && above->size() > 0) {
    const int first = cell_position(above->samples.cells.front().key)[2];
    for (const SampleCell& cell : above->samples.cells) {
      if (cell_position(cell.key)[2] != first) break;
      keys.push_back(cell.key);
    }
  }
  return keys;
}

void find_met_cells(const SampleSlab* below, const SampleSlab* above, SampleSlab* slab) {
  for (int k = slab->top; k <= slab->depth(); ++k) {
    const std::vector<CellKey> keys =
        keys_with_layers(below == nullptr ? nullptr : &below->at(k), slab->at(k),
                         above == nullptr ? nullptr : &above->at(k));
    mark_met(keys, &slab->at(k));
  }
}

void find_leaves(double mean_weight, int finest, SampleSlab* slab) {
  for (int k = slab->top; k <= slab->depth(); ++k) {
    SampleLevel& level = slab->at(k);
    if (k > slab->top) {
      level.leaf.resize(level.size());
      for (std::size_t i = 0; i < level.size(); ++i) {
        const bool counts = level.is_met[i] != 0 || k <= kCoarsestLeaf;
        level.leaf[i] =
            counts ? static_cast<std::int8_t>(k) : slab->at(k - 1).leaf[level.parents[i]];
      }
    }
    const int steps = std::min(kAreaSteps, k - slab->top);
    std::vector<std::uint32_t> ancestors(level.size());
    for (std::size_t i = 0; i < level.size(); ++i) {
      std::uint32_t at = static_cast<std::uint32_t>(i);
      for (int s = 0; s < steps; ++s) at = slab->at(k - s).parents[at];
      ancestors[i] = at;
    }
    std::vector<Extent> extents(slab->at(k - steps).size());
    for (std::size_t i = 0; i < level.size(); ++i) {
      Extent& extent = extents[ancestors[i]];
      extent.area += area_in(level.samples.cells[i]);
      extent.weight += static_cast<double>(level.samples.cells[i].weight);
      extent.cells += 1.0;
    }
    const double side = std::ldexp(1.0, finest - k);
    std::vector<float> unit_areas(extents.size());
    for (std::size_t i = 0; i < extents.size(); ++i) {
      const Extent& e = extents[i];
      const double share = share_hit(e.weight / (e.cells * mean_weight));
      unit_areas[i] = static_cast<float>(e.area * side * side / (share * e.weight));
    }
    level.unit_area.resize(level.size());
    for (std::size_t i = 0; i < level.size(); ++i) level.unit_area[i] = unit_areas[ancestors[i]];
  }
}

}  // namespace prefilter
