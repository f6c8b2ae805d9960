// SPDX-License-Identifier: GPL-3.0-or-later

// A table's texels as places in memory, for all cells of a pyramid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/lanes.h"
#include "prefilter/sampling/pairs.h"
#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// The symmetries of a cell: mirrored along x (1), along y (2), and before that swapped (4).
inline constexpr int kSymmetries = 8;

/// What samples in cells of one level are made of.
struct PlannedCells {
  int available = 0;   // levels, see TableSection
  bool nests = false;  // whether a cell is 2 x 2 and 4 x 4 texels of the levels below it
  // Of the cells' level and of the ones below it, as far as there are any, else of the last one:
  std::array<Pair, 3> extents{};  // of the image, in texels
  std::array<Pair, 3> pitches{};  // from one texel to the next, and from row to row [bytes]
  std::array<std::uintptr_t, 3> texels{};
  // Cells from `low` to `high`, both included, read no texel outside of its level.
  Pair low{};
  Pair high{};
  const float* weights = nullptr;           // [subdomain][term][texel]; bytes' are of their value
  const std::uint8_t* finer = nullptr;      // [subdomain][texel]
  const TexelOffset* unfolded = nullptr;    // [subdomain][symmetry][texel]
  const std::int32_t* distances = nullptr;  // likewise: from the cell's low corner [bytes]

  /// The texel in the cell's low corner, in the level so much finer than the cell's.
  Pair corner(int level, Pair uv, Pair cell, Pair in_cell) const {
    const double texels_of_cell = 1 << level;
    if (nests || level == 0) return cell * texels_of_cell;
    return floor_pair(uv * extents[level] - in_cell * texels_of_cell + 0.5);
  }
};

/// All that a sampler looks up in a table, in the order in which it is needed. There are so many
/// texels that vectors of four hold them; those beyond the table's weigh nothing.
class TexelPlan {
 public:
  /// The pyramid's texels must outlive the plan.
  TexelPlan(const Pyramid& pyramid, const SamplingTable& table);
  TexelPlan(const TexelPlan&) = delete;
  TexelPlan& operator=(const TexelPlan&) = delete;

  const TableShape& shape() const { return shape_; }
  int padded_texels() const { return padded_; }
  std::size_t bytes() const { return bytes_; }                 // of all texels
  const PlannedCells* cells() const { return cells_.data(); }  // by level

 private:
  struct Section {
    std::vector<Lanes> weights;
    std::vector<std::uint8_t> finer;
    std::vector<TexelOffset> unfolded;
    // Of the unfolded texels of each level, along x and y.
    std::array<std::array<int, 2>, 3> least{};
    std::array<std::array<int, 2>, 3> most{};
  };

  void plan_section(const TableSection& section, float unit, Section& plan) const;
  void plan_distances(PlannedCells& cells, const Section& section);
  PlannedCells plan_cells(const Pyramid& pyramid, int level);

  TableShape shape_;
  int padded_;
  std::size_t bytes_ = 0;
  std::array<Section, 3> sections_;  // by available levels - 1
  std::vector<std::vector<std::int32_t>> distances_;
  std::vector<PlannedCells> cells_;
};

}  // namespace prefilter
