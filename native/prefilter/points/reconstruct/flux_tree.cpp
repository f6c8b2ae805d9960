// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/flux_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "prefilter/base/radix_sort.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/wavelet/haar.h"

namespace prefilter {
namespace {

constexpr int kPlaceBits = 3 * kMaxTreeDepth;

bool is_nonempty(const CellFlux& cell) {
  const Vector3& area = cell.flux.area;
  return area[0] != 0.0 || area[1] != 0.0 || area[2] != 0.0 || cell.sampled.area > 0.0F;
}

OctantFlux octant_flux(const CellFlux& cell) {
  OctantFlux result;
  for (std::size_t a = 0; a < 3; ++a) {
    result.area[a] = static_cast<float>(cell.flux.area[a]);
    result.moment[a] = static_cast<float>(cell.flux.moment[a]);
  }
  result.sampled = cell.sampled;
  return result;
}

// The sampled area of octant `o` in the coordinates of its parent cell.
SampledArea in_parent_block(const SampledArea& octant, std::uint64_t o) {
  SampledArea result;
  result.area = octant.area / 4.0F;
  for (std::size_t a = 0; a < 3; ++a) {
    const float upper = ((o >> a) & 1U) != 0U ? octant.area : 0.0F;
    result.moment[a] = (octant.moment[a] + upper) / 8.0F;
  }
  return result;
}

// Permutes entries in place: entry i becomes the entry whose index is in the lowest bits of
// order[i].
void permute(std::uint64_t mask, std::vector<std::uint64_t>* order,
             std::vector<CellFlux>* entries) {
  for (std::size_t i = 0; i < order->size(); ++i) {
    // Follow the cycle of the permutation that starts at i.
    const CellFlux first = (*entries)[i];
    for (std::size_t at = i;;) {
      const std::size_t from = (*order)[at] & mask;
      (*order)[at] = at;
      if (from == i) {
        (*entries)[at] = first;
        break;
      }
      (*entries)[at] = (*entries)[from];
      at = from;
    }
  }
}

// Sorts entries by place and sums those with equal places, in place because they are many.
void join(std::vector<CellFlux>* entries) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << (64 - kPlaceBits)) - 1;
  std::vector<std::uint64_t> order;
  order.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    order.push_back((*entries)[i].place << (64 - kPlaceBits) | i);
  }
  {
    std::vector<std::uint64_t> other;
    radix_sort(&order, 64 - kPlaceBits, 64, &other);
  }
  permute(kMask, &order, entries);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const CellFlux& cell = (*entries)[i];
    if (kept > 0 && (*entries)[kept - 1].place == cell.place) {
      CellFlux& sum = (*entries)[kept - 1];
      sum.flux.add(cell.flux);
      sum.sampled.add(cell.sampled);
      sum.is_split = sum.is_split || cell.is_split;
    } else {
      (*entries)[kept++] = cell;
    }
  }
  entries->resize(kept);
}

// Reserves exactly the memory for the blocks of the given octants.
void reserve_blocks(const std::vector<CellFlux>& octants, NodeLevel* level) {
  std::size_t blocks = 0;
  for (std::size_t i = 0; i < octants.size(); ++i) {
    if (i == 0 || octants[i].place >> 3U != octants[i - 1].place >> 3U) ++blocks;
  }
  level->places.reserve(blocks);
  level->blocks.blocks.reserve(blocks);
  level->blocks.split.reserve(blocks);
  level->has_flux.reserve(blocks);
  level->first_flux.reserve(blocks);
  level->fluxes.reserve(
      static_cast<std::size_t>(std::count_if(octants.begin(), octants.end(), is_nonempty)));
}

// Appends the blocks of the parents of `cells`, and replaces the cells with these parents.
void add_blocks(std::vector<CellFlux>* cells, NodeLevel* level) {
  const std::vector<CellFlux>& octants = *cells;
  reserve_blocks(octants, level);
  std::size_t count = 0;
  for (std::size_t i = 0; i < octants.size();) {
    CellFlux cell;
    cell.place = octants[i].place >> 3U;
    cell.is_split = true;
    std::array<BoundaryFlux, 8> fluxes;
    std::uint8_t split = 0;
    std::uint8_t has_flux = 0;
    level->first_flux.push_back(static_cast<std::uint32_t>(level->fluxes.size()));
    for (; i < octants.size() && octants[i].place >> 3U == cell.place; ++i) {
      const std::uint64_t o = octants[i].place & 7U;
      fluxes[o] = octants[i].flux;
      cell.sampled.add(in_parent_block(octants[i].sampled, o));
      if (is_nonempty(octants[i])) {
        has_flux |= static_cast<std::uint8_t>(1U << o);
        level->fluxes.push_back(octant_flux(octants[i]));
      }
      if (octants[i].is_split) split |= static_cast<std::uint8_t>(1U << o);
    }
    cell.flux = flux_of_octants(fluxes);
    level->places.push_back(cell.place);
    level->blocks.blocks.push_back(details_of_octants(fluxes));
    level->blocks.split.push_back(split);
    level->has_flux.push_back(has_flux);
    (*cells)[count++] = cell;
  }
  cells->resize(count);
}

}  // namespace

FluxTree analyze_flux(PooledFlux pooled, int top, int depth) {
  FluxTree tree;
  tree.top = top;
  tree.levels.resize(static_cast<std::size_t>(depth - top));
  std::vector<CellFlux> cells = std::move(pooled[static_cast<std::size_t>(depth)]);
  join(&cells);
  for (int k = depth - 1; k >= top; --k) {
    NodeLevel& level = tree.levels[static_cast<std::size_t>(k - top)];
    add_blocks(&cells, &level);
    link_blocks(&level.blocks);
    std::vector<CellFlux>& own = pooled[static_cast<std::size_t>(k)];
    if (own.empty()) continue;
    cells.insert(cells.end(), own.begin(), own.end());
    own = {};
    join(&cells);
  }
  cells.shrink_to_fit();
  tree.tops = std::move(cells);
  return tree;
}

void synthesize_part(const std::vector<float>& tops, FluxTree* tree) {
  if (tree->levels.empty()) return;
  std::size_t next = 0;
  for (std::size_t i = 0; i < tree->tops.size(); ++i) {
    if (tree->tops[i].is_split) tree->levels.front().blocks.blocks[next++][0] = tops[i];
  }
  for (std::size_t k = 0; k < tree->levels.size(); ++k) {
    TreeLevel& level = tree->levels[k].blocks;
    for (std::size_t b = 0; b < level.size(); ++b) {
      hadamard(&level.blocks[b]);
      if (k + 1 == tree->levels.size()) continue;
      std::size_t child = level.first[b];
      for (unsigned bits = level.split[b]; bits != 0U; bits &= bits - 1U) {
        tree->levels[k + 1].blocks.blocks[child++][0] =
            level.blocks[b][static_cast<std::size_t>(std::countr_zero(bits))];
      }
    }
  }
}

}  // namespace prefilter
