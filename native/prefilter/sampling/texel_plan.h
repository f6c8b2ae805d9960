// SPDX-License-Identifier: GPL-3.0-or-later

// The texels of a table as memory offsets, for all cells of a pyramid.
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

/// Number of symmetries of a cell: bits for mirrored along x (1), along y (2), and swapped before
/// (4).
inline constexpr int kSymmetries = 8;

/// Precomputed data for samples in the cells of one level.
struct PlannedCells {
  int available = 0;   // number of levels, see TableSection
  bool nests = false;  // whether a cell is 2 x 2 and 4 x 4 texels of the levels below
  // For the cells' level and the levels below; missing ones repeat the last:
  std::array<Pair, 3> extents{};  // of the image, in texels
  std::array<Pair, 3> pitches{};  // byte strides between texels and between rows
  std::array<std::uintptr_t, 3> texels{};
  // Cells from `low` to `high`, inclusive, read no texel outside its level.
  Pair low{};
  Pair high{};
  const float* weights = nullptr;           // [subdomain][term][texel]; scaled by 1/255 for bytes
  const std::uint8_t* finer = nullptr;      // [subdomain][texel]
  const TexelOffset* unfolded = nullptr;    // [subdomain][symmetry][texel]
  const std::int32_t* distances = nullptr;  // same: byte offset from the cell's low corner

  /// The texel at the cell's low corner, in the level `level` below the cell's.
  Pair corner(int level, Pair uv, Pair cell, Pair in_cell) const {
    const double texels_of_cell = 1 << level;
    if (nests || level == 0) return cell * texels_of_cell;
    return floor_pair(uv * extents[level] - in_cell * texels_of_cell + 0.5);
  }
};

/// A table rearranged in the order of access. The number of texels is padded to a multiple of four
/// with zero weights.
class TexelPlan {
 public:
  /// The pyramid's texels must outlive the plan.
  TexelPlan(const Pyramid& pyramid, const SamplingTable& table);
  TexelPlan(const TexelPlan&) = delete;
  TexelPlan& operator=(const TexelPlan&) = delete;

  const TableShape& shape() const { return shape_; }
  int padded_texels() const { return padded_; }
  std::size_t bytes() const { return bytes_; }                 // size of all texels
  const PlannedCells* cells() const { return cells_.data(); }  // by level

 private:
  struct Section {
    std::vector<Lanes> weights;
    std::vector<std::uint8_t> finer;
    std::vector<TexelOffset> unfolded;
    // Extents of the unfolded texels of each level, along x and y.
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
