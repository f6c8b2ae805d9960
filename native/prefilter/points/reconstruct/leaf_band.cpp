// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/leaf_band.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/points/reconstruct/split_finder.h"

namespace prefilter {
namespace {

void add_leaves(const SampleLevel& level, int k, SplitFinder* finder) {
  for (std::size_t i = 0; i < level.size(); ++i) {
    if (level.leaf[i] == k) finder->add(cell_position(level.samples.cells[i].key));
  }
}

void add_split_cells(const std::vector<std::uint64_t>& places, SplitFinder* finder) {
  for (const std::uint64_t place : places) finder->add(morton_cell(place));
}

void split(std::uint64_t place, std::vector<CellFlux>* octants) {
  CellFlux cell;
  cell.place = place << 3U;
  octants->push_back(cell);
}

}  // namespace

bool SplitCells::is_split(int k, std::uint64_t place) const {
  if (k >= depth()) return false;
  return k < kFullDepth || std::binary_search(at(k).begin(), at(k).end(), place);
}

SplitCells split_around_leaves(const SampleSlab& slab) {
  SplitCells splits(slab.depth());
  for (int k = slab.depth(); k > slab.top; --k) {
    SplitFinder finder(k, 0, 1 << (k - 1));
    add_leaves(slab.at(k), k, &finder);
    if (k < slab.depth()) add_split_cells(splits.at(k), &finder);
    splits.at(k - 1) = finder.take();
  }
  return splits;
}

SplitCells splits_in_slab(const std::vector<const SplitCells*>& splits, int s, int top, int depth) {
  SplitCells result(depth);
  for (int k = top; k < depth; ++k) {
    std::vector<std::uint64_t>& places = result.at(k);
    for (const SplitCells* each : splits) {
      if (each == nullptr) continue;
      std::copy_if(each->at(k).begin(), each->at(k).end(), std::back_inserter(places),
                   [&](std::uint64_t place) { return morton_cell(place)[2] >> (k - top) == s; });
    }
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
  }
  return result;
}

SplitCells coarse_splits(const SampleSlab& whole, const std::vector<CellFlux>& tops) {
  const int top = whole.depth();
  SplitCells splits(top);
  for (int k = top; k > 0; --k) {
    SplitFinder finder(k, 0, 1 << (k - 1));
    add_leaves(whole.at(k), k, &finder);
    if (k < top) {
      add_split_cells(splits.at(k), &finder);
    } else {
      for (const CellFlux& cell : tops) {
        if (cell.is_split) finder.add(morton_cell(cell.place));
      }
    }
    splits.at(k - 1) = finder.take();
  }
  return splits;
}

void add_band(const SplitCells& splits, int s, int top, PooledFlux* pooled) {
  for (int k = top; k < splits.depth(); ++k) {
    for (const std::uint64_t place : splits.at(k)) {
      split(place, &(*pooled)[static_cast<std::size_t>(k) + 1]);
    }
  }
  const int full = std::min(kFullDepth, splits.depth()) - 1;
  if (full < top) return;
  const int height = 1 << (full - top);
  for (int z = s * height; z < (s + 1) * height; ++z) {
    for (int y = 0; y < 1 << full; ++y) {
      for (int x = 0; x < 1 << full; ++x) {
        split(morton_index({x, y, z}), &(*pooled)[static_cast<std::size_t>(full) + 1]);
      }
    }
  }
}

void add_coarse_band(const SplitCells& splits, PooledFlux* flux) {
  for (int k = 0; k < splits.depth(); ++k) {
    for (const std::uint64_t place : splits.at(k)) {
      split(place, &(*flux)[static_cast<std::size_t>(k) + 1]);
    }
  }
  const int full = std::min(kFullDepth, splits.depth()) - 1;
  for (std::uint64_t place = 0; full >= 0 && place < std::uint64_t{1} << (3 * full); ++place) {
    split(place, &(*flux)[static_cast<std::size_t>(full) + 1]);
  }
}

}  // namespace prefilter
