// SPDX-License-Identifier: GPL-3.0-or-later

// What is kept of the samples in a cell: sums, which nest.
//
// All that the Haar coefficients need is linear in a sample's normal and in the products p_a n_a
// (wavelet/boundary_flux.h), and so is all that a local plane needs of its samples, but for the
// weight that falls off with the distance. So a cloud becomes a list of cells, as long as the
// surface is large, however many samples there are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace prefilter {

/// The coordinates of a cell, from 0 to 4095, in cells of its depth.
using CellPosition = std::array<std::int32_t, 3>;

/// Where a cell is in row-major order: z first, x last. Between neighbors of any two cells there
/// is room, so that keys of neighbors outside of the root name no cell.
using CellKey = std::uint64_t;

inline constexpr int kRowShift = 13;
inline constexpr int kKeyBits = 3 * kRowShift;

inline CellKey cell_key(const CellPosition& cell) {
  return (static_cast<CellKey>(cell[2] + 1) << (2 * kRowShift)) |
         (static_cast<CellKey>(cell[1] + 1) << kRowShift) | static_cast<CellKey>(cell[0] + 1);
}

inline CellPosition cell_position(CellKey key) {
  constexpr CellKey kMask = (CellKey{1} << kRowShift) - 1;
  return {static_cast<std::int32_t>(key & kMask) - 1,
          static_cast<std::int32_t>((key >> kRowShift) & kMask) - 1,
          static_cast<std::int32_t>(key >> (2 * kRowShift)) - 1};
}

/// Sums over samples in a cell, each times its weight. Positions p are in cells, from the low
/// corner.
struct SampleCell {
  CellKey key = 0;
  float weight = 0.0F;
  std::array<float, 3> normal{};    // of n, of length 1, outward
  std::array<float, 3> position{};  // of p
  std::array<float, 3> flux{};      // of p_x n_x, p_y n_y, p_z n_z

  void add(const SampleCell& other) {
    weight += other.weight;
    for (std::size_t a = 0; a < 3; ++a) {
      normal[a] += other.normal[a];
      position[a] += other.position[a];
      flux[a] += other.flux[a];
    }
  }
};

/// The same samples as part of the cell of the next smaller depth.
inline SampleCell in_parent(const SampleCell& cell) {
  const CellPosition at = cell_position(cell.key);
  SampleCell parent = cell;
  parent.key = cell_key({at[0] / 2, at[1] / 2, at[2] / 2});
  for (std::size_t a = 0; a < 3; ++a) {
    const auto upper = static_cast<float>(at[a] & 1);
    parent.position[a] = (cell.position[a] + upper * cell.weight) / 2.0F;
    parent.flux[a] = (cell.flux[a] + upper * cell.normal[a]) / 2.0F;
  }
  return parent;
}

/// Cells in the order of their keys, each once, and sums of what else the samples carry.
struct SampleCells {
  std::vector<SampleCell> cells;
  std::vector<float> attributes;  // of each cell one sum, weighted, for each attribute

  std::size_t size() const { return cells.size(); }
};

}  // namespace prefilter
