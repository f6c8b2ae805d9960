// SPDX-License-Identifier: GPL-3.0-or-later

// Samples between two heights, at all depths: where they tell of a surface, and how much of it.
//
// Area per sample follows section 4.2, with corrections. A cell counts where at least three of its
// neighbors of the same depth have samples as well; what counts in none counts in the next larger
// one. A plane of normal n meets |n_x| + |n_y| + |n_z| cells per cell side squared, so each cell
// stands for one over that, not for one. Cells that the surface merely grazes may have no sample:
// their share follows from the number of samples per cell that has some. Both are taken over cells
// two depths up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/sample_cell.h"

namespace prefilter {

/// The cells of one depth.
struct SampleLevel {
  SampleCells samples;
  std::vector<std::uint32_t> parents;  // of each, its index on the level above; none on the first
  std::vector<std::uint8_t> occupied;  // of a cell and its neighbors, how many have samples
  std::vector<float> around;           // the weight of its samples and of those of its neighbors
  // Whether samples, if they are few, are spread over space instead of a surface.
  std::vector<std::uint8_t> is_scattered;
  // The depth at which its samples count, if not at a larger one; below 0: not at all.
  std::vector<std::int8_t> leaf;
  std::vector<std::uint8_t> is_split;  // whether some of its samples count at a larger depth
  // Whether its samples count here: at this depth, or with others of the cell above at a larger
  // one.
  std::vector<std::uint8_t> is_leaf;
  std::vector<float> unit_area;  // of the surface, in finest cells, per unit of weight

  std::size_t size() const { return samples.size(); }
  // Whether the surface seems to meet a cell: three of its neighbors have samples, or more.
  bool is_met(std::size_t i) const { return occupied[i] > 3; }
};

/// Depths from `top`, of cells as high as the slab, to the finest.
struct SampleSlab {
  int top = 0;
  std::vector<SampleLevel> levels;

  int depth() const { return top + static_cast<int>(levels.size()) - 1; }
  SampleLevel& at(int depth) { return levels[static_cast<std::size_t>(depth - top)]; }
  const SampleLevel& at(int depth) const { return levels[static_cast<std::size_t>(depth - top)]; }
};

/// The levels of cells of `depth`, up to `top`.
SampleSlab make_sample_slab(SampleCells finest, int depth, int top, std::size_t attribute_count);

/// Sets `occupied`, `around` and is_scattered of all levels, where the slabs below and above, if
/// there are any, have been made.
void find_met_cells(const SampleSlab* below, const SampleSlab* above, double mean_weight,
                    SampleSlab* slab);

/// The cells of a level and, where there are any, of the layers next to them, in order of their
/// keys.
struct CellLayers {
  std::vector<CellKey> keys;
  std::vector<const SampleCell*> cells;

  void add(const SampleCell& cell) {
    keys.push_back(cell.key);
    cells.push_back(&cell);
  }
};
CellLayers with_layers(const SampleLevel* below, const SampleLevel& level,
                       const SampleLevel* above);

/// What is known of all samples.
struct CloudLeaves {
  double mean_weight = 1.0;
  // Those that count at less depth than this are outliers where they are spread over space.
  int least_leaf = 0;
};

/// Sets is_split of all levels, from that of the last, and is_leaf.
void find_split(SampleSlab* slab);

/// The weight of the samples that do not count.
double weight_of_outliers(const SampleLevel& finest);

/// Sets `leaf`, from that of the first level, is_split, is_leaf and unit_area, and drops what
/// find_met_cells set. `finest` is the depth of the cells that areas are measured in.
void find_leaves(const CloudLeaves& cloud, int finest, SampleSlab* slab);

}  // namespace prefilter
