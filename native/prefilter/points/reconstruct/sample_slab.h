// SPDX-License-Identifier: GPL-3.0-or-later

// Samples between two heights, at all depths: which cells the surface crosses, and the area per
// sample.
//
// The area per sample follows section 4.2, with corrections. Samples count at the finest depth at
// which at least three neighbors of their cell also have samples. A plane with normal n crosses
// |n_x| + |n_y| + |n_z| cells per squared cell side, so each cell represents one over that area,
// not one squared side. Cells that the surface barely touches may contain no sample; their share
// follows from the number of samples per occupied cell. Both corrections are averaged over cells
// two depths up.
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
  // index of each cell's parent on the level above; empty on the first level
  std::vector<std::uint32_t> parents;
  std::vector<std::uint8_t> occupied;  // number of occupied cells among the 27 around a cell
  std::vector<float> around;           // weight of the samples in these 27 cells
  // Whether samples, provided that they are few, are scattered in space rather than on a surface.
  std::vector<std::uint8_t> is_scattered;
  // Depth at which a cell's samples count, unless finer cells split them; below 0: outliers.
  std::vector<std::int8_t> leaf;
  std::vector<std::uint8_t> is_split;  // whether some of its samples count at a larger depth
  // Whether a cell's samples count here: at this depth, or as part of a split cell at a smaller
  // one.
  std::vector<std::uint8_t> is_leaf;
  std::vector<float> unit_area;  // area per unit of weight, in squared finest cells

  std::size_t size() const { return samples.size(); }
  // Whether the surface seems to cross a cell: at least three of its neighbors have samples.
  bool is_crossed(std::size_t i) const { return occupied[i] > 3; }
};

/// The levels from `top`, where cells are as high as the slab, to the finest.
struct SampleSlab {
  int top = 0;
  std::vector<SampleLevel> levels;

  int depth() const { return top + static_cast<int>(levels.size()) - 1; }
  SampleLevel& at(int depth) { return levels[static_cast<std::size_t>(depth - top)]; }
  const SampleLevel& at(int depth) const { return levels[static_cast<std::size_t>(depth - top)]; }
};

/// Builds all levels from the finest cells at `depth`, up to level `top`.
SampleSlab make_sample_slab(SampleCells finest, int depth, int top, std::size_t attribute_count);

/// Sets occupied, around and is_scattered of all levels. The adjacent slabs, where they exist, must
/// have their levels.
void find_crossed_cells(const SampleSlab* below, const SampleSlab* above, double mean_weight,
                        SampleSlab* slab);

/// The cells of a level and of the adjacent layers, in order of their keys.
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

/// Statistics of all samples.
struct CloudLeaves {
  double mean_weight = 1.0;
  // Scattered samples that count at a smaller depth than this are outliers.
  int least_leaf = 0;
};

/// Sets is_split of all levels, given that of the last, and is_leaf.
void find_split(SampleSlab* slab);

/// Total weight of the samples marked as outliers.
double weight_of_outliers(const SampleLevel& finest);

/// Sets leaf (given that of the first level), is_split, is_leaf and unit_area, and frees the
/// results of find_crossed_cells. `finest` is the depth of the cells in which areas are measured.
void find_leaves(const CloudLeaves& cloud, int finest, SampleSlab* slab);

}  // namespace prefilter
