// SPDX-License-Identifier: GPL-3.0-or-later

// Sums over the samples in a cell.
//
// The Haar coefficients (wavelet/boundary_flux.h) are linear in a sample's normal and in the
// products p_a n_a. So is everything that a local plane needs, except for the distance weights,
// which are applied per cell. Therefore a cloud is stored as a list of cells, whose length depends
// on the area of the surface and not on the number of samples.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace prefilter {

/// Coordinates of a cell at its depth, from 0 to 4095.
using CellPosition = std::array<std::int32_t, 3>;

/// Index of a cell in row-major order: z first, x last. Gaps between rows ensure that the key of a
/// neighbor outside the root names no cell.
using CellKey = std::uint64_t;

inline constexpr int kRowShift = 13;  // bits per coordinate
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

/// Weighted sums over the samples in a cell. Positions p are in cells, relative to the low corner.
struct SampleCell {
  CellKey key = 0;
  float weight = 0.0F;
  std::array<float, 3> normal{};    // of the outward unit normals n
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

/// Converts the sums to the coordinates of the parent cell.
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

/// Cells in order of their keys, without duplicates, and the sums of the samples' attributes.
struct SampleCells {
  std::vector<SampleCell> cells;
  std::vector<float> attributes;  // weighted sums, for each cell all attributes

  std::size_t size() const { return cells.size(); }
};

}  // namespace prefilter
